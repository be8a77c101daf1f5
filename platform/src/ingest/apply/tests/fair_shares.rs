//! Quotas of factories: what one exhausts, the other does not feel.

use super::*;
use crate::{
    sequences::RANGES_MAX,
    store::{GAPS_PER_WRITER_MAX, WriterKey, WriterRow},
};

/// Returns the codes of a factory's dead letters, the newest first.
async fn codes(platform: &Platform, factory: &str) -> Vec<String> {
    let mut work = platform.store.read().await.expect("begun");
    let letters = work.dead_letters().list(None, 100_000).await.expect("read");
    let address = LogicalAddress::FactoryIngress(id(factory)).to_string();
    let of_factory = letters.into_iter().filter(|letter| letter.address == address);
    of_factory.map(|letter| letter.code).collect()
}

fn gap(factory: &'static str, writer: u16) -> (&'static str, Value) {
    let body = json!({ "messageType": "gap", "messageId": format!("gap-{writer}"), "factoryId": factory,
        "dataSetWriterId": writer, "epoch": 9, "firstSequence": 0, "lastSequence": 3,
        "cause": "COALESCED" });
    (factory, body)
}

fn offer(factory: &'static str, asset: u32) -> (&'static str, Value) {
    let body = json!({ "messageType": "asset-offer", "messageId": format!("{factory}-offer-{asset}"),
        "factoryId": factory, "assetId": format!("asset-{asset}"), "kindList": ["POSE"],
        "description": "A robot" });
    (factory, body)
}

#[tokio::test]
async fn a_report_that_was_held_is_a_repeat_though_its_number_became_uncertain() {
    let platform = Platform::asks().await;
    let holes = u32::try_from(RANGES_MAX).expect("few") + 100;
    let reports: Vec<_> = (0..holes).map(|number| report(2 * number + 1, 20, 7)).collect();
    platform.ingest(&reports).await;
    let mut again = report(1, 20, 7);
    again.1["MessageId"] = json!("another-id");
    platform.ingest(&[again, report(2, 21, 8)]).await;
    let mut work = platform.store.read().await.expect("begun");
    let key = WriterKey { factory_id: id("F"), data_set_writer_id: 1, epoch: 1 };
    let writer = work.writers().lookup(&key).await.expect("read").expect("a row");
    assert_eq!((writer.received, writer.duplicates), (u64::from(holes) + 1, 1));
    assert!(writer.sequences.contains(1) && writer.sequences.contains(2));
    assert!(writer.sequences.missing().len() <= RANGES_MAX);
    drop(work);
    assert_eq!(codes(&platform, "F").await, Vec::<String>::new());
}

#[tokio::test]
async fn a_factory_has_a_bounded_number_of_writers_and_epochs() {
    let platform = Platform::asks().await;
    let mut work = platform.store.begin().await.expect("begun");
    for epoch in 0..10_000 {
        let key = WriterKey { factory_id: id("F"), data_set_writer_id: 1, epoch };
        work.writers().put(&WriterRow::new(key)).await.expect("stored");
    }
    work.commit().await.expect("committed");
    platform.ingest(&[gap("F", 2), gap("G", 2), report(1, 20, 7)]).await;
    assert_eq!(codes(&platform, "F").await, ["QUOTA_EXCEEDED"], "its known writers go on");
    assert_eq!(codes(&platform, "G").await, Vec::<String>::new());
    let mut work = platform.store.read().await.expect("begun");
    assert_eq!(work.writers().count(&id("F")).await.expect("read"), 10_000);
    assert_eq!(work.writers().count(&id("G")).await.expect("read"), 1);
}

#[tokio::test]
async fn a_factory_offers_a_bounded_number_of_assets() {
    let platform = Platform::asks().await;
    let offers: Vec<_> = (0..2_000).map(|asset| offer("F", asset)).collect();
    platform.ingest(&offers).await;
    let mut again = offer("F", 0);
    again.1["messageId"] = json!("again");
    platform.ingest(&[offer("F", 2_000), offer("G", 2_000), again]).await;
    assert_eq!(codes(&platform, "F").await, ["QUOTA_EXCEEDED"], "what is known may change");
    assert_eq!(codes(&platform, "G").await, Vec::<String>::new());
}

#[tokio::test]
async fn a_gap_over_many_holes_keeps_the_bound_on_gaps_of_a_writer() {
    let platform = Platform::asks().await;
    let holes = u32::try_from(RANGES_MAX).expect("few") - 1;
    let reports: Vec<_> = (0..holes).map(|number| report(2 * number + 1, 20, 7)).collect();
    platform.ingest(&reports).await;
    let over = |id: &str, epoch: u32, last: u32| {
        let body = json!({ "messageType": "gap", "messageId": id, "factoryId": "F", "dataSetWriterId": 1,
            "epoch": epoch, "firstSequence": 0, "lastSequence": last, "cause": "COALESCED" });
        ("F", body)
    };
    platform.ingest(&[over("all", 1, 2 * holes)]).await;
    let late = (0..5).map(|number| report(2 * (holes + number) + 3, 20, 7));
    platform.ingest(&late.collect::<Vec<_>>()).await;
    platform.ingest(&[over("late", 1, 2 * holes + 20)]).await;
    let mut work = platform.store.read().await.expect("begun");
    let seen = work.writers().of_factory(&Scope::Platform, &id("F")).await.expect("read");
    assert!(seen[0].gaps.len() as u64 <= GAPS_PER_WRITER_MAX);
    assert_eq!(seen[0].gaps.iter().filter(|gap| gap.is_coarse).count(), 1);
    assert!(seen[0].writer.sequences.missing().is_empty());
}

#[tokio::test]
async fn a_message_has_a_bounded_number_of_reports_and_keep_alives() {
    let platform = Platform::asks().await;
    let alive = json!({ "DataSetWriterId": 1, "MessageType": "ua-keepalive", "SequenceNumber": 1,
        "MetaDataVersion": { "MajorVersion": 1, "MinorVersion": 1 } });
    let body = |id: &str, count: usize| {
        json!({ "MessageId": id, "MessageType": "ua-data", "PublisherId": "F",
            "Messages": vec![alive.clone(); count] })
    };
    platform.ingest(&[("F", body("most", 2_000))]).await;
    assert_eq!(codes(&platform, "F").await, Vec::<String>::new());
    platform.ingest(&[("F", body("more", 2_001))]).await;
    assert_eq!(codes(&platform, "F").await, ["TOO_MANY_MESSAGES"]);
}
