//! Decisions rest on what a person was shown: those on a field that changed meanwhile are refused,
//! and a source says what it feeds before it is removed.

use reqwest::Method;
use serde_json::{Value, json};

use crate::plant::{Plant, field};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_engineers_do_not_decide_over_each_other() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let path = format!("{}/decision", field("count"));
    let rounded = |step: u32| {
        json!({ "mappingState": "MAPPED", "valueSource": "MANUAL",
            "disclosure": { "roundingStep": step } })
    };
    let shown = |view: &Value| format!("\"{}\"", view["shownTag"].as_str().expect("a tag"));
    let seen_by_both = shown(&plant.get(&field("count")).await);
    let (status, text) = plant.call_if_match(Method::PUT, &path, &seen_by_both, rounded(5)).await;
    assert_eq!(status, 200, "{text}");
    let decided: Value = serde_json::from_str(&text).expect("a field");
    let (status, text) = plant.call_if_match(Method::PUT, &path, &seen_by_both, rounded(1)).await;
    assert_eq!(status, 409, "{text}");
    let problem: Value = serde_json::from_str(&text).expect("a problem");
    assert_eq!(problem["code"], "DECIDED_SINCE");
    let present = plant.get(&field("count")).await;
    assert_eq!(present["disclosure"]["roundingStep"], 5.0, "{present:#}");
    assert_eq!(shown(&present), shown(&decided), "values change no tag");
    let (status, text) =
        plant.call_if_match(Method::PUT, &path, &shown(&decided), rounded(1)).await;
    assert_eq!(status, 200, "{text}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_source_says_what_it_feeds() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    let feeds = async || plant.get("/sources/Mill1/use").await;
    assert_eq!(feeds().await, json!({ "fieldCount": 0, "fields": [] }));
    let mapping = json!({ "inputs": [{ "name": "a", "sourceId": "Mill1",
        "nodeId": plant.node("Mill1", "Production.PartCounter") }], "steps": [] });
    let decision = json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "disclosure": {},
        "mapping": mapping });
    plant.put(&format!("{}/decision", field("count")), decision).await;
    let used = feeds().await;
    assert_eq!(
        (&used["fieldCount"], &used["fields"][0]["fieldName"]),
        (&json!(1), &json!("count"))
    );
    // A field that is not disclosed keeps its mapping, and loses nothing.
    let later = json!({ "mappingState": "PENDING" });
    plant.put(&format!("{}/decision", field("count")), later).await;
    assert_eq!(feeds().await["fieldCount"], 0);
}
