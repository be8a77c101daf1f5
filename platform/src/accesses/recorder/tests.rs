//! Tests of the recorder on a storage that fails when told to.

use std::sync::atomic::{AtomicBool, Ordering};

use access_log::AgentKind;
use asi_model::{FactoryId, RequestKey};

use super::*;
use crate::accesses::Values;

/// A value of one field of each factory.
#[derive(Debug, Clone, PartialEq)]
struct Shown(Vec<&'static str>);

impl Values for Shown {
    fn contents(&self) -> Vec<Contents> {
        let request = RequestKey {
            operation_network_id: "net".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: "req".parse().expect("an id"),
        };
        let factories: Vec<FactoryId> =
            self.0.iter().map(|factory| factory.parse().expect("an id")).collect();
        Contents::gather(factories.iter().map(|factory| (factory, &request, "count", None)))
    }
}

#[derive(Default)]
struct Storage {
    is_failing: AtomicBool,
    entries: Mutex<Vec<Reading>>,
}

#[async_trait]
impl AccessStorage for Storage {
    async fn append(&self, readings: &[Reading], _: DateTime) -> Result<(), NotRecorded> {
        if self.is_failing.load(Ordering::SeqCst) {
            return Err(NotRecorded::Storage("full".into()));
        }
        self.entries.lock().extend_from_slice(readings);
        Ok(())
    }

    async fn sign_checkpoints(&self, _: &AccessLogKey) -> Result<(), NotRecorded> {
        Ok(())
    }
}

fn reader() -> Reader {
    let organisation_id = "acme".parse().expect("an id");
    Reader { organisation_id, kind: AgentKind::User, name: "ann".to_owned(), role: None }
}

fn recorder() -> (Arc<Storage>, AccessRecorder) {
    let storage = Arc::new(Storage::default());
    let (key, clock) =
        (AccessLogKey::from_secret(&[1; 32]), Clock::from_fn(|| DateTime::from_ticks(1)));
    (Arc::clone(&storage), AccessRecorder::new(storage, key, clock))
}

#[tokio::test]
async fn nothing_is_handed_out_that_is_not_on_record() {
    let (storage, recorder) = recorder();
    let values = Withheld::new(Shown(vec!["F", "G"]));
    storage.is_failing.store(true, Ordering::SeqCst);
    let refused = recorder.show(Some(&reader()), AccessKind::Looked, &values).await;
    assert!(matches!(refused, Err(NotRecorded::Storage(_))));
    storage.is_failing.store(false, Ordering::SeqCst);
    let refused = recorder.show(None, AccessKind::Looked, &values).await;
    assert!(matches!(refused, Err(NotRecorded::Nobody)));
    assert!(storage.entries.lock().is_empty());
    let shown = recorder.disclose(Some(&reader()), AccessKind::Looked, values).await;
    assert_eq!(shown.expect("recorded"), Shown(vec!["F", "G"]));
    assert_eq!(storage.entries.lock().len(), 2, "an entry for each factory");
}

/// A storage in which each entry takes for ever; it notes whose they are.
#[derive(Default)]
struct BusyStorage(Mutex<Vec<String>>);

#[async_trait]
impl AccessStorage for BusyStorage {
    async fn append(&self, readings: &[Reading], _: DateTime) -> Result<(), NotRecorded> {
        self.0.lock().extend(readings.iter().map(|one| one.reader.organisation_id.to_string()));
        std::future::pending().await
    }

    async fn sign_checkpoints(&self, _: &AccessLogKey) -> Result<(), NotRecorded> {
        Ok(())
    }
}

#[tokio::test]
async fn streams_of_one_organisation_wait_for_the_writer_in_a_line_of_their_own() {
    let storage = Arc::new(BusyStorage::default());
    let (key, clock) =
        (AccessLogKey::from_secret(&[1; 32]), Clock::from_fn(|| DateTime::from_ticks(1)));
    let recorder = AccessRecorder::new(Arc::<BusyStorage>::clone(&storage), key, clock);
    for number in 0..64 {
        let reader = Reader { name: format!("p{number}"), ..reader() };
        let recorder = recorder.clone();
        tokio::spawn(async move {
            let values = Withheld::new(Shown(vec!["F"]));
            recorder.show(Some(&reader), AccessKind::Streamed, &values).await.map(|_| ())
        });
    }
    let other = Reader { organisation_id: "other".parse().expect("an id"), ..reader() };
    let values = Withheld::new(Shown(vec!["F"]));
    let shown = recorder.show(Some(&other), AccessKind::Streamed, &values);
    let pause = Duration::from_millis(200);
    assert!(tokio::time::timeout(pause, shown).await.is_err(), "it is being written");
    let mut writing = storage.0.lock().clone();
    writing.sort();
    assert_eq!(writing, ["acme", "acme", "other"]);
}

#[tokio::test]
async fn what_has_no_values_is_no_access() {
    let (storage, recorder) = recorder();
    storage.is_failing.store(true, Ordering::SeqCst);
    let nothing = Withheld::new(Shown(Vec::new()));
    assert!(recorder.disclose(None, AccessKind::Looked, nothing).await.is_ok());
}

#[tokio::test]
async fn counts_wait_for_a_store_that_fails() {
    let (storage, recorder) = recorder();
    let values = Withheld::new(Shown(vec!["F"]));
    for _ in 0..5 {
        recorder.show(Some(&reader()), AccessKind::Streamed, &values).await.expect("recorded");
    }
    storage.is_failing.store(true, Ordering::SeqCst);
    assert!(recorder.settle().await.is_err());
    storage.is_failing.store(false, Ordering::SeqCst);
    recorder.settle().await.expect("recorded");
    recorder.settle().await.expect("nothing to do");
    let counts: Vec<u64> =
        storage.entries.lock().iter().map(|entry| entry.contents.value_count).collect();
    assert_eq!(counts, [1, 4]);
}

#[tokio::test]
async fn what_leaves_by_a_transaction_is_divided_and_counted_after_it() {
    let (storage, recorder) = recorder();
    let reading = |at| Reading {
        reader: reader(),
        kind: AccessKind::Forwarded,
        contents: Shown(vec!["F"]).contents().remove(0),
        since: DateTime::from_ticks(at),
    };
    let (entries, counted) = recorder.divide(vec![reading(1), reading(2)]);
    assert_eq!((entries.len(), counted.len()), (1, 0));
    assert_eq!(entries[0].contents.value_count, 2);
    // A transaction that failed leaves nothing behind.
    let (entries, _) = recorder.divide(vec![reading(1)]);
    recorder.written(&entries, Vec::new());
    let (entries, counted) = recorder.divide(vec![reading(3)]);
    assert_eq!((entries.len(), counted.len()), (0, 1));
    recorder.written(&entries, counted);
    recorder.settle().await.expect("recorded");
    assert_eq!(storage.entries.lock().len(), 1);
}

#[test]
fn withheld_values_are_not_in_any_text() {
    let text = format!("{:?}", Withheld::new(Shown(vec!["F"])));
    assert!(text.contains("count") && !text.contains("Shown"), "{text}");
}
