//! Events that open pages receive, so that they need not poll.

use std::time::Duration;

use serde_json::{Value, json};
use testkit::Event;
use tokio::sync::mpsc;

use crate::plant::{Plant, field};

/// The next event of this name.
async fn next(events: &mut mpsc::UnboundedReceiver<Event>, name: &str) -> Value {
    let found = async {
        loop {
            let event = events.recv().await.expect("the stream goes on");
            if event.name == name {
                return event.data;
            }
        }
    };
    tokio::time::timeout(Duration::from_secs(60), found)
        .await
        .unwrap_or_else(|_| panic!("{name} is told"))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_receive_events_of_rule_decisions_the_ledger_and_lost_machines() {
    let fields = json!([{ "name": "power", "type": 11, "unit": "WTT" }, { "name": "energy", "type": 11, "unit": "WTT" },
        { "name": "count", "type": 9 }]);
    let plant = Plant::start(fields).await;
    let mut events = plant.events(None).await;
    let accept = json!({ "name": "Power of acme", "isEnabled": true, "action": "ACCEPT", "valueSource": "MANUAL",
        "disclosure": {}, "when": { "partners": ["acme"], "units": ["WTT"] } });
    plant.put("/rules/power", accept).await;
    assert_eq!(plant.post("/rules/apply", json!({})).await["decidedCount"], 2);
    assert_eq!(
        next(&mut events, "decisions").await,
        json!({ "count": 2, "ruleCount": 2 }),
        "both are told at once"
    );
    next(&mut events, "ledger").await;

    plant
        .put(
            &format!("{}/decision", field("count")),
            json!({ "mappingState": "REFUSED", "reason": "Ours." }),
        )
        .await;
    assert_eq!(next(&mut events, "decisions").await, json!({ "count": 1, "ruleCount": 0 }));
    next(&mut events, "ledger").await;

    while events.try_recv().is_ok() {}
    plant.call(reqwest::Method::DELETE, "/sources/Belt1", None).await;
    next(&mut events, "status").await;
}
