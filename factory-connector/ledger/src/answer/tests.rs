//! A log against a platform that follows the rule of a witness, with faults on either side.

use asi_model::{FactoryId, OrganisationId};
use transparency_log::{AddCheckpoint, NoteKey, Refusal, witness};

use super::*;
use crate::{Head, LogStart};

fn at(seconds: i64) -> DateTime {
    DateTime::from_unix_micros(seconds * 1_000_000)
}

fn key() -> LedgerKey {
    LedgerKey::from_secret(&[1; 32])
}

fn new_log() -> Log {
    let (factory, recipient): (FactoryId, OrganisationId) =
        ("F".parse().expect("an id"), "acme".parse().expect("an id"));
    Log::new(factory, recipient, &Head::default())
}

/// A log with these entries.
fn log_of(entries: &[&str]) -> Log {
    let mut log = new_log();
    entries.iter().for_each(|entry| log.append(entry));
    log
}

/// The platform: what it holds of one log.
struct Platform {
    key: NoteKey,
    held: Option<(TreeHead, SignedNote)>,
}

impl Platform {
    fn new() -> Self {
        Self::with_secret(9)
    }

    fn with_secret(secret: u8) -> Self {
        let secret = ed25519_dalek::SigningKey::from_bytes(&[secret; 32]);
        let key = NoteKey::new("cloud/witness", KeyKind::CosignatureV1, secret);
        Self { key: key.expect("a name"), held: None }
    }

    fn answer(&mut self, request: &AddCheckpoint, log: &Log) -> LedgerCosignature {
        let verifier = log.start().verifier(&key().public()).expect("a key");
        let known = self.held.as_ref().map_or_else(TreeHead::empty, |(head, _)| *head);
        let result = match witness::accept(request, &verifier, &known) {
            Ok(checkpoint) => {
                let mut note = request.checkpoint.clone();
                note.cosign(&self.key, 1_700_000_000).expect("cosigned");
                let head = TreeHead { size: checkpoint.size, root: checkpoint.root };
                self.held = Some((head, note));
                LedgerCheckpointResult::Cosigned
            }
            Err(Refusal::Stale { .. }) => LedgerCheckpointResult::Stale,
            Err(Refusal::Inconsistent(_)) => LedgerCheckpointResult::Inconsistent,
            Err(other) => panic!("{other}"),
        };
        LedgerCosignature {
            message_id: "a".parse().expect("an id"),
            factory_id: log.start().factory_id.clone(),
            correlation_id: "q".parse().expect("an id"),
            recipient_id: log.start().recipient.clone(),
            epoch: log.start().epoch,
            result,
            checkpoint: self.held.as_ref().map(|(_, note)| note.to_string()),
            witness_key: self.key.verifier().to_string(),
        }
    }

    /// Takes a checkpoint of the log, and the log the answer.
    fn witness(&mut self, log: &mut Log) -> Answered {
        let request = log.submit(&key(), at(1));
        let answer = self.answer(&request, log);
        log.receive(&answer, &key(), at(2)).expect("an answer")
    }
}

const COSIGNED: Answered = Answered::Cosigned { is_other_witness: false };

/// The leaves before and after a size, as the store computes them.
fn leaves_of(entries: &[&str], size: u64) -> (LeafRange, LeafRange) {
    let mut older = LeafRange::starting_at(0);
    let mut since = LeafRange::starting_at(size);
    let start = new_log().start().canonical();
    for (number, text) in (0..).zip(std::iter::once(start.as_str()).chain(entries.iter().copied()))
    {
        let leaf = transparency_log::leaf_hash(text.as_bytes());
        if number < size { older.append(leaf) } else { since.append(leaf) }
    }
    (older, since)
}

fn kind_of(log: &Log) -> Option<ConflictKind> {
    log.witnessing().conflict().map(|conflict| conflict.kind)
}

#[test]
fn a_growing_log_is_countersigned_step_by_step() {
    let (mut log, mut platform) = (new_log(), Platform::new());
    for size in 1..40 {
        assert!(log.witnessing().is_due(at(0)), "{size}");
        assert_eq!(platform.witness(&mut log), COSIGNED);
        assert_eq!(log.witnessing().witnessed(), log.leaves(), "{size}");
        assert!(!log.witnessing().is_due(at(0)));
        for entry in 0..size % 3 + 1 {
            log.append(&format!("{size} {entry}"));
        }
    }
    let cosigned = log.witnessing().cosigned().expect("a checkpoint");
    assert_eq!(cosigned.cosigned_at, at(1_700_000_000));
}

