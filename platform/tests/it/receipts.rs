//! Receipts name stored and missing reports, and never a report that is not stored.

use serde_json::{Value, json};

use crate::{
    entitlement::{BUYER, INSPECTOR, network_to},
    harness::{Api, World, eventually},
    story,
};

fn entry(receipt: &Value) -> &Value {
    &receipt["receiptList"][0]
}

#[tokio::test(flavor = "multi_thread")]
async fn receipts_name_missing_reports_until_they_come_or_are_announced() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 1));
    munich.send("ua-data", &story::report("m4", 4, 5));
    let receipt = munich.receive("receipt", |receipt| entry(receipt)["throughSequence"] == 4).await;
    assert_eq!(
        (&entry(&receipt)["missingList"], &entry(&receipt)["epoch"]),
        (&json!([1, 2, 3]), &json!(608_926_829))
    );

    munich.send("ua-data", &story::report("m2", 2, 3));
    munich.receive("receipt", |receipt| entry(receipt)["missingList"] == json!([1, 3])).await;
    munich.send(
        "gap",
        &json!({ "messageType": "gap", "messageId": "g1", "factoryId": "FOR_MUC", "dataSetWriterId": 1,
        "epoch": 608_926_829, "firstSequence": 1, "lastSequence": 3, "cause": "COALESCED" }),
    );
    munich.receive("receipt", |receipt| entry(receipt)["missingList"] == json!([])).await;
    story::value_is(&buyer, "5").await;
    // The second report is held: no gap denies it.
    eventually("the gaps", || async {
        let writers = admin.get("/factories/FOR_MUC/writers").await.expect_ok();
        let gaps = writers["items"][0]["gaps"].as_array().expect("gaps").iter();
        let range = |gap: &Value| (gap["firstSequence"].as_u64(), gap["lastSequence"].as_u64());
        let ranges: Vec<_> = gaps.map(range).collect();
        let expected = [(Some(1), Some(1)), (Some(3), Some(3))];
        if ranges == expected { Ok(()) } else { Err(format!("{ranges:?}")) }
    })
    .await;

    // A repeat is receipted again: the receipt may have been lost on its way.
    let before = munich.count("receipt");
    munich.send("ua-data", &story::report("m4-again", 4, 5));
    eventually("another receipt", || async {
        let count = munich.count("receipt");
        if count > before { Ok(()) } else { Err(count.to_string()) }
    })
    .await;
}

/// A receipt was lost, and nothing comes of the writers any more.
#[tokio::test(flavor = "multi_thread")]
async fn a_connector_asks_which_reports_are_held() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 1));
    munich.receive("receipt", |receipt| entry(receipt)["throughSequence"] == 0).await;
    story::value_is(&buyer, "1").await;
    let asked = |writer: u16, through: u32| json!({ "dataSetWriterId": writer, "epoch": 608_926_829, "throughSequence": through });
    munich.send(
        "receipt-request",
        &json!({ "messageType": "receipt-request", "messageId": "q1", "factoryId": "FOR_MUC",
        "writerList": [asked(1, 2), asked(7, 1)] }),
    );
    let said = |receipt: &Value, writer: u16| {
        let mut entries = receipt["receiptList"].as_array().expect("a list").iter();
        entries.find(|entry| entry["dataSetWriterId"] == writer).cloned().unwrap_or_default()
    };
    let receipt =
        munich.receive("receipt", |receipt| said(receipt, 1)["throughSequence"] == 2).await;
    assert_eq!(said(&receipt, 1)["missingList"], json!([1, 2]));
    let receipt = munich.receive("receipt", |receipt| said(receipt, 7) != Value::Null).await;
    assert_eq!(said(&receipt, 7)["missingList"], json!([0, 1]), "nothing ever came of this one");
}

#[tokio::test(flavor = "multi_thread")]
async fn the_factory_owner_and_recipients_see_its_writers_and_nobody_else_does() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m3", 3, 1));
    story::value_is(&buyer, "1").await;
    let maker = story::planner(&world, "frames-munich").await;
    // Only so can a recipient tell that nothing is new from that something is missing.
    for api in [&admin, &maker, &buyer] {
        let writers = api.get("/factories/FOR_MUC/writers").await.expect_ok();
        let writer = &writers["items"][0];
        assert_eq!(
            (&writer["throughSequence"], &writer["missing"]),
            (&json!(3), &json!([0, 1, 2]))
        );
    }
    let inspector = story::planner(&world, "inspect-hamburg").await;
    let writers = inspector.get("/factories/FOR_MUC/writers").await.expect_ok();
    assert_eq!(writers["items"], json!([]));
    let stranger = story::planner(&world, "stranger").await;
    stranger.get("/factories/FOR_MUC/writers").await.expect_problem(404, "NOT_FOUND");
}

