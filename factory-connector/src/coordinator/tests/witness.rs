//! The ledger against a platform that countersigns it, with faults on either side.

use std::collections::BTreeMap;

use ::ledger::{ConflictKind, audit::Auditor};
use asi_model::{
    OrganisationId,
    messages::{LedgerCheckpoint, LedgerCheckpointResult, LedgerCosignature, PlatformMessage},
};
use connector_state::use_cases::witness::NewLogDecision;
use ed25519_dalek::SigningKey;
use transparency_log::{
    AddCheckpoint, KeyKind, NoteKey, Refusal, SignedNote, TreeHead, VerifierKey, witness,
};

use super::{retention::Plant, *};
use crate::store::Ledger;

/// The platform: what it holds of each log, by recipient and epoch.
struct Platform {
    key: NoteKey,
    held: BTreeMap<(OrganisationId, u32), (TreeHead, SignedNote)>,
    answered: Vec<asi_model::MessageId>,
}

impl Platform {
    fn new() -> Self {
        let secret = SigningKey::from_bytes(&[9; 32]);
        let key = NoteKey::new("cloud/witness", KeyKind::CosignatureV1, secret);
        Self { key: key.expect("a name"), held: BTreeMap::new(), answered: Vec::new() }
    }

    fn answer(&mut self, message: &LedgerCheckpoint) -> LedgerCosignature {
        let log = (message.recipient_id.clone(), message.epoch);
        let request: AddCheckpoint = message.add_checkpoint.parse().expect("a request");
        let key: VerifierKey = message.verifier_key.parse().expect("a key");
        let known = self.held.get(&log).map_or_else(TreeHead::empty, |(head, _)| *head);
        let result = match witness::accept(&request, &key, &known) {
            Ok(checkpoint) => {
                let mut note = request.checkpoint;
                note.cosign(&self.key, 1_700_000_000).expect("cosigned");
                let head = TreeHead { size: checkpoint.size, root: checkpoint.root };
                self.held.insert(log.clone(), (head, note));
                LedgerCheckpointResult::Cosigned
            }
            Err(Refusal::Stale { .. }) => LedgerCheckpointResult::Stale,
            Err(Refusal::Inconsistent(_)) => LedgerCheckpointResult::Inconsistent,
            Err(other) => panic!("{other}"),
        };
        LedgerCosignature {
            message_id: new_message_id(),
            factory_id: message.factory_id.clone(),
            correlation_id: message.message_id.clone(),
            recipient_id: message.recipient_id.clone(),
            epoch: message.epoch,
            result,
            checkpoint: self.held.get(&log).map(|(_, note)| note.to_string()),
            witness_key: self.key.verifier().to_string(),
        }
    }

    /// Answers the checkpoints that wait, each once; the results.
    async fn serve(&mut self, running: &Running) -> Vec<LedgerCheckpointResult> {
        let mut results = Vec::new();
        // Commands wait for the first transaction, which has the checkpoints of the start.
        running.coordinator.read(|_| ()).await.expect("it runs");
        for row in running.fetch(Lane::Control).await {
            if row.envelope.subject != "ledger-checkpoint" {
                continue;
            }
            let message = serde_json::from_slice::<LedgerCheckpoint>(&row.envelope.body);
            let message = message.expect("a checkpoint");
            if self.answered.contains(&message.message_id) {
                continue;
            }
            self.answered.push(message.message_id.clone());
            let answer = self.answer(&message);
            results.push(answer.result);
            deliver(running, answer).await;
        }
        results
    }

    fn size(&self, epoch: u32) -> Option<u64> {
        self.held.get(&(acme(), epoch)).map(|(head, _)| head.size)
    }
}

async fn deliver(running: &Running, answer: LedgerCosignature) {
    let body = serde_json::to_value(PlatformMessage::LedgerCosignature(answer)).expect("JSON");
    running.receive("ledger-cosignature", body).await;
}

fn acme() -> OrganisationId {
    "acme".parse().expect("an id")
}

