//! Requests and mappings beside the frame order's own, so that every writer is busy all the time.

use std::time::Duration;

use anyhow::Context as _;
use serde_json::{Value, json};

use crate::{
    frame_order::{BUYER, HAMBURG, MUNICH, NETWORK},
    harness::{Api, eventually},
    scenario::{Cast, story},
    world::{Places, counters::COUNTERS},
};

/// Further requests to each factory: one for each counter.
const REQUESTS: usize = crate::world::counters::COUNT;

/// Time between values that are counted, in milliseconds: several publishing intervals.
const COUNTED_INTERVAL_MS: u64 = 250;

/// Field with the steps that a script counts.
pub(crate) const STEPS: &str = "steps";
/// Field with the count of a machine.
pub(crate) const COUNTED: &str = "counted";

/// Field whose consent ends and comes back all the time, at the first request to each factory.
pub(crate) const TOGGLED: &str = "measured";
/// Text that a script makes of a value.
pub(crate) const SCRIPTED: &str = "scripted";
/// Fields of each request that are mapped.
pub(crate) const FIELDS: [&str; 4] = [TOGGLED, STEPS, SCRIPTED, COUNTED];

/// Asks both factories for values that change with every cycle of the machines, and maps them.
pub(crate) async fn put_on(cast: &Cast, places: &Places) -> anyhow::Result<String> {
    let [in_munich, in_hamburg] = places.counters.context("a world with counters")?;
    for (factory, connector, port) in
        [(MUNICH, &cast.munich, in_munich), (HAMBURG, &cast.hamburg, in_hamburg)]
    {
        let source = json!({ "sourceId": COUNTERS, "name": COUNTERS, "endpointUrl": format!("opc.tcp://127.0.0.1:{port}"),
                             "security": { "choice": "none" } });
        connector.post::<Value>("/api/v1/sources", &source).await?;
        let refused: Vec<_> = (0..REFUSED_FIELDS).map(|n| (refused_field(n), 12)).collect();
        ask(&cast.platform, factory, &refused_request(factory), &refused).await?;
        let fields = [(TOGGLED, 11), (STEPS, 9), (SCRIPTED, 12), (COUNTED, 8)];
        let fields = fields.map(|(name, built_in_type)| (name.to_owned(), built_in_type));
        for number in 0..REQUESTS {
            ask(&cast.platform, factory, &request_id(factory, number), &fields).await?;
        }
        let last = request_id(factory, REQUESTS - 1);
        eventually("the requests are in the inbox", Duration::from_secs(30), || async {
            let path = format!("/api/v1/operation-networks/{NETWORK}");
            let inbox: Value = connector.get(&path).await.map_err(|e| format!("{e:#}"))?;
            if inbox.to_string().contains(&last) { Ok(()) } else { Err(format!("no {last}")) }
        })
        .await?;
        for number in 0..REQUESTS {
            decide(connector, factory, number).await?;
        }
    }
    Ok(format!("{REQUESTS} requests to each factory"))
}

/// Returns the ids of the requests that keep a factory's writers busy.
pub(crate) fn requests(factory: &str) -> Vec<String> {
    (0..REQUESTS).map(|number| request_id(factory, number)).collect()
}

fn operation(factory: &str) -> &'static str {
    if factory == MUNICH { "MakeFrame1" } else { "InspectFrame1" }
}

fn request_id(factory: &str, number: usize) -> String {
    format!("ReqChaos-{factory}-{number}")
}

/// Asks a factory for fields of these names and built-in types.
async fn ask(
    platform: &Api,
    factory: &str,
    request: &str,
    fields: &[(String, u8)],
) -> anyhow::Result<()> {
    let field =
        |(name, built_in_type): &(String, u8)| json!({ "name": name, "type": built_in_type });
    let fields: Vec<Value> = fields.iter().map(field).collect();
    let body = json!({ "dynamicDataRequestId": request, "requesterId": BUYER, "recipientList": [BUYER],
        "purpose": "Chaos", "reportDataFormat": { "reportName": "Chaos", "reportFieldList": fields } });
    let operation = operation(factory);
    let path = format!("/api/v1/operation-networks/{NETWORK}/operations/{operation}/requests");
    platform.post::<Value>(&path, &body).await.map(drop)
}