#[tokio::test(flavor = "multi_thread")]
async fn recipients_see_the_gaps_of_their_requests() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m0", 0, 1));
    munich.send("ua-data", &story::report("m5", 5, 1));
    munich.send(
        "gap",
        &json!({ "messageType": "gap", "messageId": "g1", "factoryId": "FOR_MUC", "dataSetWriterId": 1,
        "epoch": 608_926_829, "firstSequence": 1, "lastSequence": 3, "cause": "REVOKED" }),
    );
    eventually("the gap", || async {
        let writers = buyer.get("/factories/FOR_MUC/writers").await.expect_ok();
        let writer = &writers["items"][0];
        let shown = (&writer["gaps"], &writer["missing"], &writer["dynamicDataRequestId"]);
        let gaps = json!([
            { "firstSequence": 1, "lastSequence": 3, "cause": "REVOKED", "isCoarse": false } ]);
        let expected = (&gaps, &json!([4]), &json!("ReqResponse1"));
        if shown == expected { Ok(()) } else { Err(writers.to_string()) }
    })
    .await;
}

/// Waits until the writer that a viewer is shown has these numbers.
async fn shown_through(api: &Api, through: u64, received: u64) -> Value {
    eventually("the numbers", || async {
        let writers = api.get("/factories/FOR_MUC/writers").await.expect_ok();
        let writer = &writers["items"][0];
        let shown = (&writer["throughSequence"], &writer["received"]);
        if shown == (&json!(through), &json!(received)) {
            Ok(writers)
        } else {
            Err(writers.to_string())
        }
    })
    .await
}

fn gap(first: u32, last: u32) -> Value {
    json!({ "messageType": "gap", "messageId": format!("g{first}"), "factoryId": "FOR_MUC",
        "dataSetWriterId": 1, "epoch": 608_926_829, "firstSequence": first, "lastSequence": last,
        "cause": "REVOKED" })
}

#[tokio::test(flavor = "multi_thread")]
async fn a_removed_recipient_learns_nothing_from_numbers_and_times_of_later_reports() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) =
        story::accepted_network(&world, network_to(&[BUYER, INSPECTOR])).await;
    let inspector = story::planner(&world, INSPECTOR).await;
    let to_both = |id: &str, sequence: u32| story::report_to(&[BUYER, INSPECTOR], id, sequence, 3);
    munich.send("ua-data", &to_both("m0", 0));
    munich.send("ua-data", &to_both("m2", 2));
    munich.send("gap", &gap(1, 1));
    munich.send("gap", &gap(3, 3));
    let writers = eventually("the gaps", || async {
        let writers = inspector.get("/factories/FOR_MUC/writers").await.expect_ok();
        let count = writers["items"][0]["gaps"].as_array().map(Vec::len);
        if count == Some(2) { Ok(writers) } else { Err(writers.to_string()) }
    })
    .await;
    let writer = &writers["items"][0];
    assert_eq!((&writer["throughSequence"], &writer["received"]), (&json!(2), &json!(2)));
    assert_eq!(writer["duplicates"], Value::Null, "repeats follow what others are sent");

    story::put_network(&buyer, network_to(&[BUYER])).await;
    let before = inspector.get("/factories/FOR_MUC/writers").await.expect_ok();
    assert_eq!(before["items"][0]["gaps"].as_array().map(Vec::len), Some(1), "of its own reports");
    // The factory has not taken the revision yet.
    for sequence in [4, 6, 9] {
        munich.send("ua-data", &to_both(&format!("m{sequence}"), sequence));
    }
    munich.send("gap", &gap(5, 5));
    shown_through(&buyer, 9, 5).await;
    eventually("the gap behind the reports", || async {
        let shown = buyer.get("/factories/FOR_MUC/writers").await.expect_ok();
        let missing = shown["items"][0]["missing"].clone();
        if missing == json!([7, 8]) { Ok(()) } else { Err(missing.to_string()) }
    })
    .await;
    assert_eq!(inspector.get("/factories/FOR_MUC/writers").await.expect_ok(), before);
}
