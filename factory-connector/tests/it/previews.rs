//! Previews that decisions are made on: the ledger names the one that the engineer saw.

use reqwest::Method;
use serde_json::{Value, json};

use crate::plant::{Plant, field};

async fn refused(plant: &Plant, path: &str, body: &Value) -> Value {
    let (status, text) = plant.call(Method::PUT, path, Some(body.to_string())).await;
    assert_eq!(status, 409, "{path}: {text}");
    serde_json::from_str::<Value>(&text).expect("a problem")["code"].take()
}

/// Returns the hash of the preview that the basis of a consent names.
fn preview_of(entry: &Value) -> Option<&str> {
    let members = entry.as_object().expect("an entry");
    members.values().find_map(|member| member["preview"].as_str())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_was_previewed_is_recorded_with_the_consent() {
    let plant =
        Plant::start(json!([{ "name": "count", "type": 9 }, { "name": "state", "type": 12 }]))
            .await;
    let draft = json!({ "valueSource": "MAPPING", "disclosure": { "roundingStep": 5 },
        "mapping": { "inputs": [{ "name": "a", "sourceId": "Mill1",
            "nodeId": plant.node("Mill1", "Production.PartCounter") }], "steps": [] } });
    let preview = plant.post(&format!("{}/preview", field("count")), draft.clone()).await;
    let decision = |preview_id: &Value, step: u32| {
        let mut decision = draft.clone();
        decision["mappingState"] = json!("MAPPED");
        decision["previewId"] = preview_id.clone();
        decision["disclosure"]["roundingStep"] = json!(step);
        decision
    };
    let (id, path) = (&preview["previewId"], format!("{}/decision", field("count")));
    let code = refused(&plant, &path, &decision(id, 1)).await;
    assert_eq!(code, "PREVIEW_OF_ANOTHER_DRAFT", "what is decided is not what was seen");
    assert_eq!(refused(&plant, &path, &decision(&json!("made-up"), 5)).await, "UNKNOWN_PREVIEW");
    let other = format!("{}/decision", field("state"));
    assert_eq!(refused(&plant, &other, &decision(id, 5)).await, "UNKNOWN_PREVIEW");
    assert_eq!(plant.get(&field("count")).await["mappingState"], "PENDING");

    plant.put(&path, decision(id, 5)).await;
    let entries = plant.get("/ledger?recipient=acme&kind=CONSENT").await;
    let entry = &entries["items"][0];
    let hash = preview_of(entry).expect("a hash").to_owned();
    assert_eq!(hash.len(), 64, "{entries:#}");
    assert_eq!(plant.post("/ledger/verification", json!({})).await["valid"], true);

    // The consent that a changed policy makes was not seen in a preview.
    let policy = json!({ "name": "Coarse", "disclosure": { "roundingStep": 10 } });
    plant.put("/policies/coarse", policy).await;
    plant.put("/recipients/acme/policy", json!({ "policyId": "coarse" })).await;
    let entries = plant.get("/ledger?recipient=acme&kind=CONSENT").await;
    let [newest, entry] = &entries["items"].as_array().expect("a page")[..] else {
        panic!("{entries:#}")
    };
    assert_eq!(preview_of(newest), None, "{entries:#}");
    let members = newest.as_object().expect("an entry").values();
    let names: Vec<&Value> = members.map(|member| &member["policies"][0]["id"]).collect();
    assert!(names.contains(&&json!("coarse")), "the plant reads the names: {newest:#}");
    let (_, chain) = plant.call(Method::GET, "/ledger/export?format=jsonl", None).await;
    assert!(chain.contains("commitment") && !chain.contains("coarse"), "{chain}");
    assert_eq!(plant.post("/ledger/verification", json!({})).await["valid"], true);
    assert_eq!(preview_of(entry), Some(hash.as_str()));

    // What was seen is not what holds once another person has changed a policy.
    let preview = plant.post(&format!("{}/preview", field("count")), draft.clone()).await;
    assert_eq!(preview["effectiveDisclosure"]["roundingStep"], json!(10), "{preview:#}");
    let finer = json!({ "name": "Fine", "disclosure": { "roundingStep": 5 } });
    plant.put("/policies/coarse", finer).await;
    let code = refused(&plant, &path, &decision(&preview["previewId"], 5)).await;
    assert_eq!(code, "PREVIEW_OF_ANOTHER_POLICY");
    let preview = plant.post(&format!("{}/preview", field("count")), draft.clone()).await;
    plant.put(&path, decision(&preview["previewId"], 5)).await;
}