#[test]
fn one_checkpoint_is_under_way_at_a_time() {
    let mut log = log_of(&["a"]);
    log.submit(&key(), at(0));
    log.append("b");
    assert!(!log.witnessing().is_due(at(3599)));
    assert!(log.witnessing().is_due(at(3600)), "the answer is overdue");
}

#[test]
fn duplicates_and_answers_out_of_order_do_no_harm() {
    let (mut log, mut platform) = (log_of(&["a", "b"]), Platform::new());
    let first = log.submit(&key(), at(1));
    let answers = [platform.answer(&first, &log), platform.answer(&first, &log)];
    assert_eq!(answers[1].result, LedgerCheckpointResult::Stale, "it was taken already");
    log.append("c");
    for answer in [&answers[1], &answers[0], &answers[1]] {
        assert_eq!(log.receive(answer, &key(), at(2)), Ok(COSIGNED));
    }
    let second = log.submit(&key(), at(3));
    assert_eq!(log.receive(&answers[0], &key(), at(4)), Ok(COSIGNED), "the first one again");
    let answer = platform.answer(&second, &log);
    assert_eq!(log.receive(&answer, &key(), at(5)), Ok(COSIGNED));
    assert_eq!(log.witnessing().witnessed(), log.leaves());
    assert_eq!(kind_of(&log), None);
}

#[test]
fn a_store_that_was_set_back_or_cut_is_found() {
    let mut platform = Platform::new();
    platform.witness(&mut log_of(&["a", "b", "c", "d"]));
    for older in [&[][..], &["a"], &["a", "b", "c"]] {
        let mut log = log_of(older);
        assert_eq!(platform.witness(&mut log), Answered::Conflict, "{older:?}");
        assert_eq!(kind_of(&log), Some(ConflictKind::RolledBack));
        let conflict = log.witnessing().conflict().expect("a conflict");
        assert_eq!(conflict.held_size, Some(5));
        assert!(conflict.checkpoint.is_some() && !log.witnessing().is_due(at(9)));
    }
}

#[test]
fn a_store_that_was_set_back_and_continued_is_found() {
    let mut platform = Platform::new();
    platform.witness(&mut log_of(&["a", "b", "c"]));
    // With the countersigned checkpoint of its own past, and without.
    let mut log = log_of(&["a", "x", "y", "z"]);
    let Answered::OtherSize(held) = platform.witness(&mut log) else { panic!("another size") };
    let leaves = leaves_of(&["a", "x", "y", "z"], held.size());
    assert_eq!(log.compare(held, Some(leaves), at(3)), Answered::Conflict);
    assert_eq!(kind_of(&log), Some(ConflictKind::Replaced));
    // As long as the platform's, and other.
    let mut same_length = log_of(&["a", "x", "y"]);
    assert_eq!(platform.witness(&mut same_length), Answered::Conflict);
    assert_eq!(kind_of(&same_length), Some(ConflictKind::Replaced));
}

#[test]
fn an_edge_that_was_changed_is_found() {
    let mut platform = Platform::new();
    let mut log = log_of(&["a", "b"]);
    platform.witness(&mut log);
    let (older, since) = leaves_of(&["x", "y", "c"], 3);
    let cosigned = log.witnessing().cosigned().cloned();
    let witnessing = crate::Witnessing::stored(older, since, cosigned, None).expect("it follows");
    let leaves = log_of(&["x", "y", "c"]).leaves().clone();
    let mut forged = Log::stored(log.start().clone(), leaves, None).with(witnessing);
    assert_eq!(platform.witness(&mut forged), Answered::Conflict);
    assert_eq!(kind_of(&forged), Some(ConflictKind::Replaced));
}

#[test]
fn the_same_entries_regrown_pass() {
    let mut platform = Platform::new();
    platform.witness(&mut log_of(&["a", "b"]));
    let mut log = log_of(&["a", "b", "c"]);
    let Answered::OtherSize(held) = platform.witness(&mut log) else { panic!("another size") };
    let leaves = leaves_of(&["a", "b", "c"], held.size());
    assert_eq!(log.compare(held, Some(leaves), at(3)), COSIGNED);
    assert!(log.witnessing().is_due(at(3)));
    assert_eq!(platform.witness(&mut log), COSIGNED);
}