async fn conflict(running: &Running) -> Option<ConflictKind> {
    let read = running.coordinator.read(|state| {
        let log = state.ledger().log(&acme())?;
        log.witnessing().conflict().map(|conflict| conflict.kind)
    });
    read.await.expect("it runs")
}

async fn witnessed(running: &Running) -> u64 {
    let read = running.coordinator.read(|state| {
        state.ledger().log(&acme()).map_or(0, |log| log.witnessing().witnessed().end())
    });
    read.await.expect("it runs")
}

/// Stops and starts on the same store.
async fn restarted(running: Running) -> Running {
    let folder = running.close().await;
    Running::open_in(folder.path().to_owned(), Some(folder)).await
}

/// Puts the store's files of one folder in place of those of another.
fn copy_store(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(to).expect("a folder").map(|entry| entry.expect("a file")) {
        if entry.file_name().to_string_lossy().starts_with("connector.sqlite") {
            std::fs::remove_file(entry.path()).expect("removed");
        }
    }
    for entry in std::fs::read_dir(from).expect("a folder").map(|entry| entry.expect("a file")) {
        if entry.file_name().to_string_lossy().starts_with("connector.sqlite") {
            std::fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
        }
    }
}

/// A connector whose log the platform countersigned, with an older copy of its store.
async fn countersigned() -> (Platform, Running, TempDir) {
    let mut platform = Platform::new();
    let running = Running::with_two_open_fields().await;
    running.enter_both(1).await;
    let folder = running.close().await;
    let older = tempfile::tempdir().expect("a folder");
    copy_store(folder.path(), older.path());
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    // More than a store that was set back reports by itself, in its new epochs.
    for number in 2..8 {
        running.enter_both(number).await;
    }
    let running = restarted(running).await;
    // Every start submits; the answer to the first is followed by one to the last.
    platform.serve(&running).await;
    let running = restarted(running).await;
    platform.serve(&running).await;
    assert_eq!(platform.size(1), Some(witnessed(&running).await));
    (platform, running, older)
}

#[tokio::test]
async fn a_countersigned_log_stays_so_across_restarts() {
    let (mut platform, running, _older) = countersigned().await;
    let size = witnessed(&running).await;
    assert!(size > 4, "{size}");
    let running = restarted(running).await;
    assert_eq!(witnessed(&running).await, size, "it is stored");
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Cosigned; 2]);
    running.enter_both(3).await;
    assert!(!running.fetch(Lane::Reports).await.is_empty());
    let running = restarted(running).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Cosigned; 2]);
    assert!(witnessed(&running).await > size);
    assert_eq!(conflict(&running).await, None);
    running.close().await;
}

/// A store that was set back tells nobody anything before the platform has shown that it was.
#[tokio::test]
async fn after_a_start_reports_wait_for_the_word_of_the_witness() {
    let (mut platform, running, _older) = countersigned().await;
    let folder = running.close().await;
    let older = tempfile::tempdir().expect("a folder");
    copy_store(folder.path(), older.path());
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    running.enter_both(9).await;
    assert_eq!(running.fetch(Lane::Reports).await, [], "the platform has not answered");
    platform.serve(&running).await;
    assert_eq!(conflict(&running).await, None);
    assert!(!running.fetch(Lane::Reports).await.is_empty(), "it holds the same history");
    let running = restarted(running).await;
    platform.serve(&running).await;

    let folder = running.close().await;
    copy_store(older.path(), folder.path());
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    running.enter_both(10).await;
    assert_eq!(running.fetch(Lane::Reports).await, [], "the platform has not answered");
    platform.serve(&running).await;
    assert!(conflict(&running).await.is_some(), "it holds another history");
    assert_eq!(running.fetch(Lane::Reports).await, [], "and nothing has left");
    running.close().await;
}

