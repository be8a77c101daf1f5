mod tampering;

use std::collections::BTreeMap;

use asi_model::{FactoryId, OrganisationId};
use serde_json::{Value, json, value::RawValue};
use transparency_log::{KeyKind, VerifierKey};

use super::*;
use crate::{
    Event, Head, Heads, LedgerKey, Log, RetentionRule, RetentionStatement, SequenceRange,
    log_verifier, values_root,
};

fn factory() -> FactoryId {
    "F".parse().expect("an id")
}

fn acme() -> OrganisationId {
    "acme".parse().expect("an id")
}

fn key() -> LedgerKey {
    LedgerKey::from_secret(&[1; 32])
}

fn vkey(key: &LedgerKey) -> VerifierKey {
    log_verifier(&factory(), &acme(), &key.public()).expect("a key")
}

const fn range(first_sequence: u32, last_sequence: u32) -> SequenceRange {
    SequenceRange { data_set_writer_id: 7, epoch: 3, first_sequence, last_sequence }
}

fn report(sequence: u32, value: u32) -> String {
    format!(
        r#"{{"DataSetWriterId":7,"SequenceNumber":{sequence},"Timestamp":"2026-11-21T10:00:00Z","Payload":{{"recipientList":{{"Type":12,"Body":["acme","other"]}},"progress":{{"Type":9,"Body":{value}}}}}}}"#
    )
}

/// The report whose values retention has emptied.
const EMPTIED: u32 = 4;

/// Line of an entry without a report.
fn bare_line(entry: &str) -> String {
    let line = json!({ "entry": entry, "report": null, "salt": null, "sentAt": null,
                       "messageId": null, "deliveredAt": null });
    line.to_string()
}

/// A file with an entry of each kind, and the log over it.
struct Sample {
    lines: Vec<String>,
    log: Log,
    /// Checkpoint over the first entries: what became of the reports came later.
    early: String,
    /// Checkpoint over all but the statement of retention.
    kept: String,
}

impl Sample {
    fn new(value: u32) -> Self {
        Self::signed_by(value, &key())
    }

    fn signed_by(value: u32, key: &LedgerKey) -> Self {
        let events: Vec<Event> = events(value);
        let (mut heads, mut log) =
            (Heads::default(), Log::new(factory(), acme(), &Head::default()));
        let mut start = AuditStart {
            log_start: log.start().canonical(),
            number: 0,
            leaves: log.leaves().hashes().iter().map(hex::encode).collect(),
            checkpoint: None,
        };
        let mut checkpoints = Vec::new();
        let mut lines = vec![String::new()];
        for (second, event) in (1..).zip(events) {
            let queued = match &event {
                Event::Queued { range, .. } => Some(range.first_sequence),
                _ => None,
            };
            let at = DateTime::from_unix_micros(second * 1_000_000);
            let entry = heads.append(&acme(), at, event);
            log.append(&entry.content);
            let is_sent = queued.is_some_and(|sequence| sequence < 3);
            let with_values = queued.filter(|sequence| *sequence != EMPTIED);
            let line = AuditEntry {
                entry: entry.content,
                report: with_values
                    .map(|sequence| RawValue::from_string(report(sequence, value)).expect("JSON")),
                salt: with_values.map(|_| hex::encode([9; 16])),
                sent_at: is_sent.then(|| DateTime::from_unix_micros(7_000_000)),
                message_id: is_sent.then(|| "m1".parse().expect("an id")),
                delivered_at: is_sent.then(|| DateTime::from_unix_micros(8_000_000)),
            };
            lines.push(serde_json::to_string(&line).expect("serialises"));
            log.sign_checkpoint(key);
            checkpoints.push(log.checkpoint().expect("signed").to_owned());
        }
        let [.., kept, newest] = &checkpoints[..] else { panic!("there are entries") };
        start.checkpoint = Some(newest.clone());
        lines[0] = serde_json::to_string(&start).expect("serialises");
        Self { lines, log, early: checkpoints[5].clone(), kept: kept.clone() }
    }

    fn checkpoint(&self) -> String {
        self.log.checkpoint().expect("signed").to_owned()
    }
}

fn events(value: u32) -> Vec<Event> {
    let consent = |version, step| {
        let entry = json!({
            "event": "CONSENT",
            "field": { "operationNetworkId": "n", "operationId": "op",
                       "dynamicDataRequestId": "r", "fieldName": "progress" },
            "version": version, "mappingState": "MAPPED", "valueSource": "MANUAL",
            "policy": { "roundingStep": step, "delayMs": 60_000 }, "decidedBy": "eve" });
        serde_json::from_value::<Event>(entry).expect("an event")
    };
    let queued = |sequence| Event::Queued {
        range: range(sequence, sequence),
        values: hex::encode(values_root(&report(sequence, value), &[9; 16]).expect("a report")),
        consents: BTreeMap::from([("progress".parse().expect("a name"), 1)]),
    };
    vec![
        consent(1, 10),
        queued(0),
        queued(1),
        queued(2),
        queued(3),
        queued(4),
        Event::Sent { range: range(0, 2), message_id: Some("m1".parse().expect("an id")) },
        Event::Receipted(range(0, 2)),
        Event::Coalesced(range(3, 3)),
        Event::Expired(range(4, 4)),
        queued(5),
        queued(6),
        queued(7),
        Event::Purged(range(5, 6)),
        consent(2, 20),
        Event::Revoked {
            revocation_id: "id".to_owned(),
            data_set_writer_id: 7,
            epoch: 3,
            last_sent_sequence: Some(2),
            last_delivered_sequence: Some(2),
        },
        Event::Retention(RetentionStatement {
            rule: RetentionRule::ValueDays,
            days: Some(30),
            before: DateTime::from_unix_micros(7_000_000),
            emptied: vec![range(EMPTIED, EMPTIED)],
            removed_through: None,
        }),
    ]
}

