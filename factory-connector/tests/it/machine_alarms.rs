//! Way from the events of a machine to the value of a field.

use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use simulator::MachineCondition;

use crate::plant::{Plant, field};

/// A mapping of what the events of a machine make.
fn of_events(events: Value) -> Value {
    let monitor = json!({ "events": events });
    json!({ "steps": [], "inputs": [{ "name": "a", "sourceId": "Mill1", "nodeId": "i=2253", "monitor": monitor }] })
}

async fn set(plant: &Plant, name: &str, severity: u16, is_active: bool) {
    let machine = plant.machines.machine("Mill1").expect("a machine");
    let message = format!("{name} needs a look");
    let condition = MachineCondition { message, severity, is_active, is_acknowledged: true };
    machine.set_condition(name, condition).await.expect("a machine");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn alarms_and_events_of_a_machine_make_the_values_of_fields() {
    let plant =
        Plant::start(json!([{ "name": "alarms", "type": 7 }, { "name": "worst", "type": 5 }]))
            .await;
    set(&plant, "Oil", 300, true).await;
    set(&plant, "Door", 700, true).await;
    let alarms = of_events(json!({ "value": { "kind": "activeConditions" }, "severityMin": 500 }));
    let view = plant.map("alarms", alarms.clone()).await;
    assert_eq!(view["mapping"]["inputs"][0]["monitor"]["events"]["severityMin"], 500, "{view:#}");
    plant.map("worst", of_events(json!({ "value": { "kind": "activeSeverity" } }))).await;
    let has = |value: u64| move |status: &Value| status["lastCandidate"]["value"] == value;
    let status = |name: &str| format!("{}/mapping-status", field(name));
    plant.until("one severe alarm", &status("alarms"), has(1)).await;
    plant.until("the worst of both", &status("worst"), has(700)).await;
    // A preview shows what the published mapping heard last.
    let draft = json!({ "valueSource": "MAPPING", "mapping": alarms });
    let preview = plant.post(&format!("{}/preview", field("alarms")), draft).await;
    assert_eq!(preview["inputs"][0]["value"], 1, "{preview:#}");
    // What no published mapping takes was not heard: it is not the value of another selection.
    let message = of_events(json!({ "value": { "kind": "activeMessage" } }));
    let draft = json!({ "valueSource": "MAPPING", "mapping": message });
    let preview = plant.post(&format!("{}/preview", field("alarms")), draft).await;
    assert_eq!(preview["inputs"], json!([]), "{preview:#}");

    set(&plant, "Door", 700, false).await;
    plant.until("no severe alarm", &status("alarms"), has(0)).await;
    plant.until("the one that is left", &status("worst"), has(300)).await;

    // What no server could monitor is not stored.
    let body = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {},
        "mapping": of_events(json!({ "value": { "kind": "activeSeverity" }, "severityMin": 1001 })) });
    let path = format!("{}/decision", field("worst"));
    let (refused, text) = plant.call(Method::PUT, &path, Some(body.to_string())).await;
    assert_eq!(refused, StatusCode::UNPROCESSABLE_ENTITY, "{text}");
    assert!(text.contains("1 to 1000"), "{text}");
}
