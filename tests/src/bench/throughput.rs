//! Values per second through the whole path: a bank of counters, mapped field by field, reported and stored.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::result;
use crate::{
    demo::Cast,
    harness::{Api, eventually},
    scenario::{
        frame_order::{BUYER, MUNICH, NETWORK},
        story,
    },
    world::World,
};

/// Data sets, and fields of each.
const REQUESTS: usize = 10;
const FIELDS: usize = 50;
/// How long is measured.
const SPAN: Duration = Duration::from_secs(10);

/// Maps every field to a counter and counts the reports that the platform has stored after a while.
pub(super) async fn measure(world: &World, cast: &Cast) -> anyhow::Result<Vec<Value>> {
    let fields: Vec<Value> = (0..FIELDS).map(|n| json!({ "name": format!("f{n}"), "type": 9 })).collect();
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
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "mapping": { "inputs": [
        { "name": "input", "sourceId": machine, "nodeId": story::node(machine, "Spindle.Speed") } ],
        "steps": [ { "function": "convert", "to": "UInt64" } ] } });
    for request in 0..REQUESTS {
        for field in 0..FIELDS {
            let path = story::field_path("MakeFrame1", &format!("ReqLoad{request}"), &format!("f{field}"));
            cast.munich.put::<Value>(&format!("{path}/decision"), &decision).await?;
        }
    }
    let machines = world.machines_api(MUNICH)?;
    let before = received(&cast.platform).await?;
    let start = Instant::now();
    let mut speed = 0_u32;
    while start.elapsed() < SPAN {
        speed += 1;
        let path = format!("/machines/{machine}/variables/Spindle.Speed");
        machines.post::<Value>(&path, &json!({ "value": speed })).await?;
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let took = start.elapsed().as_secs_f64();
    let reports = received(&cast.platform).await? - before;
    Ok(vec![
        result("changes of the machine, each to 500 fields", f64::from(speed) / took, "per second"),
        result("reports stored by the platform", reports as f64 / took, "per second"),
        result("field values through the whole path", reports as f64 * FIELDS as f64 / took, "per second"),
    ])
}

async fn received(platform: &Api) -> anyhow::Result<u64> {
    let answer: Value = platform.get(&format!("/api/v1/factories/{MUNICH}/writers")).await?;
    let writers = answer.as_array().or_else(|| answer["items"].as_array()).cloned().unwrap_or_default();
    Ok(writers.iter().filter_map(|writer| writer["received"].as_u64()).sum())
}