/// Returns the faults; an error to begin is one, too.
fn faults(lines: &[String], checkpoint: &str, key: &VerifierKey) -> u64 {
    let Some((first, rest)) = lines.split_first() else { return 1 };
    let Ok(mut auditor) = Auditor::new(checkpoint, key, first, None) else { return 1 };
    rest.iter().for_each(|line| auditor.take(line));
    auditor.finish().fault_count
}

#[test]
fn an_intact_file_is_intact() {
    let sample = Sample::new(7);
    let mut auditor = Auditor::new(&sample.checkpoint(), &vkey(&key()), &sample.lines[0], None)
        .expect("it begins");
    sample.lines[1..].iter().for_each(|line| auditor.take(line));
    let outcome = auditor.finish();
    assert!(outcome.is_intact(), "{outcome:?}");
    assert_eq!((outcome.entries_proven, outcome.values_compared), (17, 7));
    assert_eq!(outcome.values_emptied, 1);
}

#[test]
fn an_old_checkpoint_proves_a_file_whose_end_is_signed() {
    let sample = Sample::new(7);
    for (checkpoint, proven) in [(&sample.early, 6), (&sample.kept, 16)] {
        let mut auditor =
            Auditor::new(checkpoint, &vkey(&key()), &sample.lines[0], None).expect("it begins");
        sample.lines[1..].iter().for_each(|line| auditor.take(line));
        let outcome = auditor.finish();
        assert!(outcome.is_intact(), "{outcome:?}");
        assert_eq!((outcome.entries_proven, outcome.entries_after), (proven, 17 - proven));
        assert_eq!((outcome.values_emptied, outcome.entries_unsigned), (1, 0));
    }
}

#[test]
fn entries_after_the_checkpoint_are_counted_and_emptied_values_need_a_time() {
    let mut sample = Sample::new(7);
    let at = |seconds: i64| DateTime::from_unix_micros(seconds * 1_000_000);
    let old = Sample::new(7).checkpoint();
    let mut heads = Heads::new([(acme(), Head { number: 17, hash: [0; 32] })]);
    let entry = heads.append(&acme(), at(20), Event::Receipted(range(0, 2)));
    sample.lines.push(bare_line(&entry.content));
    sample.log.append(&entry.content);
    sample.log.sign_checkpoint(&key());
    let mut start: AuditStart = serde_json::from_str(&sample.lines[0]).expect("a start");
    start.checkpoint = Some(sample.checkpoint());
    sample.lines[0] = serde_json::to_string(&start).expect("JSON");
    for index in [2, 3, 4] {
        let mut line: Value = serde_json::from_str(&sample.lines[index]).expect("JSON");
        line["report"] = Value::Null;
        line["salt"] = Value::Null;
        line["deliveredAt"] = json!("1970-01-01T00:00:20Z");
        sample.lines[index] = line.to_string();
    }
    let audit = |emptied_before: Option<DateTime>| {
        let mut auditor =
            Auditor::new(&old, &vkey(&key()), &sample.lines[0], emptied_before).expect("it begins");
        sample.lines[1..].iter().for_each(|line| auditor.take(line));
        auditor.finish()
    };
    let outcome = audit(Some(at(5)));
    assert!(outcome.is_intact(), "{outcome:?}");
    assert_eq!((outcome.entries_proven, outcome.entries_after), (17, 1));
    assert_eq!((outcome.values_compared, outcome.values_emptied), (4, 4));
    assert_eq!(audit(Some(at(3))).fault_count, 2, "those that were queued later");
    assert_eq!(audit(None).fault_count, 3);
}

#[test]
fn a_pruned_chain_is_proven_by_the_leaves_before_it() {
    let pruned = |stated: Option<u64>| {
        let mut sample = Sample::new(7);
        let at = DateTime::from_unix_micros(18_000_000);
        let entry = Heads::new([(acme(), Head { number: 17, hash: [0; 32] })]).append(
            &acme(),
            at,
            Event::Retention(RetentionStatement {
                rule: RetentionRule::EntryDays,
                days: Some(30),
                before: at,
                emptied: Vec::new(),
                removed_through: stated,
            }),
        );
        sample.log.append(&entry.content);
        sample.log.sign_checkpoint(&key());
        let mut before = Log::new(factory(), acme(), &Head::default());
        for line in &sample.lines[1..6] {
            let line: AuditEntry = serde_json::from_str(line).expect("an entry");
            before.append(&line.entry);
        }
        let start = AuditStart {
            log_start: before.start().canonical(),
            number: 5,
            leaves: before.leaves().hashes().iter().map(hex::encode).collect(),
            checkpoint: None,
        };
        let first = serde_json::to_string(&start).expect("serialises");
        let last = bare_line(&entry.content);
        (sample.checkpoint(), [&[first], &sample.lines[6..], &[last]].concat())
    };
    let (checkpoint, lines) = pruned(Some(5));
    assert_eq!(faults(&lines, &checkpoint, &vkey(&key())), 0);
    for (place, other) in [(0, "\"number\":4"), (0, "\"number\":6")] {
        let mut lines = lines.clone();
        lines[place] = lines[place].replacen("\"number\":5", other, 1);
        assert!(faults(&lines, &checkpoint, &vkey(&key())) > 0, "{other}");
    }
    let mut shorter = lines;
    shorter.remove(1);
    assert!(faults(&shorter, &checkpoint, &vkey(&key())) > 0);
    for stated in [None, Some(4), Some(6)] {
        let (checkpoint, lines) = pruned(stated);
        assert_eq!(faults(&lines, &checkpoint, &vkey(&key())), 1, "{stated:?} is stated");
    }
}
