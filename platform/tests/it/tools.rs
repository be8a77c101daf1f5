//! Tools on the broker.

use reqwest::Method;
use serde_json::json;

use crate::{
    connector::Peer,
    harness::{World, eventually},
    story::{self, NETWORK},
};

#[tokio::test(flavor = "multi_thread")]
async fn a_tool_asks_over_the_broker_and_gets_the_reports_it_may_have() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let tool =
        json!({ "toolId": "Monitoring", "organisationId": "acme-aero", "name": "Monitoring" });
    admin.post("/tools", tool).await.expect_ok();
    let credential = admin.post("/tools/Monitoring/credentials", json!({})).await.expect_ok();
    let tool = Peer::tool(&credential, "Monitoring");

    let ask = |id: &str, request: serde_json::Value| {
        json!({ "messageType": "data-request", "messageId": id, "toolId": "Monitoring", "operationNetworkId": NETWORK,
            "operationId": "MakeFrame1", "dynamicDataRequest": request })
    };
    tool.send("data-request", &ask("t1", story::request("FromTool", "acme-aero")));
    let answer = tool.receive("acknowledgement", |answer| answer["correlationId"] == "t1").await;
    assert_eq!((&answer["result"], &answer["revision"]), (&json!("ACCEPTED"), &json!(2)));
    munich.receive("operation-network", |part| part["revision"] == 2).await;

    // A request put by hand that names the tool counts as well, for whichever tool is known by
    // then.
    let mut network = story::network();
    network["operationList"][0]["dynamicDataRequestList"][0]["dynamicDataRequestPublisherId"] =
        json!("Monitoring");
    network["operationList"][0]["dynamicDataRequestList"]
        .as_array_mut()
        .expect("a list")
        .push(story::request_of_tool("FromTool", "acme-aero", "Monitoring"));
    story::put_network(&buyer, network).await;

    // In another tool's name it is refused.
    tool.send("data-request", &ask("t2", story::request("Foreign", "frames-munich")));
    let answer = tool.receive("acknowledgement", |answer| answer["correlationId"] == "t2").await;
    assert_eq!(
        (&answer["result"], &answer["faultList"][0]["code"]),
        (&json!("REJECTED"), &json!("FOREIGN_REQUESTER"))
    );

    // One message with reports of three requests: the tool gets the two that name it.
    let mut both = story::report("m1", 0, 3);
    let mut own = story::report("own", 0, 7)["Messages"][0].take();
    own["DataSetWriterId"] = json!(2);
    own["Payload"]["dynamicDataRequestId"]["Body"] = json!("FromTool");
    let mut foreign = story::report("foreign", 0, 8)["Messages"][0].take();
    foreign["DataSetWriterId"] = json!(3);
    foreign["Payload"]["dynamicDataRequestId"]["Body"] = json!("Unasked");
    both["Messages"].as_array_mut().expect("a list").extend([own, foreign]);
    munich.send("ua-data", &both);
    let forwarded = tool.receive("ua-data", |_| true).await;
    let messages = forwarded["Messages"].as_array().expect("a list");
    let values: Vec<_> =
        messages.iter().map(|part| part["Payload"]["progressStatus"]["Body"].clone()).collect();
    assert_eq!(values, ["3", "7"], "{forwarded}");
    story::value_is(&buyer, "3").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_tool_that_sends_faster_than_its_share_waits_and_a_factory_does_not() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let tool =
        json!({ "toolId": "Scheduling", "organisationId": "acme-aero", "name": "Scheduling" });
    admin.post("/tools", tool).await.expect_ok();
    let credential = admin.post("/tools/Scheduling/credentials", json!({})).await.expect_ok();
    let tool = Peer::tool(&credential, "Scheduling");
    for number in 0..400 {
        tool.send_bytes("data-request", None, format!("no JSON {number}").as_bytes());
    }
    eventually("it has used its share up", || async {
        let answer = admin.client.call(Method::GET, "/metrics", None).await.expect("an answer");
        let line =
            "verbund_share_refusals_total{of=\"tool\",share=\"messages\",who=\"Scheduling\"}";
        if answer.text.contains(line) { Ok(()) } else { Err(answer.text) }
    })
    .await;
    munich.send("ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;
    let letters = admin.get("/dead-letters?limit=500").await.expect_ok();
    let read = letters["items"].as_array().expect("a list").len();
    assert!(read < 400, "the rest still waits: {read} of 400 were read");
}
