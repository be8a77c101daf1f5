//! Requests and mappings beside the frame order's own, so that every writer is busy all the time.

use std::time::Duration;

use serde_json::{Value, json};

use crate::{
    demo::Cast,
    frame_order::{BUYER, HAMBURG, MUNICH, NETWORK},
    harness::{Api, eventually},
    scenario::story,
};

/// Further requests to each factory.
const REQUESTS: usize = 3;

/// Time between values that are counted, in milliseconds: several publishing intervals.
const COUNTED_INTERVAL_MS: u64 = 250;

/// Asks both factories for values that change with every cycle of the machines, and maps them.
pub(crate) async fn put_on(cast: &Cast) -> anyhow::Result<String> {
    for (factory, connector, operation) in
        [(MUNICH, &cast.munich, "MakeFrame1"), (HAMBURG, &cast.hamburg, "InspectFrame1")]
    {
        for number in 0..REQUESTS {
            ask(&cast.platform, factory, operation, number).await?;
        }
        let last = request_id(factory, REQUESTS - 1);
        eventually("the requests are in the inbox", Duration::from_secs(30), || async {
            let path = format!("/api/v1/operation-networks/{NETWORK}");
            let inbox: Value = connector.get(&path).await.map_err(|e| format!("{e:#}"))?;
            if inbox.to_string().contains(&last) { Ok(()) } else { Err(format!("no {last}")) }
        })
        .await?;
        for number in 0..REQUESTS {
            decide(connector, factory, operation, number).await?;
        }
    }
    Ok(format!("{REQUESTS} requests to each factory"))
}

/// Returns the ids of the requests that keep a factory's writers busy.
pub(crate) fn requests(factory: &str) -> Vec<String> {
    (0..REQUESTS).map(|number| request_id(factory, number)).collect()
}

fn request_id(factory: &str, number: usize) -> String {
    format!("ReqChaos-{factory}-{number}")
}

async fn ask(platform: &Api, factory: &str, operation: &str, number: usize) -> anyhow::Result<()> {
    let field = |name: &str, built_in_type: u8| json!({ "name": name, "type": built_in_type });
    let body = json!({ "dynamicDataRequestId": request_id(factory, number), "requesterId": BUYER, "recipientList": [BUYER],
        "purpose": "Chaos", "reportDataFormat": { "reportName": "Chaos", "reportFieldList": [
            field("measured", 11), field("steps", 9), field("scripted", 12) ] } });
    let path = format!("/api/v1/operation-networks/{NETWORK}/operations/{operation}/requests");
    platform.post::<Value>(&path, &body).await.map(drop)
}

/// Maps three fields: a measured value, a number that a script increments with each change that it gets, and
/// a text.
async fn decide(
    connector: &Api,
    factory: &str,
    operation: &str,
    number: usize,
) -> anyhow::Result<()> {
    let (machine, key) =
        if factory == MUNICH { ("MillingCell1", "Spindle.Power") } else { ("Press1", "Ram.Force") };
    let count = "(value, ctx) => { ctx.state = (ctx.state ?? 0) + 1; return BigInt(ctx.state); }";
    let mapped = |steps: Value, monitor: Value| {
        json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {}, "mapping": {
            "inputs": [ { "name": "input", "sourceId": machine, "nodeId": story::node(machine, key),
                          "valueType": "Double", "monitor": monitor } ], "steps": steps } })
    };
    let script = |source: &str| json!([{ "function": "script", "source": source }]);
    // Values that come in one notification make one report, which has the last of them. What is counted comes apart:
    // each value has to be in a report.
    let apart = json!({ "samplingIntervalMs": COUNTED_INTERVAL_MS, "queueSize": 1 });
    let decisions = [
        ("measured", mapped(json!([]), json!({}))),
        ("steps", mapped(script(count), apart)),
        ("scripted", mapped(script("value => `at ${value}`"), json!({}))),
    ];
    for (field, decision) in decisions {
        let path = story::field_path(operation, &request_id(factory, number), field);
        connector.put::<Value>(&format!("{path}/decision"), &decision).await?;
    }
    Ok(())
}
