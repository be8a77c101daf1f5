use std::collections::BTreeMap;

use asi_model::{DateTime, FactoryId, OrganisationId};

use super::*;
use crate::{
    Anchor, CheckpointSeal, Heads, HeadsCheckpoint, LedgerKey, LinkedEntry, Log, RetentionRule,
    RetentionStatement, SequenceRange, SignedHead, values_root,
};

mod tampering;

const REPORT: &str = r#"{"SequenceNumber":1,"Payload":{"a":1}}"#;
const SALT: [u8; 16] = [3; 16];

fn factory() -> FactoryId {
    "F".parse().expect("an id")
}

fn key() -> LedgerKey {
    LedgerKey::from_secret(&[1; 32])
}

/// An entry with the report it refers to.
type Row = (StoredEntry, Option<StoredReport>);

fn entries(count: u32) -> (Vec<Row>, Heads, Vec<LinkedEntry>) {
    let mut heads = Heads::default();
    let acme: OrganisationId = "acme".parse().expect("an id");
    let values = hex::encode(values_root(REPORT, &SALT).expect("a report"));
    let mut linked = Vec::new();
    let stored = (0..count).map(|sequence| {
        let range = SequenceRange {
            data_set_writer_id: 1,
            epoch: 1,
            first_sequence: sequence / 2,
            last_sequence: sequence / 2,
        };
        let is_queued = sequence % 2 == 0;
        let event = if is_queued {
            Event::Queued { range, values: values.clone(), consents: BTreeMap::new() }
        } else {
            Event::Sent { range, message_id: None }
        };
        let recorded_at = i64::from(sequence);
        let entry = heads.append(&acme, DateTime::from_unix_micros(recorded_at), event);
        linked.push(entry.clone());
        let stored = StoredEntry {
            number: i64::try_from(entry.number).expect("small"),
            recorded_at,
            report_id: is_queued.then_some(7),
            content: entry.content.into_bytes(),
            hash: entry.hash.to_vec(),
        };
        let report = is_queued.then(|| StoredReport {
            data_set_writer_id: 1,
            epoch: 1,
            sequence: recorded_at / 2,
            created_at: recorded_at,
            recipients: br#"["acme"]"#.to_vec(),
            body: Some(REPORT.as_bytes().to_vec()),
            salt: Some(SALT.to_vec()),
            sent_at: (sequence + 1 < count).then_some(recorded_at + 1),
            ..StoredReport::default()
        });
        (stored, report)
    });
    (stored.collect(), heads.clone(), linked)
}

/// Appends a statement of retention.
fn retained(
    (entries, heads, linked): (&mut Vec<Row>, &mut Heads, &mut Vec<LinkedEntry>),
    rule: RetentionRule,
    emptied: Vec<SequenceRange>,
    removed_through: Option<u64>,
) {
    let recorded_at = i64::try_from(linked.len()).expect("small");
    let at = DateTime::from_unix_micros(recorded_at);
    let statement =
        RetentionStatement { rule, days: Some(1), before: at, emptied, removed_through };
    let recipient = "acme".parse().expect("an id");
    let entry = heads.append(&recipient, at, Event::Retention(statement));
    let stored = StoredEntry {
        number: i64::try_from(entry.number).expect("small"),
        recorded_at,
        report_id: None,
        content: entry.content.clone().into_bytes(),
        hash: entry.hash.to_vec(),
    };
    linked.push(entry);
    entries.push((stored, None));
}

fn sealed(key: &LedgerKey, number: u64) -> Option<StoredSeal> {
    let CheckpointSeal { number, signature, public_key } =
        CheckpointSeal::new(&factory(), number, key);
    let number = i64::try_from(number).expect("small");
    Some(StoredSeal { number, signature: signature.to_vec(), public_key: public_key.to_vec() })
}

