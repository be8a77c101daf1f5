//! A tool of the buyer at a broker of another make.

use std::{sync::Arc, time::Duration};

use anyhow::Context as _;
use messaging::{
    Envelope, Link,
    spool::memory::{AcceptedReports, MemorySpool},
    test_support::RecordingInbox,
};
use serde_json::{Value, json};
use tokio_util::{sync::CancellationToken, task::AbortOnDropHandle};

use crate::{
    frame_order::{BUYER, NETWORK},
    harness::eventually,
    scenario::{Cast, story},
    world::{TOOL, World},
};

/// Request of the tool.
const REQUEST: &str = "ReqOfTool";
const OPERATION: &str = "MakeFrame1";
const FIELD: &str = "power";
/// Time for an answer through all programs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Lets the tool ask the factory for a value over the broker, and read reports with it.
pub(super) async fn asks_and_reads(world: &World, cast: &Cast) -> anyhow::Result<String> {
    let tool = json!({ "toolId": TOOL, "organisationId": BUYER, "name": TOOL });
    cast.platform.post::<Value>("/api/v1/tools", &tool).await?;
    let broker = world.external.as_ref().context("a broker of another make")?;
    let (spool, inbox) =
        (Arc::new(MemorySpool::new(AcceptedReports::Leave)), Arc::<RecordingInbox>::default());
    let (store, receiver): (Arc<MemorySpool>, Arc<RecordingInbox>) =
        (Arc::clone(&spool), Arc::clone(&inbox));
    let (link, handle) = Link::new(broker.link_of_tool()?, store, receiver)?;
    let stop = CancellationToken::new();
    let running = AbortOnDropHandle::new(tokio::spawn(link.run(stop.clone())));

    let message_id = uuid::Uuid::new_v4().to_string();
    let request = json!({ "dynamicDataRequestId": REQUEST, "requesterId": BUYER, "recipientList": [BUYER],
        "purpose": "A tool asks", "reportDataFormat": { "reportName": "Tool", "reportFieldList": [
            { "name": FIELD, "type": 11 } ] } });
    let message = json!({ "messageType": "data-request", "messageId": message_id, "toolId": TOOL,
        "operationNetworkId": NETWORK, "operationId": OPERATION, "dynamicDataRequest": request });
    let envelope = Envelope::new(message_id.parse()?, "data-request", message.to_string());
    spool.push(format!("tool.{TOOL}.requests").parse()?, envelope);
    handle.wake();
    let answer = received(&inbox, "the tool is answered", |message| {
        message["messageType"] == "acknowledgement"
            && message["correlationId"] == message_id.as_str()
    })
    .await?;
    anyhow::ensure!(answer["result"] == "ACCEPTED", "{answer}");

    eventually("the request is in the inbox", PATIENCE, || async {
        let path = format!("/api/v1/operation-networks/{NETWORK}");
        let network: Value = cast.munich.get(&path).await.map_err(|e| format!("{e:#}"))?;
        if network.to_string().contains(REQUEST) { Ok(()) } else { Err(format!("no {REQUEST}")) }
    })
    .await?;
    let node = story::node("MillingCell1", "Spindle.Power");
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {}, "mapping": {
        "inputs": [ { "name": "input", "sourceId": "MillingCell1", "nodeId": node, "valueType": "Double",
                      "monitor": {} } ], "steps": [] } });
    let path = format!("{}/decision", story::field_path(OPERATION, REQUEST, FIELD));
    cast.munich.put::<Value>(&path, &decision).await?;
    let report = received(&inbox, "the tool gets reports", |message| {
        message["MessageType"] == "ua-data" && message.to_string().contains(REQUEST)
    })
    .await?;
    let reports = report["Messages"].as_array().context("reports")?;
    let is_foreign = |report: &Value| report["Payload"]["dynamicDataRequestId"]["Body"] != REQUEST;
    anyhow::ensure!(!reports.iter().any(is_foreign), "reports of other requests: {report}");
    stop.cancel();
    running.await?;
    Ok(format!("{} messages read", inbox.received.lock().len()))
}

/// Waits until the tool has received a message like this.
async fn received(
    inbox: &RecordingInbox,
    what: &str,
    is_wanted: impl Fn(&Value) -> bool,
) -> anyhow::Result<Value> {
    eventually(what, PATIENCE, || async {
        let bodies: Vec<Value> = {
            let received = inbox.received.lock();
            let bodies = received.iter().map(|(_, delivery)| &delivery.envelope.body);
            bodies.filter_map(|body| serde_json::from_slice(body).ok()).collect()
        };
        let found = bodies.iter().find(|message| is_wanted(message)).cloned();
        found.ok_or_else(|| format!("{} other messages", bodies.len()))
    })
    .await
}
