//! Values per second through the whole path: one variable mapped to many fields, reported and
//! stored; and how fast the backlog of an outage drains while values go on changing.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::figures::result;
use crate::{
    frame_order::{BUYER, MUNICH, NETWORK},
    harness::{Api, eventually},
    scenario::{Cast, story},
    world::World,
};

/// Data sets, and fields of each.
const REQUESTS: usize = 10;
const FIELDS: usize = 50;
/// Time of the measurement, and of the cloud's absence.
const SPAN: Duration = Duration::from_secs(10);
const OUTAGE: Duration = Duration::from_secs(20);
/// Reports that wait although nothing is behind: those of two publishing intervals.
const LIVE_BACKLOG: u64 = 2 * REQUESTS as u64;
const PATIENCE: Duration = Duration::from_secs(120);

/// Maps every field, counts the reports that the platform has stored after a while, then takes the
/// cloud away and gives it back.
pub(super) async fn measure(world: &mut World, cast: &Cast) -> anyhow::Result<Vec<Value>> {
    map(cast).await?;
    let machines = world.machines_api(MUNICH)?;
    let before = received(&cast.platform).await?;
    let start = Instant::now();
    let changes = drive(&machines, || start.elapsed() < SPAN).await?;
    let took = start.elapsed().as_secs_f64();
    let live = (received(&cast.platform).await? - before) as f64 / took;
    let mut results = vec![
        result(
            "changes of the machine, each to 500 fields",
            f64::from(changes) / took,
            "per second",
        ),
        result("reports stored by the platform", live, "per second"),
        result("field values through the whole path", live * FIELDS as f64, "per second"),
    ];
    let drained = drain(world, cast).await?;
    results.push(result(
        "reports stored while a backlog drains, live ones included",
        drained,
        "per second",
    ));
    results.push(result(
        "drain rate after an outage against the live rate",
        drained / live,
        "times",
    ));
    Ok(results)
}

/// Reports per second from the moment the cloud is back until nothing is behind any more, while
/// values go on changing.
async fn drain(world: &mut World, cast: &Cast) -> anyhow::Result<f64> {
    let machines = world.machines_api(MUNICH)?;
    let stop = CancellationToken::new();
    let driving = tokio::spawn({
        let stop = stop.clone();
        async move { drive(&machines, || !stop.is_cancelled()).await }
    });
    world.platform.stop(Duration::from_secs(15))?;
    tokio::time::sleep(OUTAGE).await;
    world.platform.restart()?;
    let platform = world.platform_api().await?;
    let at_rest = received(&platform).await?;
    eventually("the backlog begins to drain", PATIENCE, || async {
        match received(&platform).await {
            Ok(now) if now > at_rest => Ok(()),
            other => Err(format!("{other:?}")),
        }
    })
    .await?;
    let (before, start) = (received(&platform).await?, Instant::now());
    eventually("the backlog is drained", PATIENCE, || async {
        let spool: Value = cast.munich.get("/api/v1/spool").await.map_err(|e| format!("{e:#}"))?;
        if spool["waiting"].as_u64().is_some_and(|waiting| waiting <= LIVE_BACKLOG) {
            Ok(())
        } else {
            Err(spool.to_string())
        }
    })
    .await?;
    let drained = (received(&platform).await? - before) as f64 / start.elapsed().as_secs_f64();
    stop.cancel();
    driving.await??;
    Ok(drained)
}

/// Changes the machine's variable again and again; answers how often.
async fn drive(machines: &Api, goes_on: impl Fn() -> bool) -> anyhow::Result<u32> {
    let machine = story::machines(MUNICH)[0];
    let path = format!("/machines/{machine}/variables/Spindle.Speed");
    let mut speed = 0_u32;
    while goes_on() {
        speed += 1;
        machines.post::<Value>(&path, &json!({ "value": speed })).await?;
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    Ok(speed)
}

async fn map(cast: &Cast) -> anyhow::Result<()> {
    let fields: Vec<Value> =
        (0..FIELDS).map(|n| json!({ "name": format!("f{n}"), "type": 9 })).collect();
    for request in 0..REQUESTS {
        let body = json!({ "dynamicDataRequestId": format!("ReqLoad{request}"), "requesterId": BUYER,
            "recipientList": [BUYER], "purpose": "Benchmark",
            "reportDataFormat": { "reportName": "Load", "reportFieldList": fields } });
        let path = format!("/api/v1/operation-networks/{NETWORK}/operations/MakeFrame1/requests");
        cast.platform.post::<Value>(&path, &body).await?;
    }
    let last = format!("ReqLoad{}", REQUESTS - 1);
    eventually("the last request is in the inbox", Duration::from_secs(20), || async {
        let inbox: Value = cast.munich.get("/api/v1/inbox").await.map_err(|e| format!("{e:#}"))?;
        if inbox.to_string().contains(&last) { Ok(()) } else { Err("not yet".to_owned()) }
    })
    .await?;
    let machine = story::machines(MUNICH)[0];
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {}, "mapping": { "inputs": [
        { "name": "input", "sourceId": machine, "nodeId": story::node(machine, "Spindle.Speed") } ],
        "steps": [ { "function": "convert", "to": "UInt64" } ] } });
    for request in 0..REQUESTS {
        for field in 0..FIELDS {
            let path =
                story::field_path("MakeFrame1", &format!("ReqLoad{request}"), &format!("f{field}"));
            cast.munich.put::<Value>(&format!("{path}/decision"), &decision).await?;
        }
    }
    Ok(())
}

async fn received(platform: &Api) -> anyhow::Result<u64> {
    let writers = platform.list(&format!("/api/v1/factories/{MUNICH}/writers")).await?;
    Ok(writers.iter().filter_map(|writer| writer["received"].as_u64()).sum())
}
