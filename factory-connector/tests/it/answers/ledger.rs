//! The ledger, its checkpoints and its files; revocations.

use serde_json::{Value, json};

use super::Answers;

pub async fn read(answers: &mut Answers<'_>) {
    let plant = answers.plant;
    let queued = "/ledger?kind=QUEUED";
    plant.until("the value is in the ledger", queued, |page| page["items"][0] != Value::Null).await;
    answers.get("listLedgerEntries", "/ledger").await;
    answers.get("searchLedgerFields", "/ledger/fields?search=count").await;
    answers.get("exportLedger", "/ledger/export?format=csv&kind=CONSENT").await;
    let checkpoints = "/ledger/checkpoints";
    plant.until("a checkpoint is made", checkpoints, |page| page["items"][0] != Value::Null).await;
    // The next report is made before the checkpoint, or not.
    answers.without(&["number"]).get("listCheckpoints", checkpoints).await;
    // The key is made at the first start, and the next report is made meanwhile, or not.
    answers.without(&["size", "verifierKey"]).get("listLedgerLogs", "/ledger/logs").await;
    let path = "/ledger/logs/acme/successor";
    answers.post("beginLedgerLog", path, json!({ "reason": "Disk replaced" })).await;
    // With the checkpoint, which is made a second after the first entry.
    answers.post("verifyLedger", "/ledger/verification", json!({})).await;
}

pub async fn revoke(answers: &mut Answers<'_>) {
    let body = json!({ "operationNetworkId": "frame", "reason": "Order closed" });
    // The next report is made meanwhile, or not.
    let numbers = &["lastQueuedSequence", "takenBack"];
    let receipt = answers.without(numbers).post("revokeConsents", "/revocations", body).await;
    let id = receipt["revocationId"].as_str().expect("an id");
    answers.without(numbers).get("listRevocations", "/revocations").await;
    answers.without(numbers).get("showRevocation", &format!("/revocations/{id}")).await;
    answers.get("printRevocation", &format!("/revocations/{id}/print?language=en")).await;
}
