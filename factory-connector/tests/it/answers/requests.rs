//! Networks, requests and comments.

use serde_json::json;

use super::Answers;

pub async fn read(answers: &mut Answers<'_>) {
    answers.get("listInbox", "/inbox").await;
    answers.get("showRequest", "/requests/frame/MakeFrame/Req").await;
    answers.get("listOperationNetworks", "/operation-networks").await;
    answers.get("showOperationNetwork", "/operation-networks/frame").await;
    answers.get("showRevisionDifference", "/operation-networks/frame/news").await;
    answers.get("listDeadLetters", "/dead-letters").await;
    // Keep-alives and metadata of the writer may wait, too.
    answers.without(&["bytes", "waiting"]).get("showSpool", "/spool").await;
}

pub async fn comment(answers: &mut Answers<'_>) {
    let path = "/operation-networks/frame/comments";
    let body = json!({ "dynamicDataRequestId": "Req", "fieldName": "count", "text": "Per shift?" });
    answers.post("addComment", path, body).await;
    answers.get("listComments", path).await;
}