/// Fields of a further request to each factory, each of which is refused once.
pub(crate) const REFUSED_FIELDS: u64 = 200;

/// Returns the id of the request that has them.
pub(crate) fn refused_request(factory: &str) -> String {
    format!("ReqRefused-{factory}")
}

/// Returns the name of one of them.
pub(crate) fn refused_field(number: u64) -> String {
    format!("refused{number}")
}

/// Returns path and body of a decision that refuses a field.
pub(crate) fn refuse(factory: &str, field: &str, reason: &str) -> (String, Value) {
    let path = story::field_path(operation(factory), &refused_request(factory), field);
    (format!("{path}/decision"), json!({ "mappingState": "REFUSED", "reason": reason }))
}

/// Returns the id of the request of which the consents end and come back while it runs.
pub(crate) fn toggled_request(factory: &str) -> String {
    request_id(factory, 0)
}

/// Returns the key of a field whose decision changes while others stay as they are.
pub(crate) fn toggled_field(factory: &str) -> Value {
    json!({ "operationNetworkId": NETWORK, "operationId": operation(factory),
            "dynamicDataRequestId": toggled_request(factory), "fieldName": TOGGLED })
}

/// Returns path and body of the decision that maps this field with a disclosure policy.
pub(crate) fn toggle(factory: &str, disclosure: Value) -> (String, Value) {
    let path = story::field_path(operation(factory), &toggled_request(factory), TOGGLED);
    let mut decision = mapped(power(factory), "Double", json!([]), json!({}));
    decision["disclosure"] = disclosure;
    (format!("{path}/decision"), decision)
}

/// Returns machine and key of a variable that changes all the time.
fn power(factory: &str) -> (&'static str, &'static str) {
    if factory == MUNICH { ("MillingCell1", "Spindle.Power") } else { ("Press1", "Ram.Force") }
}

fn mapped((machine, key): (&str, &str), value_type: &str, steps: Value, monitor: Value) -> Value {
    json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {}, "mapping": {
        "inputs": [ { "name": "input", "sourceId": machine, "nodeId": story::node(machine, key),
                      "valueType": value_type, "monitor": monitor } ], "steps": steps } })
}

/// Maps four fields: a measured value, a number that a script increments with each change that it gets, a text, and
/// what a machine counts.
async fn decide(connector: &Api, factory: &str, number: usize) -> anyhow::Result<()> {
    let power = power(factory);
    let count = "(value, ctx) => { ctx.state = (ctx.state ?? 0) + 1; return BigInt(ctx.state); }";
    let script = |source: &str| json!([{ "function": "script", "source": source }]);
    // Values that come in one notification make one report, which has the last of them. What is counted comes apart:
    // each value has to be in a report.
    let apart = json!({ "samplingIntervalMs": COUNTED_INTERVAL_MS, "queueSize": 1 });
    let counter = format!("Counter{number}");
    let often = json!({ "samplingIntervalMs": 50, "queueSize": 10 });
    let decisions = [
        (TOGGLED, mapped(power, "Double", json!([]), json!({}))),
        (STEPS, mapped(power, "Double", script(count), apart)),
        (SCRIPTED, mapped(power, "Double", script("value => `at ${value}`"), json!({}))),
        (COUNTED, mapped((COUNTERS, &counter), "Int64", json!([]), often)),
    ];
    for (field, decision) in decisions {
        let path = story::field_path(operation(factory), &request_id(factory, number), field);
        connector.put::<Value>(&format!("{path}/decision"), &decision).await?;
    }
    Ok(())
}
