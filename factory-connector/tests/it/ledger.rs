//! The ledger as people look things up in it.

use std::time::Duration;

use ed25519_dalek::{Signature, VerifyingKey};
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};

use crate::plant::{PASSWORD, Plant, field};

/// Opens a field by hand and enters a value.
async fn open(plant: &Plant, name: &str, value: Value) {
    let manual = json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} });
    plant.put(&format!("{}/decision", field(name)), manual).await;
    plant.put(&format!("{}/value", field(name)), json!({ "value": value })).await;
}

fn kinds(ledger: &Value) -> Vec<&str> {
    let items = ledger["items"].as_array().expect("a page");
    items.iter().filter_map(|item| item["kind"].as_str()).collect()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn entries_are_found_by_kind_request_and_field() {
    let plant =
        Plant::start(json!([{ "name": "count", "type": 9 }, { "name": "state", "type": 12 }]))
            .await;
    open(&plant, "state", json!("RUNNING")).await;
    open(&plant, "count", json!(17)).await;
    let request = "/ledger?recipient=acme&operationNetworkId=frame&operationId=MakeFrame&dynamicDataRequestId=Req";
    let whole = plant
        .until("both values are in the ledger", request, |ledger| {
            kinds(ledger).len() >= 4 && ledger["items"][0]["value"]["count"] != Value::Null
        })
        .await;
    assert_eq!(
        whole["items"],
        plant.get("/ledger").await["items"],
        "everything is about the one request"
    );

    let parts = &whole["items"][0]["precisionParts"]["count"];
    assert_eq!(*parts, json!([{ "code": "UNCHANGED" }]), "{whole:#}");

    let consents = plant.get("/ledger?kind=CONSENT").await;
    assert_eq!(kinds(&consents), ["CONSENT"; 2]);
    let of_count = plant.get(&format!("{request}&fieldName=count")).await;
    let items = of_count["items"].as_array().expect("a page");
    assert!(
        items.iter().all(|item| item["fieldName"] == "count" || item["consents"]["count"] == 1),
        "{of_count:#}"
    );
    assert!(
        items.len() >= 2 && items.len() < kinds(&whole).len(),
        "what left before the field is not about it"
    );
    assert_eq!(
        kinds(&plant.get(&format!("{request}&fieldName=count&kind=CONSENT")).await),
        ["CONSENT"]
    );
    assert!(kinds(&plant.get("/ledger?operationNetworkId=other").await).is_empty());

    let mut by_one = Vec::new();
    let mut cursor = String::new();
    loop {
        let page = plant.get(&format!("{request}&limit=1{cursor}")).await;
        by_one.extend(page["items"].as_array().expect("a page").iter().cloned());
        let Some(next) = page["nextCursor"].as_str() else { break };
        cursor = format!("&after={next}");
    }
    assert_eq!(Value::Array(by_one), whole["items"]);

    let export =
        request.replace("/ledger?", "/ledger/export?format=csv&fieldName=count&kind=QUEUED&");
    let (status, csv) = plant.call(Method::GET, &export, None).await;
    assert!(status == 200 && csv.contains(",17,") && !csv.contains("CONSENT"), "{csv}");
    let (status, problem) = plant.call(Method::GET, "/ledger?fieldName=count", None).await;
    assert!(status == 400 && problem.contains("INCOMPLETE_ADDRESS"), "{problem}");

    let found = plant.get("/ledger/fields?search=req%20CO").await;
    assert_eq!(found["items"][0]["key"]["fieldName"], "count", "{found:#}");
    assert_eq!(found["items"].as_array().map(Vec::len), Some(1), "{found:#}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn checkpoints_are_exported_and_proven() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    open(&plant, "count", json!(17)).await;
    let page = plant
        .until("the daily checkpoint is made", "/ledger/checkpoints", |page| {
            page["items"][0] != Value::Null
        })
        .await;
    assert_eq!(page["nextCursor"], Value::Null);
    let checkpoint = &page["items"][0];
    assert_eq!(
        (&checkpoint["number"], &checkpoint["heads"][0]["recipient"]),
        (&json!(1), &json!("acme"))
    );
    let bytes = |member: &str| {
        hex::decode(checkpoint[member].as_str().expect("a text")).expect("hexadecimal")
    };
    let key = VerifyingKey::try_from(bytes("publicKey").as_slice()).expect("a key");
    let signature = Signature::from_slice(&bytes("signature")).expect("a signature");
    let text = checkpoint["signedText"].as_str().expect("a text");
    key.verify_strict(text.as_bytes(), &signature).expect("the text is signed");
    let verified = plant.post("/ledger/verification", json!({})).await;
    assert_eq!(verified["publicKey"], checkpoint["publicKey"]);
    assert_eq!(plant.get("/ledger/checkpoints?cursor=1").await["items"], json!([]));
}

/// Appends so many long entries to a chain that no buffer between here and a client holds an export. They
/// belong to no log: only an export reads them.
fn lengthen(plant: &Plant) {
    let store = rusqlite::Connection::open(plant.data_directory().join("connector.sqlite"));
    let mut store = store.expect("a store");
    let entries = store.transaction().expect("begun");
    let content = json!({ "event": "NOTE", "padding": "x".repeat(16 << 10) }).to_string();
    for number in 0..2_000 {
        let sql = "INSERT INTO ledger_entry (recipient, number, recorded_at, content, hash)
                   VALUES ('acme', ?, 0, ?, zeroblob(32))";
        entries.execute(sql, (1_000_000 + number, &content)).expect("inserted");
    }
    entries.commit().expect("written");
}

#[tokio::test(flavor = "multi_thread")]
async fn downloads_that_are_not_read_hold_up_neither_pages_nor_sign_in() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    open(&plant, "count", json!(17)).await;
    lengthen(&plant);
    let mut downloads = Vec::new();
    for _ in 0..6 {
        let download = plant.unread("/ledger/export?format=jsonl").await;
        assert!(download.status().is_success(), "{}", download.status());
        downloads.push(download);
    }
    let answered = async {
        plant.signed_in("engineer", PASSWORD).await.expect("sign-in goes on");
        for path in ["/status", "/ledger?recipient=acme", "/spool", "/inbox"] {
            plant.get(path).await;
        }
        plant.unread("/ledger/export?format=jsonl&kind=CONSENT").await.text().await.expect("read")
    };
    let answered = tokio::time::timeout(Duration::from_secs(10), answered).await;
    assert!(answered.expect("nobody waits for who does not read").contains("CONSENT"));
    // They are held up by themselves alone: one that is read goes on to its end.
    let whole = downloads.remove(0).text().await.expect("read");
    assert!(whole.len() > 2_000 * (16 << 10), "{}", whole.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn one_verification_at_a_time_reads_the_ledger() {
    let plant = Plant::start(json!([{ "name": "count", "type": 9 }])).await;
    open(&plant, "count", json!(17)).await;
    lengthen(&plant);
    let verify = || plant.call(Method::POST, "/ledger/verification", Some("{}".to_owned()));
    let answers = futures::future::join_all([verify(), verify(), verify(), verify()]).await;
    let refused = answers.iter().filter(|(status, text)| {
        *status == StatusCode::CONFLICT && text.contains("VERIFICATION_RUNS")
    });
    let refused = refused.count();
    let done = answers.iter().filter(|(status, _)| status.is_success()).count();
    assert!(refused > 0 && done > 0 && refused + done == 4, "{answers:?}");
    let (status, text) = verify().await;
    assert!(status.is_success(), "the next one runs: {text}");
}
