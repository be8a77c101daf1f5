//! Ingest keeps up: batches of reports through decoding, deduplication, store and commit.

use std::time::Instant;

use messaging::{Delivery, Envelope, Inbox, LogicalAddress, Settlement};
use serde_json::json;

use crate::{harness::World, story};

/// Far under what a release build does on one core, and far over what a shop floor sends: a guard
/// against the loss of batching, not a benchmark.
const REPORTS_PER_SECOND_MIN: f64 = 1_000.0;
const BATCHES: u32 = 20;
const REPORTS_PER_MESSAGE: u32 = 10;
const MESSAGES_PER_BATCH: u32 = 50;

#[tokio::test(flavor = "multi_thread")]
async fn batched_reports_are_stored_fast_and_each_once() {
    let world = World::start().await;
    let (admin, _buyer, _munich, _hamburg) = story::accepted(&world).await;
    let ingest = world.handle().application.ingest.clone();
    let address = LogicalAddress::FactoryIngress("FOR_MUC".parse().expect("valid"));
    let batches: Vec<Vec<Delivery>> = (0..BATCHES).map(batch).collect();

    let started = Instant::now();
    for batch in &batches {
        let settlements = ingest.receive(&address, batch.clone()).await;
        assert!(settlements.iter().all(|settlement| *settlement == Settlement::Accept));
    }
    let reports = f64::from(BATCHES * MESSAGES_PER_BATCH * REPORTS_PER_MESSAGE);
    let rate = reports / started.elapsed().as_secs_f64();
    assert!(rate > REPORTS_PER_SECOND_MIN, "{rate:.0} reports per second");

    ingest.receive(&address, batches[0].clone()).await;
    let writers = admin.get("/factories/FOR_MUC/writers").await.expect_ok();
    let writer = &writers["items"][0];
    assert_eq!(writer["received"], json!(BATCHES * MESSAGES_PER_BATCH * REPORTS_PER_MESSAGE));
    assert_eq!(writer["duplicates"], json!(MESSAGES_PER_BATCH * REPORTS_PER_MESSAGE));
}

fn batch(number: u32) -> Vec<Delivery> {
    (0..MESSAGES_PER_BATCH).map(|index| message(number * MESSAGES_PER_BATCH + index)).collect()
}

fn message(number: u32) -> Delivery {
    let first = number * REPORTS_PER_MESSAGE;
    let mut body = story::report(&format!("m{number}"), first, 1);
    let parts = (first..first + REPORTS_PER_MESSAGE)
        .map(|sequence| story::data_set_message(sequence, sequence.into()));
    body["Messages"] = parts.collect();
    let id = format!("m{number}").parse().expect("valid");
    Delivery {
        envelope: Envelope::new(id, "ua-data", body.to_string().into_bytes()),
        is_redelivered: false,
        delivery_count: 0,
        received_at: time::OffsetDateTime::now_utc(),
    }
}