#[tokio::test]
async fn a_platform_that_does_not_answer_delays_reports_for_a_bounded_time() {
    let (_platform, running, _older) = countersigned().await;
    let folder = running.close().await;
    let (interval, wait) = (Duration::from_millis(1), Duration::from_millis(300));
    let running =
        Running::open_waiting(folder.path().to_owned(), Some(folder), interval, wait).await;
    running.enter_both(9).await;
    tokio::time::sleep(2 * wait).await;
    assert_eq!(running.fetch(Lane::Reports).await, [], "time without a connection does not count");
    let begin = std::time::Instant::now();
    while running.fetch(Lane::Reports).await.is_empty() {
        assert!(begin.elapsed() < DEADLINE, "nothing leaves");
        tokio::time::sleep(PAUSE).await;
    }
    assert!(begin.elapsed() >= wait);
    running.close().await;
}

#[tokio::test]
async fn an_older_store_discloses_nothing_until_a_new_log_begins() {
    let (mut platform, running, older) = countersigned().await;
    let folder = running.close().await;
    copy_store(older.path(), folder.path());
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    assert!(!running.fetch(Lane::Reports).await.is_empty(), "the platform has not answered");
    let composed = running.fetch(Lane::Reports).await;
    platform.serve(&running).await;
    assert_eq!(conflict(&running).await, Some(ConflictKind::RolledBack));
    running.enter_both(7).await;
    assert_eq!(running.fetch(Lane::Reports).await, [], "values wait");
    assert_eq!(running.accept(&composed).await, 0, "what was composed before waits, too");
    assert!(!running.fetch(Lane::Control).await.is_empty(), "all else goes on");
    let running = restarted(running).await;
    assert_eq!(conflict(&running).await, Some(ConflictKind::RolledBack), "it is stored");
    assert_eq!(running.fetch(Lane::Reports).await, []);

    for recipient in ["acme", "hull"] {
        let decision = NewLogDecision {
            recipient: recipient.parse().expect("an id"),
            decided_by: "eve".to_owned(),
            reason: "Disk replaced".to_owned(),
        };
        let begun = running.coordinator.begin_log(decision.clone()).await;
        assert_eq!(begun, Ok(true));
        assert_eq!(running.coordinator.begin_log(decision).await, Ok(false), "it is settled");
    }
    assert!(!running.fetch(Lane::Reports).await.is_empty(), "values leave again");
    platform.serve(&running).await;
    assert_eq!(platform.size(2), Some(witnessed(&running).await));
    assert_eq!(conflict(&running).await, None);
    let running = restarted(running).await;
    assert_eq!(conflict(&running).await, None);
    let folder = running.close().await;
    audit_second_log(&platform, folder.path()).await;
}

/// The new log has every entry, says what it replaced, and is proven by the platform's checkpoint.
async fn audit_second_log(platform: &Platform, folder: &Path) {
    let mut connection = connect(folder).await;
    let mut ledger = Ledger(&mut connection);
    let intact = ledger.verify(None).await.expect("read");
    assert!(intact.is_intact(), "{intact:?}");
    let start = ledger.audit_start(&acme(), None).await.expect("read").expect("a log");
    assert_eq!(start.number, 0, "all entries");
    assert!(start.log_start.contains("Disk replaced") && start.log_start.contains("to/acme\\n"));
    let entries = ledger.audit_entries(&acme(), 0).await.expect("read");
    let key = ledger.log_checkpoint(&acme()).await.expect("read").expect("a checkpoint").key;
    assert_eq!(key.name(), "F/to/acme/2");
    let (_, note) = &platform.held[&(acme(), 2)];
    let start = serde_json::to_string(&start).expect("JSON");
    let mut auditor = Auditor::new(&note.to_string(), &key, &start, None).expect("its log");
    auditor.demand_witness(platform.key.verifier()).expect("countersigned");
    for entry in &entries {
        auditor.take(&serde_json::to_string(entry).expect("JSON"));
    }
    let audit = auditor.finish();
    assert!(audit.is_intact() && audit.entries_proven > 0, "{audit:?}");
}

