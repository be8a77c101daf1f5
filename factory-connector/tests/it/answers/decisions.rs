//! Decisions, and values that people enter.

use serde_json::{Value, json};

use super::Answers;
use crate::plant::field;

/// A decision that takes entered values.
fn manual() -> Value {
    json!({ "mappingState": "MAPPED", "valueSource": "MANUAL",
        "disclosure": { "roundingStep": 5.0 }, "reason": "Agreed on Monday." })
}

pub async fn decide_and_enter(answers: &mut Answers<'_>) {
    let count = field("count");
    let draft = json!({ "valueSource": "MANUAL", "disclosure": { "roundingStep": 5.0 } });
    let draft = answers.plant.post(&format!("{count}/preview"), draft).await;
    assert!(draft["warnings"].is_array(), "{draft:#}");
    answers.get("showConsentOffer", &format!("{count}/consent-offer")).await;
    answers.put("decideField", &format!("{count}/decision"), manual()).await;
    answers.put("enterValue", &format!("{count}/value"), json!({ "value": 17 })).await;
    answers.get("showField", &count).await;
}

pub async fn report_operations(answers: &mut Answers<'_>) {
    let entry = json!({ "entryId": "e1", "operationNetworkId": "frame", "operationId": "MakeFrame",
        "madeAt": "2026-01-05T06:00:00Z", "action": "ADD", "quantity": 3 });
    let unreadable = json!({ "entryId": "e2" });
    let body = json!({ "entries": [entry, unreadable] });
    answers.post("deliverOperatorEntries", "/operator/entries", body).await;
    let path = "/operator/entries?operationNetworkId=frame&operationId=MakeFrame";
    answers.get("listOperatorEntries", path).await;
    answers.get("listOperatorOperations", "/operator/operations").await;
}
