//! Ids say nothing of what others do: no number in what a member reads grows with it.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::{
    chain,
    harness::{Api, World, eventually},
    revocations::receipt,
    story::{self, network_path, planner},
};

/// Digits of an id that differ between two, but by chance once in 2^32 pairs.
const PREFIX: usize = 8;

fn comments() -> String {
    format!("{}/comments", network_path())
}

fn items(page: &Value) -> &[Value] {
    page["items"].as_array().expect("a list")
}

/// Asserts that ids have no order: they are random from their first digits on.
fn assert_random(ids: &[&str]) {
    let is_opaque = |id: &&str| id.len() == 32 && id.bytes().all(|digit| digit.is_ascii_hexdigit());
    assert!(ids.iter().all(is_opaque), "{ids:?}");
    let prefixes: BTreeSet<&str> = ids.iter().map(|id| &id[..PREFIX]).collect();
    assert_eq!(prefixes.len(), ids.len(), "{ids:?}");
}

/// Collects all whole numbers of a document, also those in texts that are nothing else.
fn numbers(value: &Value, into: &mut Vec<i64>) {
    match value {
        Value::Number(number) => into.extend(number.as_i64()),
        Value::String(text) => into.extend(text.parse::<i64>()),
        Value::Array(list) => list.iter().for_each(|value| numbers(value, into)),
        Value::Object(members) => members.values().for_each(|value| numbers(value, into)),
        Value::Null | Value::Bool(_) => {}
    }
}

fn numbers_of(value: &Value) -> Vec<i64> {
    let mut found = Vec::new();
    numbers(value, &mut found);
    found
}

async fn comment(api: &Api, request: &str) -> Value {
    let body = json!({ "factoryId": "FOR_MUC", "dynamicDataRequestId": request, "text": "?" });
    api.post(&comments(), body).await.expect_ok()
}

#[tokio::test(flavor = "multi_thread")]
async fn ids_of_comments_count_nothing_of_others() {
    let world = World::start().await;
    chain::drawn(&world).await;
    let buyer = planner(&world, "acme-aero").await;
    let inspector = planner(&world, "inspect-hamburg").await;
    let mut live = inspector.live(None).await;
    let mut own = Vec::new();
    for others in 0..3 {
        for _ in 0..others {
            comment(&buyer, "ReqResponse1").await;
        }
        own.push(comment(&inspector, "AskedByHamburg").await);
    }
    let ids: Vec<&str> =
        own.iter().map(|entry| entry["commentId"].as_str().expect("as described")).collect();
    assert_random(&ids);
    for (entry, id) in own.iter().zip(&ids) {
        assert_eq!(numbers_of(entry), [] as [i64; 0], "{entry}");
        assert_eq!(live.next("comment").await.1["commentId"], **id);
    }
    // Pages go on after what the reader has, and say no more than that.
    let mut read = Vec::new();
    let mut path = format!("{}?limit=1", comments());
    while read.len() <= own.len() {
        let page = inspector.get(&path).await.expect_ok();
        read.extend(items(&page).iter().cloned());
        let Some(cursor) = page["nextCursor"].as_str() else { break };
        assert_eq!(read.last().expect("a comment")["commentId"], cursor);
        path = format!("{}?limit=1&cursor={cursor}", comments());
    }
    assert_eq!(read, own);
    // A comment of others is like one that never was.
    let foreign = buyer.get(&comments()).await.expect_ok();
    for cursor in
        [items(&foreign)[0]["commentId"].as_str().expect("as described"), &"0".repeat(32), "2"]
    {
        let path = format!("{}?cursor={cursor}", comments());
        assert_eq!(items(&inspector.get(&path).await.expect_ok()), own, "{cursor}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn ids_of_audit_entries_count_nothing_of_others() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let buyer = planner(&world, "acme-aero").await;
    let inspector = planner(&world, "inspect-hamburg").await;
    for others in 0..3 {
        for _ in 0..others {
            comment(&buyer, "ReqResponse1").await;
        }
        comment(&inspector, "AskedByHamburg").await;
    }
    let mut read = Vec::new();
    let mut path = "/audit-entries?limit=2".to_owned();
    loop {
        let page = inspector.get(&path).await.expect_ok();
        read.extend(items(&page).iter().cloned());
        assert!(read.len() < 100, "pages end");
        let Some(cursor) = page["nextCursor"].as_str() else { break };
        path = format!("/audit-entries?limit=2&cursor={cursor}");
    }
    assert_eq!(items(&inspector.get("/audit-entries").await.expect_ok()), read);
    let ids: Vec<&str> =
        read.iter().map(|entry| entry["entryId"].as_str().expect("as described")).collect();
    assert!(ids.len() > 3, "{read:?}");
    assert_random(&ids);
    for entry in &read {
        // The revision that it made itself, as the answer to its change said; nothing else is a number.
        let own: &[i64] = if entry["operation"] == "addDynamicDataRequest" { &[2] } else { &[] };
        assert_eq!(numbers_of(entry), own, "{entry}");
    }
    // An entry of others is no place, and neither is one that retention removed.
    let all = admin.get("/audit-entries?limit=1000").await.expect_ok();
    let foreign = items(&all)
        .iter()
        .find(|entry| entry["organisationId"] == "acme-aero")
        .expect("as described");
    for cursor in [foreign["entryId"].as_str().expect("as described"), &"0".repeat(32)] {
        let page = inspector.get(&format!("/audit-entries?cursor={cursor}")).await.expect_ok();
        assert_eq!(items(&page), [] as [Value; 0]);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn ids_of_receipts_count_nothing_of_others() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let path = format!("{}/revocations", network_path());
    for number in 0..4 {
        // Every other one is for the factory's organisation alone.
        let readers: &[&str] = if number % 2 == 0 { &["acme-aero"] } else { &["stranger"] };
        let mut message = receipt("FOR_MUC", readers);
        message["messageId"] = format!("r{number}").into();
        munich.send("revocation", &message);
    }
    let maker = planner(&world, "frames-munich").await;
    eventually("all receipts", || async {
        let page = maker.get(&path).await.expect_ok();
        if items(&page).len() == 4 { Ok(()) } else { Err(page.to_string()) }
    })
    .await;
    let whole = buyer.get(&path).await.expect_ok();
    let ids: Vec<&str> = items(&whole)
        .iter()
        .map(|entry| entry["receiptId"].as_str().expect("as described"))
        .collect();
    assert_eq!(ids.len(), 2, "{whole}");
    assert_random(&ids);
    let rest = buyer.get(&format!("{path}?cursor={}", ids[0])).await.expect_ok();
    assert_eq!(items(&rest), &items(&whole)[1..]);
    let forms: Vec<Vec<i64>> = items(&whole).iter().map(numbers_of).collect();
    assert_eq!(forms[0], forms[1], "{whole}");
}
