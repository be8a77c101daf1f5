//! The past of requests.

use serde_json::json;

use super::Answers;

pub async fn decide(answers: &mut Answers<'_>) {
    // Nothing left: there is no platform, and nobody was added.
    answers.get("listPastOffers", "/past-offers").await;
    let request = json!({ "operationNetworkId": "frame", "operationId": "MakeFrame",
        "dynamicDataRequestId": "Req" });
    let body = json!({ "request": request, "recipientId": "acme", "isReleased": true,
        "root": "00".repeat(32) });
    answers.post("decidePast", "/past-decisions", body).await;
    answers.get("listPastDecisions", "/past-decisions").await;
}
