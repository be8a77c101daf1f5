//! Quotas of factories: what one exhausts, the other does not feel.

use asi_model::{OrganisationId, messages::ledger_log_origin};
use ed25519_dalek::SigningKey;
use transparency_log::{Checkpoint, KeyKind, NoteKey, TreeHead};

use super::*;
use crate::{
    sequences::RANGES_MAX,
    store::{
        ANSWERS_WAITING_MAX, GAPS_PER_WRITER_MAX, Kept, Leaver, NewOutgoing, WriterKey, WriterRow,
        WritersWanted,
    },
    witness::WitnessedLog,
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
    let first = WritersWanted { after: None, limit: 100 };
    let seen = work.writers().of_factory(&Scope::Platform, &id("F"), first).await.expect("read");
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

/// A message about a checkpoint that proves nothing: what is wrong with it is said once it is looked at.
fn checkpoint(factory: &'static str, epoch: u32) -> (&'static str, Value) {
    let body = json!({ "messageType": "ledger-checkpoint", "messageId": format!("{factory}-checkpoint-{epoch}"),
        "factoryId": factory, "recipientId": "a", "epoch": epoch, "verifierKey": "k",
        "addCheckpoint": "rubbish" });
    (factory, body)
}

fn lease_request(factory: &'static str) -> (&'static str, Value) {
    let body = json!({ "messageType": "lease-request", "messageId": "asks", "factoryId": factory,
        "instanceId": "i", "place": "p", "host": "h", "startedAt": moment(1) });
    (factory, body)
}

fn answer(address: LogicalAddress, number: u64) -> NewOutgoing {
    NewOutgoing {
        address,
        message_id: id(&format!("answer-{number}")),
        subject: "any".into(),
        correlation_id: Some(id("asks")),
        created_at: at(1),
        time_to_live: None,
        content_encoding: None,
        body: "{}".into(),
    }
}

#[tokio::test]
async fn who_reads_no_answers_gets_no_more() {
    let platform = Platform::asks().await;
    let requests = |factory: &str| LogicalAddress::FactoryRequests(id(factory));
    let leases = |factory: &str| LogicalAddress::FactoryLeases(id(factory));
    let mut work = platform.store.begin().await.expect("begun");
    for number in 0..ANSWERS_WAITING_MAX {
        for address in [requests("F"), leases("F")] {
            work.outgoing().add(&answer(address, number)).await.expect("stored");
        }
    }
    work.commit().await.expect("committed");
    let messages = ["F", "G"].map(|factory| [lease_request(factory), checkpoint(factory, 1)]);
    platform.ingest(&messages.concat()).await;
    assert_eq!(codes(&platform, "F").await, ["QUOTA_EXCEEDED"]);
    assert_eq!(codes(&platform, "G").await, ["INVALID_CHECKPOINT"]);
    let mut work = platform.store.read().await.expect("begun");
    let mut waiting = Vec::new();
    for address in [leases("F"), leases("G")] {
        waiting.push(work.outgoing().waiting(&address).await.expect("read"));
    }
    assert_eq!(waiting, [ANSWERS_WAITING_MAX, 1]);
}

#[tokio::test]
async fn a_factory_has_a_bounded_number_of_logs() {
    let platform = Platform::asks().await;
    let recipient: OrganisationId = id("a");
    let origin = ledger_log_origin(&id("F"), &recipient, 1);
    let key = NoteKey::new(&origin, KeyKind::Ed25519, SigningKey::from_bytes(&[1; 32]));
    let key = key.expect("a key");
    let note = Checkpoint { origin, size: 1, root: [0; 32] }.sign(&key).expect("signed");
    let mut work = platform.store.begin().await.expect("begun");
    for epoch in 1..=2_000 {
        let log = WitnessedLog {
            epoch,
            verifier_key: key.verifier().clone(),
            head: TreeHead { size: 1, root: [0; 32] },
            checkpoint: note.clone(),
            cosigned_at: at(1),
            first_size: 1,
            first_seen_at: at(1),
            refused: None,
        };
        work.ledger_logs().put(&id("F"), &recipient, &log).await.expect("stored");
    }
    work.commit().await.expect("committed");
    platform.ingest(&[checkpoint("F", 2_000), checkpoint("G", 1)]).await;
    assert_eq!(codes(&platform, "F").await, ["INVALID_CHECKPOINT"], "known ones go on");
    assert_eq!(codes(&platform, "G").await, ["INVALID_CHECKPOINT"]);
    platform.ingest(&[checkpoint("F", 2_001)]).await;
    assert_eq!(codes(&platform, "F").await[0], "QUOTA_EXCEEDED");
}

#[tokio::test]
async fn what_comes_of_a_factory_that_has_left_leaves_no_trace() {
    let platform = Platform::asks().await;
    let mut work = platform.store.begin().await.expect("begun");
    work.removals().leave(&Leaver::Factory(id("F")), at(1)).await.expect("it leaves");
    work.commit().await.expect("committed");
    platform.ingest(&[report(1, 20, 7), gap("F", 1), ("F", json!("rubbish")), gap("G", 1)]).await;
    assert_eq!(codes(&platform, "F").await, Vec::<String>::new());
    let mut work = platform.store.begin().await.expect("begun");
    let addresses = ["F", "G"].map(|factory| LogicalAddress::FactoryIngress(id(factory)));
    let kept = work.quotas().of_sender(&addresses[0]).await.expect("read");
    assert_eq!(kept, Kept::default());
    assert!(work.quotas().of_sender(&addresses[1]).await.expect("read").rows > 0);
    let waits = LogicalAddress::FactoryRequests(id("F"));
    work.outgoing().add(&answer(waits.clone(), 1)).await.expect("dropped");
    assert_eq!(work.outgoing().waiting(&waits).await.expect("read"), 0);
}