fn verify(entries: &[Row], surroundings: Surroundings) -> Verification {
    let mut verifier = Verifier::new(surroundings);
    let mut previous = verifier.start_of(b"acme");
    for (entry, report) in entries {
        let digest = report.as_ref().map(StoredReport::digest);
        verifier.take(b"acme", [entry.check(b"acme", &previous, digest.as_ref())]);
        previous = entry.stored_hash();
    }
    verifier.finish()
}

fn signed(linked: &[LinkedEntry], key: &LedgerKey) -> Surroundings {
    let heads = SignedHead::of(&factory(), linked, key).into_iter().map(|head| StoredHead {
        recipient: head.recipient.to_string(),
        number: i64::try_from(head.number).expect("small"),
        hash: head.hash.to_vec(),
        signature: head.signature.to_vec(),
        public_key: head.public_key.to_vec(),
    });
    Surroundings {
        factory_id: "F".to_owned(),
        heads: heads.collect(),
        logs: vec![stored_log(linked, key)],
        seal: sealed(key, 0),
        ..Surroundings::default()
    }
}

fn log_of(linked: &[LinkedEntry]) -> Log {
    let mut log = Log::new(factory(), "acme".parse().expect("an id"), &Head::default());
    linked.iter().for_each(|entry| log.append(&entry.content));
    log
}

fn stored_log(linked: &[LinkedEntry], key: &LedgerKey) -> StoredLog {
    let mut log = log_of(linked);
    log.sign_checkpoint(key);
    StoredLog {
        recipient: "acme".to_owned(),
        start: log.start().canonical(),
        size: i64::try_from(log.leaves().end()).expect("small"),
        root: log.leaves().root().to_vec(),
        leaves: log.leaves().to_bytes(),
        checkpoint: log.checkpoint().expect("signed").to_owned(),
    }
}

#[test]
fn an_intact_ledger_is_intact() {
    let (entries, _, linked) = entries(20);
    let outcome = verify(&entries, signed(&linked, &key()));
    assert!(outcome.is_intact(), "{outcome:?}");
    assert_eq!((outcome.entries, outcome.values_compared), (20, 10));
}

#[test]
fn every_single_bit_of_an_entry_is_guarded() {
    let (intact, _, linked) = entries(3);
    let key = key();
    for bit in 0..intact[1].0.content.len() * 8 {
        let mut entries = intact.clone();
        entries[1].0.content[bit / 8] ^= 1 << (bit % 8);
        assert!(!verify(&entries, signed(&linked, &key)).is_intact(), "bit {bit}");
    }
    for bit in 0..256 {
        let mut entries = intact.clone();
        entries[1].0.hash[bit / 8] ^= 1 << (bit % 8);
        assert!(!verify(&entries, signed(&linked, &key)).is_intact(), "bit {bit} of the hash");
    }
    for bit in 0..REPORT.len() * 8 {
        let mut entries = intact.clone();
        if let Some(body) = entries[0].1.as_mut().and_then(|report| report.body.as_mut()) {
            body[bit / 8] ^= 1 << (bit % 8);
        }
        assert!(!verify(&entries, signed(&linked, &key)).is_intact(), "bit {bit} of the values");
    }
}

#[test]
fn deletion_and_reordering_are_found() {
    let (intact, _, linked) = entries(5);
    let key = key();
    for index in 0..intact.len() {
        let mut entries = intact.clone();
        entries.remove(index);
        assert!(!verify(&entries, signed(&linked, &key)).is_intact(), "without {index}");
        assert!(!verify(&intact[..index], signed(&linked, &key)).is_intact(), "cut at {index}");
    }
    let mut entries = intact;
    entries.swap(1, 2);
    assert!(!verify(&entries, signed(&linked, &key)).is_intact());
}