#[tokio::test]
async fn a_store_that_was_set_back_and_outgrew_the_platform_is_found() {
    let (mut platform, running, older) = countersigned().await;
    let size = witnessed(&running).await;
    let folder = running.close().await;
    copy_store(older.path(), folder.path());
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    // The checkpoint of the start is lost on its way, and the store grows.
    let lost = running.fetch(Lane::Control).await;
    running.accept(&lost).await;
    for number in 0..size {
        running.enter_both(number).await;
    }
    let running = restarted(running).await;
    platform.serve(&running).await;
    assert_eq!(conflict(&running).await, Some(ConflictKind::Replaced));
    assert_eq!(running.fetch(Lane::Reports).await, []);
    running.close().await;
}

#[tokio::test]
async fn a_platform_that_lost_its_store_gets_everything_again() {
    let (mut platform, running, _older) = countersigned().await;
    platform.held.clear();
    let running = restarted(running).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Stale; 2]);
    assert_eq!((conflict(&running).await, witnessed(&running).await), (None, 0));
    let running = restarted(running).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Cosigned; 2]);
    assert_eq!(platform.size(1), Some(witnessed(&running).await));
    assert!(!running.fetch(Lane::Reports).await.is_empty(), "nothing was held back");
    running.close().await;
}

#[tokio::test]
async fn a_platform_with_an_older_store_gets_the_proof_from_there() {
    let (mut platform, running, _older) = countersigned().await;
    let older = platform.held.clone();
    running.enter_both(3).await;
    let running = restarted(running).await;
    platform.serve(&running).await;
    platform.held = older;
    let running = restarted(running).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Stale; 2]);
    assert_eq!(
        (conflict(&running).await, platform.size(1)),
        (None, Some(witnessed(&running).await))
    );
    let running = restarted(running).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Cosigned; 2]);
    running.close().await;
}

#[tokio::test]
async fn repeated_and_unsigned_answers_do_no_harm() {
    let (mut platform, running, _older) = countersigned().await;
    let running = restarted(running).await;
    let size = witnessed(&running).await;
    let rows = running.fetch(Lane::Control).await;
    let row = rows.iter().rfind(|row| row.envelope.subject == "ledger-checkpoint");
    let body = &row.expect("a checkpoint").envelope.body;
    let message: LedgerCheckpoint = serde_json::from_slice(body).expect("a checkpoint");
    let answer = platform.answer(&message);
    let mut forged = answer.clone();
    forged.checkpoint = answer.checkpoint.as_ref().map(|note| note.replacen('A', "B", 1));
    for answer in [&forged, &answer, &answer, &forged] {
        let again = LedgerCosignature { message_id: new_message_id(), ..answer.clone() };
        deliver(&running, again).await;
    }
    assert_eq!((conflict(&running).await, witnessed(&running).await), (None, size));
    // The other log waits for its answer, too.
    platform.serve(&running).await;
    assert!(!running.fetch(Lane::Reports).await.is_empty());
    running.close().await;
}

#[tokio::test]
async fn retention_leaves_what_the_proof_of_the_next_checkpoint_needs() {
    let (mut platform, running, _older) = countersigned().await;
    let size = witnessed(&running).await;
    running.enter_both(5).await;
    let folder = running.close().await;
    let later = DateTime::from_unix_micros(now().unix_micros() + 1_000_000);
    let mut connection = connect(folder.path()).await;
    let done = sqlx::query("UPDATE report SET state = 'DONE'").execute(&mut connection).await;
    done.expect("no report is in the spool");
    let mut plant = Plant::open(folder.path()).await;
    plant.commit().await;
    plant.remove_entries(later).await;
    plant.store.close().await;
    let first = "SELECT min(number) FROM ledger_entry WHERE recipient = 'acme'";
    let first: i64 = sqlx::query_scalar(first).fetch_one(&mut connection).await.expect("read");
    // The first leaf is no entry.
    assert_eq!(first.unsigned_abs(), size, "the entry after the countersigned ones");
    let running = Running::open_in(folder.path().to_owned(), Some(folder)).await;
    assert_eq!(platform.serve(&running).await, [LedgerCheckpointResult::Cosigned; 2]);
    assert!(witnessed(&running).await > size);
    running.close().await;
}