#[test]
fn a_checkpoint_whose_entries_are_gone_cannot_be_proven() {
    let mut platform = Platform::new();
    platform.witness(&mut log_of(&["a"]));
    let mut log = log_of(&["a", "b"]);
    let Answered::OtherSize(held) = platform.witness(&mut log) else { panic!("another size") };
    assert_eq!(log.compare(held, None, at(3)), Answered::Conflict);
    assert_eq!(kind_of(&log), Some(ConflictKind::Unprovable));
}

#[test]
fn a_platform_that_lost_its_store_begins_again() {
    let mut log = log_of(&["a", "b"]);
    Platform::new().witness(&mut log);
    log.append("c");
    let mut forgetful = Platform::with_secret(8);
    assert_eq!(forgetful.witness(&mut log), Answered::Forgotten { former_size: 3 });
    assert!(log.witnessing().cosigned().is_some(), "the evidence stays");
    assert!(log.witnessing().is_due(at(3)));
    assert_eq!(forgetful.witness(&mut log), Answered::Cosigned { is_other_witness: true });
    assert_eq!(log.witnessing().witnessed().end(), 4);
}

#[test]
fn a_platform_with_an_older_store_is_brought_up_to_date() {
    let mut log = log_of(&["a"]);
    let mut platform = Platform::new();
    platform.witness(&mut log);
    let older = platform.held.clone();
    log.append("b");
    platform.witness(&mut log);
    platform.held = older;
    log.append("c");
    let Answered::OtherSize(held) = platform.witness(&mut log) else { panic!("another size") };
    let leaves = leaves_of(&["a", "b", "c"], held.size());
    assert_eq!(log.compare(held, Some(leaves), at(3)), COSIGNED);
    assert_eq!(platform.witness(&mut log), COSIGNED);
}

#[test]
fn another_key_and_a_later_log_are_conflicts_and_an_earlier_one_is_past() {
    let mut platform = Platform::new();
    let check = |change: &dyn Fn(&mut LedgerCosignature), epoch: u32, kind| {
        let start = LogStart { epoch, ..new_log().start().clone() };
        let mut log = Log::beginning(start);
        let request = log.submit(&key(), at(1));
        let mut answer = Platform::new().answer(&request, &log);
        change(&mut answer);
        let answered = log.receive(&answer, &key(), at(2)).expect("an answer");
        let expected =
            if kind_of(&log).is_some() { Answered::Conflict } else { Answered::Outdated };
        assert_eq!((answered, kind_of(&log)), (expected, kind));
    };
    let other_key =
        |answer: &mut LedgerCosignature| answer.result = LedgerCheckpointResult::OtherKey;
    check(&other_key, 1, Some(ConflictKind::OtherKey));
    check(&|answer| answer.epoch = 2, 1, Some(ConflictKind::Superseded));
    check(&|answer| answer.epoch = 1, 2, None);
    assert_eq!(platform.witness(&mut log_of(&["a"])), COSIGNED);
}

#[test]
fn an_answer_without_both_signatures_proves_nothing() {
    let (mut log, mut platform) = (log_of(&["a"]), Platform::new());
    let request = log.submit(&key(), at(1));
    let good = platform.answer(&request, &log);
    let mut unsigned = good.clone();
    unsigned.checkpoint = Some(request.checkpoint.to_string());
    let mut other = good.clone();
    other.witness_key = Platform::with_secret(8).key.verifier().to_string();
    let mut foreign = good.clone();
    foreign.checkpoint = good.checkpoint.as_ref().map(|note| note.replace("F/to", "G/to"));
    let mut wrong_kind = good.clone();
    wrong_kind.witness_key = log.start().verifier(&key().public()).expect("a key").to_string();
    for answer in [&unsigned, &other, &foreign, &wrong_kind] {
        let before = log.clone();
        assert!(log.receive(answer, &key(), at(2)).is_err(), "{answer:?}");
        assert_eq!(log, before);
    }
    assert_eq!(log.receive(&good, &key(), at(2)), Ok(COSIGNED));
}

#[test]
fn the_first_leaf_of_a_first_log_is_what_it_always_was() {
    insta::assert_snapshot!(new_log().start().canonical(), @r#"{"factoryId":"F","recipient":"acme","number":0,"hash":"0000000000000000000000000000000000000000000000000000000000000000"}"#);
    let second = LogStart { epoch: 2, ..new_log().start().clone() };
    assert_eq!(second.origin(), "F/to/acme/2");
}