#[test]
fn a_rewritten_chain_contradicts_its_checkpoint() {
    let key = key();
    let (intact, heads, linked) = entries(4);
    let text =
        HeadsCheckpoint::new(factory(), 1, DateTime::from_unix_micros(9), &heads).canonical();
    let check = |entries: &[Row], linked: &[LinkedEntry], text: &str| {
        let statement = StoredStatement {
            name: "1".to_owned(),
            recorded_at: 9,
            content: text.as_bytes().to_vec(),
            signature: key
                .sign(
                    &HeadsCheckpoint::new(factory(), 1, DateTime::from_unix_micros(9), &heads)
                        .canonical(),
                )
                .to_vec(),
            public_key: key.public().to_vec(),
        };
        let (checkpoints, seal) = (vec![statement], sealed(&key, 1));
        verify(entries, Surroundings { checkpoints, seal, ..signed(linked, &key) }).is_intact()
    };
    assert!(check(&intact, &linked, &text));
    assert!(
        !check(&intact[..3], &linked[..3], &text),
        "a chain cut short and its end signed again"
    );
    assert!(!check(&intact, &linked, &text.replace("\"number\":4", "\"number\":3")));
}

#[test]
fn a_chain_continues_from_its_anchor() {
    let key = key();
    let anchor = |linked: &[LinkedEntry], number: usize| {
        let text = Anchor {
            factory_id: factory(),
            recipient: "acme".parse().expect("an id"),
            number: linked[number - 1].number,
            hash: hex::encode(linked[number - 1].hash),
            leaves: log_of(&linked[..number]).leaves().hashes().iter().map(hex::encode).collect(),
            last_entry_at: DateTime::from_unix_micros(3),
            recorded_at: DateTime::from_unix_micros(9),
        }
        .canonical();
        StoredStatement {
            name: "acme".to_owned(),
            recorded_at: 9,
            signature: key.sign(&text).to_vec(),
            public_key: key.public().to_vec(),
            content: text.into_bytes(),
        }
    };
    let pruned = |through: Option<u64>| {
        let (mut intact, mut heads, mut linked) = entries(6);
        let chain = (&mut intact, &mut heads, &mut linked);
        retained(chain, RetentionRule::EntryDays, Vec::new(), through);
        (intact, linked)
    };
    let check = |entries: &[Row], linked: &[LinkedEntry], anchors| {
        verify(entries, Surroundings { anchors, ..signed(linked, &key) })
    };
    let (intact, linked) = pruned(Some(3));
    let outcome = check(&intact[3..], &linked, vec![anchor(&linked, 3)]);
    assert!(outcome.is_intact(), "{outcome:?}");
    assert_eq!((outcome.entries, outcome.entries_pruned), (4, 3));
    let (all, of_all) = pruned(Some(6));
    let outcome = check(&all[6..], &of_all, vec![anchor(&of_all, 6)]);
    assert!(outcome.is_intact(), "everything was removed: {outcome:?}");
    let is_found = |entries: &[Row], linked: &[LinkedEntry], anchors, what: &str| {
        assert!(!check(entries, linked, anchors).is_intact(), "{what}");
    };
    let early = vec![anchor(&linked, 3)];
    is_found(&intact[4..], &linked, early, "more is missing than the anchor states");
    is_found(&intact[3..], &linked, Vec::new(), "the anchor is missing");
    let mut changed = anchor(&linked, 3);
    changed.content = String::from_utf8_lossy(&changed.content)
        .replace("\"number\":3", "\"number\":4")
        .into_bytes();
    is_found(&intact[4..], &linked, vec![changed], "the anchor was changed");
    let (unstated, linked) = pruned(None);
    is_found(&unstated[3..], &linked, vec![anchor(&linked, 3)], "no entry states the removal");
    is_found(&intact[5..], &linked, vec![anchor(&linked, 5)], "more was removed than is stated");
}

