//! Memory of senders: what is decoded at a time is bounded, of one of them and of all.

use std::time::Duration;

use messaging::{Envelope, Inbox as _};

use super::*;
use crate::ingest::{decode::Content, portion::PORTION_BYTES_MAX};

/// Unpacked bytes of each message; on its way it has some hundred.
const MESSAGE_BYTES: usize = 200 * 1024;

fn deliveries(count: usize) -> Vec<Delivery> {
    let delivery = |number| {
        let id = format!("m{number}").parse().expect("an id");
        Delivery {
            envelope: Envelope::new(id, "any", vec![b' '; MESSAGE_BYTES]).compressed(),
            is_redelivered: false,
            delivery_count: 0,
            received_at: time::OffsetDateTime::UNIX_EPOCH,
        }
    };
    (0..count).map(delivery).collect()
}

async fn handle(folder: &tempfile::TempDir) -> (IngestHandle, mpsc::Receiver<Batch>) {
    handle_where(folder, true, u64::MAX).await
}

/// Returns a handle where senders wait at the broker, or where what is beyond their share or room is set aside.
async fn handle_where(
    folder: &tempfile::TempDir,
    may_wait: bool,
    factory_bytes_max: u64,
) -> (IngestHandle, mpsc::Receiver<Batch>) {
    let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
    let room = RoomConfig {
        data_directory: folder.path().to_owned(),
        factory_bytes_max,
        tool_bytes_max: u64::MAX,
        may_wait,
    };
    let (sender, batches) = mpsc::channel(100);
    let ending = CancellationToken::new();
    (IngestHandle::new(&store, Arc::default(), sender, room, ending), batches)
}

/// Takes one batch of two messages from a factory, and returns the codes with which they are set aside.
async fn codes_of_next(
    handle: &IngestHandle,
    batches: &mut mpsc::Receiver<Batch>,
    factory: usize,
) -> Vec<&'static str> {
    codes_of(handle, batches, factory, deliveries(2)).await
}

async fn codes_of(
    handle: &IngestHandle,
    batches: &mut mpsc::Receiver<Batch>,
    factory: usize,
    deliveries: Vec<Delivery>,
) -> Vec<&'static str> {
    let (handle, count) = (handle.clone(), deliveries.len());
    let receiving =
        tokio::spawn(async move { handle.receive(&address(factory), deliveries).await });
    let Batch { messages, stored, .. } = batches.recv().await.expect("a batch");
    stored.send(vec![true; messages.len()]).expect("it waits for the answer");
    assert_eq!(receiving.await.expect("it ends"), vec![Settlement::Accept; count]);
    let code = |message: &Incoming| match &message.content {
        Content::Dead(letter) => Some(letter.code),
        _ => None,
    };
    messages.iter().filter_map(code).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn beyond_its_share_a_factory_on_one_line_is_set_aside_and_another_one_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let (handle, mut batches) = handle_where(&folder, false, u64::MAX).await;
    let begun = std::time::Instant::now();
    // Used up for a minute.
    let free = handle.pace.take(&address(1), 100_000, begun + Duration::from_secs(60));
    assert_eq!(free, Duration::ZERO);
    assert_eq!(codes_of_next(&handle, &mut batches, 1).await, [QUOTA_EXCEEDED; 2]);
    let of_other = codes_of_next(&handle, &mut batches, 2).await;
    assert!(!of_other.contains(&QUOTA_EXCEEDED), "{of_other:?}");
    assert!(begun.elapsed() < Duration::from_secs(20), "nobody waited");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_factory_without_room_still_asks_for_its_lease() {
    let folder = tempfile::tempdir().expect("a folder");
    let (handle, mut batches) = handle_where(&folder, false, 0).await;
    assert_eq!(codes_of_next(&handle, &mut batches, 1).await, [QUOTA_EXCEEDED; 2]);
    let body = br#"{ "messageType": "lease-request", "messageId": "asks", "factoryId": "F1", "instanceId": "i",
        "place": "p", "host": "h", "startedAt": "2026-01-01T00:00:00Z" }"#;
    let asks = Delivery {
        envelope: Envelope::new("asks".parse().expect("an id"), "lease-request", body.to_vec()),
        is_redelivered: false,
        delivery_count: 0,
        received_at: time::OffsetDateTime::UNIX_EPOCH,
    };
    assert_eq!(codes_of(&handle, &mut batches, 1, vec![asks]).await, [""; 0]);
}

fn address(factory: usize) -> LogicalAddress {
    format!("factory.F{factory}.ingress").parse().expect("an address")
}

/// Returns what waits for the writer once nothing more comes.
async fn waiting(batches: &mut mpsc::Receiver<Batch>) -> Vec<Batch> {
    let mut found = Vec::new();
    let patience = |first: bool| Duration::from_secs(if first { 20 } else { 1 });
    while let Ok(Some(batch)) =
        tokio::time::timeout(patience(found.is_empty()), batches.recv()).await
    {
        found.push(batch);
    }
    found
}

#[tokio::test(flavor = "multi_thread")]
async fn a_batch_that_unpacks_to_much_is_decoded_in_portions() {
    let folder = tempfile::tempdir().expect("a folder");
    let (handle, mut batches) = handle(&folder).await;
    let receiving = tokio::spawn(async move { handle.receive(&address(1), deliveries(20)).await });
    let mut sizes = Vec::new();
    for is_stored in [true, true, false] {
        let mut now = waiting(&mut batches).await;
        assert_eq!(now.len(), 1, "the next portion waits until this one is written");
        let Batch { messages, stored, .. } = now.remove(0);
        sizes.push(messages.len());
        stored.send(vec![is_stored; messages.len()]).expect("it waits for the answer");
    }
    let most = PORTION_BYTES_MAX.div_ceil(MESSAGE_BYTES);
    assert_eq!(sizes, [most; 3]);
    let settled = receiving.await.expect("it ends");
    let accepted = settled.iter().take_while(|one| **one == Settlement::Accept).count();
    assert_eq!(accepted, 2 * most, "what is written is settled");
    assert!(settled[accepted..].iter().all(|one| *one == Settlement::Release));
    assert!(is_idle(&mut batches), "behind what comes again nothing is written");
}

fn is_idle(batches: &mut mpsc::Receiver<Batch>) -> bool {
    batches.try_recv().is_err()
}

#[tokio::test(flavor = "multi_thread")]
async fn all_senders_together_decode_a_bounded_amount_and_take_turns() {
    let folder = tempfile::tempdir().expect("a folder");
    let (handle, mut batches) = handle(&folder).await;
    let senders = 20;
    let receiving: Vec<_> = (0..senders)
        .map(|factory| {
            let handle = handle.clone();
            tokio::spawn(async move { handle.receive(&address(factory), deliveries(6)).await })
        })
        .collect();
    let mut rounds = 0;
    let mut served = Vec::new();
    while served.len() < senders {
        let now = waiting(&mut batches).await;
        let bytes: usize = now.iter().map(|batch| batch.messages.len() * MESSAGE_BYTES).sum();
        assert!((1..=DECODED_BYTES_MAX).contains(&bytes), "{bytes} bytes at a time");
        for Batch { address, messages, stored } in now {
            served.push(address);
            stored.send(vec![true; messages.len()]).expect("it waits for the answer");
        }
        rounds += 1;
    }
    assert!(rounds > 1, "not all at once");
    for receiving in receiving {
        assert_eq!(receiving.await.expect("it ends"), vec![Settlement::Accept; 6]);
    }
}