#[test]
fn a_log_that_is_not_the_one_of_its_chain_is_found() {
    let (intact, _, linked) = entries(9);
    let key = key();
    let check = |change: &dyn Fn(&mut StoredLog)| {
        let mut surroundings = signed(&linked, &key);
        change(&mut surroundings.logs[0]);
        verify(&intact, surroundings)
    };
    assert!(check(&|_| {}).is_intact());
    let old = stored_log(&linked[..4], &key).checkpoint;
    assert!(check(&|log| log.checkpoint.clone_from(&old)).is_intact(), "an older checkpoint");
    let other = stored_log(&linked[1..6], &key).checkpoint;
    let foreign = stored_log(&linked, &LedgerKey::from_secret(&[2; 32])).checkpoint;
    let changes: [&dyn Fn(&mut StoredLog); 12] = [
        &|log| log.checkpoint.clone_from(&other),
        &|log| log.checkpoint.clone_from(&foreign),
        &|log| log.checkpoint.clear(),
        &|log| log.checkpoint = log.checkpoint.replace("/to/acme", "/to/acmf"),
        &|log| log.checkpoint += &foreign[foreign.rfind('\u{2014}').expect("a line")..],
        &|log| log.size -= 1,
        &|log| log.root[0] ^= 1,
        &|log| log.leaves[40] ^= 1,
        &|log| log.start = log.start.replace("\"number\":0", "\"number\":1"),
        &|log| log.start.push(' '),
        &|log| log.recipient = "other".to_owned(),
        &|log| *log = stored_log(&linked[..8], &LedgerKey::from_secret(&[1; 32])),
    ];
    for (number, change) in changes.iter().enumerate() {
        assert!(!check(change).is_intact(), "change {number}");
    }
    let without = Surroundings { logs: Vec::new(), ..signed(&linked, &key) };
    assert!(!verify(&intact, without).is_intact(), "the log was deleted");
    let former = || Surroundings {
        logs: vec![StoredLog { recipient: "acme".to_owned(), ..StoredLog::default() }],
        ..signed(&linked, &key)
    };
    let unsealed = Surroundings { seal: None, ..former() };
    assert!(verify(&intact, unsealed).is_intact(), "a store of a former version has no log yet");
    assert!(!verify(&intact, former()).is_intact(), "the log was emptied");
}

#[test]
fn a_log_that_begins_after_pruned_entries_is_intact() {
    let key = key();
    let (mut intact, mut heads, mut linked) = entries(6);
    let chain = (&mut intact, &mut heads, &mut linked);
    retained(chain, RetentionRule::FormerVersion, Vec::new(), Some(3));
    let previous = Head { number: 3, hash: linked[2].hash };
    let mut log = Log::new(factory(), "acme".parse().expect("an id"), &previous);
    linked[3..].iter().for_each(|entry| log.append(&entry.content));
    log.sign_checkpoint(&key);
    assert_eq!(log.last_number(), 7);
    let text = Anchor {
        factory_id: factory(),
        recipient: "acme".parse().expect("an id"),
        number: 3,
        hash: hex::encode(previous.hash),
        leaves: Vec::new(),
        last_entry_at: DateTime::from_unix_micros(3),
        recorded_at: DateTime::from_unix_micros(9),
    }
    .canonical();
    assert!(!text.contains("leaves"), "anchors of before keep their text: {text}");
    let anchor = StoredStatement {
        name: "acme".to_owned(),
        recorded_at: 9,
        signature: key.sign(&text).to_vec(),
        public_key: key.public().to_vec(),
        content: text.into_bytes(),
    };
    let stored = StoredLog {
        start: log.start().canonical(),
        size: 5,
        root: log.leaves().root().to_vec(),
        leaves: log.leaves().to_bytes(),
        checkpoint: log.checkpoint().expect("signed").to_owned(),
        ..stored_log(&linked, &key)
    };
    let surroundings =
        Surroundings { anchors: vec![anchor], logs: vec![stored], ..signed(&linked, &key) };
    let outcome = verify(&intact[3..], surroundings);
    assert!(outcome.is_intact(), "{outcome:?}");
}
