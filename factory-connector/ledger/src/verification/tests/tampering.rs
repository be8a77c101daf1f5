//! Tampering with a store, each kind that a review had found unnoticed first.

use super::*;

/// A chain whose reports are sent and receipted, and two of them emptied with a statement.
struct Sample {
    entries: Vec<Row>,
    linked: Vec<LinkedEntry>,
}

impl Sample {
    fn new(stated: Option<Vec<SequenceRange>>) -> Self {
        let (mut entries, mut heads, mut linked) = entries(8);
        for index in [0, 2] {
            let report = entries[index].1.as_mut().expect("a report");
            (report.body, report.salt) = (None, None);
        }
        if let Some(stated) = stated {
            let chain = (&mut entries, &mut heads, &mut linked);
            retained(chain, RetentionRule::ValueDays, stated, None);
        }
        Self { entries, linked }
    }

    fn verify(&self) -> Verification {
        verify(&self.entries, signed(&self.linked, &key()))
    }

    fn verify_against(&self, checkpoints: &[&str]) -> Verification {
        let kept_checkpoints = checkpoints.iter().map(|note| (*note).to_owned()).collect();
        verify(&self.entries, Surroundings { kept_checkpoints, ..signed(&self.linked, &key()) })
    }
}

const fn range(first_sequence: u32, last_sequence: u32) -> SequenceRange {
    SequenceRange { data_set_writer_id: 1, epoch: 1, first_sequence, last_sequence }
}

fn messages(outcome: &Verification) -> Vec<&str> {
    outcome.fault_list.iter().map(|fault| fault.message.as_str()).collect()
}

#[test]
fn values_emptied_without_a_statement_are_found() {
    let stated = Sample::new(Some(vec![range(0, 1)])).verify();
    assert!(stated.is_intact() && stated.values_emptied == 2, "{stated:?}");
    let expected = ["the values were emptied without a statement of retention"; 2];
    assert_eq!(messages(&Sample::new(None).verify()), expected);
    let in_part = Sample::new(Some(vec![range(1, 1)])).verify();
    assert_eq!(messages(&in_part), expected[..1]);
    let mut other = range(0, 1);
    other.epoch = 2;
    assert_eq!(messages(&Sample::new(Some(vec![other])).verify()), expected);
}

#[test]
fn values_that_are_too_young_for_the_statement_are_found() {
    let (mut entries, mut heads, mut linked) = entries(8);
    let report = entries[6].1.as_mut().expect("a report");
    (report.body, report.salt) = (None, None);
    let statement = RetentionStatement {
        rule: RetentionRule::ValueDays,
        days: Some(1),
        before: DateTime::from_unix_micros(6),
        emptied: vec![range(0, 9)],
        removed_through: None,
    };
    let at = DateTime::from_unix_micros(8);
    let recipient = "acme".parse().expect("an id");
    let entry = heads.append(&recipient, at, Event::Retention(statement));
    let stored = StoredEntry {
        number: 9,
        recorded_at: 8,
        report_id: None,
        content: entry.content.clone().into_bytes(),
        hash: entry.hash.to_vec(),
    };
    linked.push(entry);
    entries.push((stored, None));
    let outcome = Sample { entries, linked }.verify();
    assert_eq!(messages(&outcome), ["the values were emptied without a statement of retention"]);
}

#[test]
fn a_former_version_is_stated_once() {
    let (mut entries, mut heads, mut linked) = entries(4);
    let mut state = |entries: &mut Vec<Row>| {
        let chain = (entries, &mut heads, &mut linked);
        retained(chain, RetentionRule::FormerVersion, vec![range(0, 0)], None);
    };
    state(&mut entries);
    let report = entries[0].1.as_mut().expect("a report");
    (report.body, report.salt) = (None, None);
    let mut sample = Sample { entries, linked: Vec::new() };
    let mut again = sample.entries.clone();
    state(&mut again);
    sample.linked = linked[..5].to_vec();
    assert!(sample.verify().is_intact(), "{:?}", sample.verify());
    let outcome = Sample { entries: again, linked }.verify();
    assert_eq!(messages(&outcome), ["what a former version emptied is stated twice"]);
}

/// A former version signed no logs and no seal, and its store is compared with less. What it could
/// not have written shows that a store was only made to look like one.
#[test]
fn a_store_that_was_made_to_look_like_one_of_a_former_version_is_found() {
    let sample = Sample::new(Some(vec![range(1, 1)]));
    let logs = vec![StoredLog { recipient: "acme".to_owned(), ..StoredLog::default() }];
    let stripped = Surroundings { logs, seal: None, ..signed(&sample.linked, &key()) };
    let found = verify(&sample.entries, stripped);
    let emptied = "the values were emptied without a statement of retention";
    assert_eq!(messages(&found), ["what is signed beside the entries was deleted", emptied]);
}

/// A statement at the end of the store excuses nothing that the key of the ledger has not signed.
#[test]
fn a_statement_that_was_appended_without_the_key_is_found() {
    let unstated = Sample::new(None);
    let stated = Sample::new(Some(vec![range(0, 1)]));
    assert!(stated.verify().is_intact());
    let outcome = verify(&stated.entries, signed(&unstated.linked, &key()));
    let end = "the chain's end is not the one that was signed";
    assert!(messages(&outcome).contains(&end), "{outcome:?}");
    let thief = LedgerKey::from_secret(&[2; 32]);
    let trusted_key = Some(key().public());
    let surroundings = Surroundings { trusted_key, ..signed(&stated.linked, &thief) };
    assert!(!verify(&stated.entries, surroundings).is_intact(), "signed by another key");
}

#[test]
fn delivery_columns_that_differ_from_the_entries_are_found() {
    type Change = fn(&mut StoredReport);
    let changes: [(&str, Change); 5] = [
        ("sent later", |report| report.sent_at = Some(77)),
        ("never sent", |report| report.sent_at = None),
        ("receipted without an entry", |report| report.receipted_at = Some(9)),
        ("in a message", |report| report.message_id = Some(b"m".to_vec())),
        ("sent before", |report| report.sent_at = report.sent_at.map(|at| at - 1)),
    ];
    let intact = Sample::new(Some(vec![range(0, 1)]));
    for (what, change) in changes {
        for index in [0, 4] {
            let mut sample =
                Sample { entries: intact.entries.clone(), linked: intact.linked.clone() };
            change(sample.entries[index].1.as_mut().expect("a report"));
            let outcome = sample.verify();
            let expected = "time or message of the delivery is not the one that was entered";
            assert!(messages(&outcome).contains(&expected), "{what} of {index}: {outcome:?}");
        }
    }
}

#[test]
fn a_recipient_added_to_or_taken_from_a_report_is_found() {
    let intact = Sample::new(Some(vec![range(0, 1)]));
    for recipients in
        [r#"["acme","hull"]"#, r#"["hull"]"#, r#"["acme","acme"]"#, r#"["hull","acme"]"#, "[]", ""]
    {
        let mut sample = Sample { entries: intact.entries.clone(), linked: intact.linked.clone() };
        sample.entries[4].1.as_mut().expect("a report").recipients = recipients.into();
        assert!(!sample.verify().is_intact(), "{recipients}");
    }
}

#[test]
fn the_newest_checkpoint_cannot_be_deleted() {
    let (entries, heads, linked) = entries(4);
    let key = key();
    let statements = |count: u64| -> Vec<StoredStatement> {
        let of = |number: u64| {
            let at = DateTime::from_unix_micros(9);
            let content = HeadsCheckpoint::new(factory(), number, at, &heads).canonical();
            StoredStatement {
                name: number.to_string(),
                recorded_at: 9,
                signature: key.sign(&content).to_vec(),
                public_key: key.public().to_vec(),
                content: content.into_bytes(),
            }
        };
        (1..=count).map(of).collect()
    };
    let check = |count: u64, seal| {
        let checkpoints = statements(count);
        verify(&entries, Surroundings { checkpoints, seal, ..signed(&linked, &key) }).is_intact()
    };
    assert!(check(3, sealed(&key, 3)));
    assert!(!check(2, sealed(&key, 3)), "the newest was deleted");
    assert!(!check(0, sealed(&key, 3)), "all were deleted");
    assert!(!check(2, None), "the seal was deleted with it");
    assert!(!check(2, sealed(&LedgerKey::from_secret(&[2; 32]), 2)), "sealed by another key");
    let changed = sealed(&key, 3).map(|seal| StoredSeal { number: 2, ..seal });
    assert!(!check(2, changed), "the seal was changed");
}

#[test]
fn a_store_that_was_set_back_or_signed_again_contradicts_a_checkpoint_kept_elsewhere() {
    let whole = Sample::new(Some(vec![range(0, 1)]));
    let note = |linked: &[LinkedEntry]| stored_log(linked, &key()).checkpoint;
    let kept = note(&whole.linked);
    let middle = note(&whole.linked[..4]);
    let outcome = whole.verify_against(&[&kept, &middle]);
    assert!(outcome.is_intact(), "{outcome:?}");
    // An older copy of the whole file, or a tail cut with an older head: consistent in itself.
    let (entries, linked) = (whole.entries[..2].to_vec(), whole.linked[..2].to_vec());
    let older = Sample { entries, linked };
    assert!(!older.verify_against(&[&kept]).is_intact());
    let mut cut = older.entries.clone();
    cut[0].1.as_mut().expect("a report").body = Some(REPORT.as_bytes().to_vec());
    cut[0].1.as_mut().expect("a report").salt = Some(SALT.to_vec());
    let older = Sample { entries: cut, linked: older.linked };
    assert!(older.verify().is_intact(), "what the store alone cannot show");
    assert_eq!(
        messages(&older.verify_against(&[&kept])),
        ["entries are missing that a checkpoint kept elsewhere covers"]
    );
    // Another history, signed again with the stolen key of the same folder.
    let (entries, _, linked) = super::entries(9);
    let forged = Sample { entries, linked };
    assert!(forged.verify().is_intact(), "what the store alone cannot show");
    assert_eq!(
        messages(&forged.verify_against(&[&kept])),
        ["a checkpoint that was kept elsewhere states another root over these entries"]
    );
    // A whole chain with its head and its log deleted.
    let surroundings = Surroundings {
        factory_id: "F".to_owned(),
        trusted_key: Some(key().public()),
        seal: sealed(&key(), 0),
        kept_checkpoints: vec![kept.clone()],
        ..Surroundings::default()
    };
    assert_eq!(
        messages(&verify(&[], surroundings)),
        ["a checkpoint that was kept elsewhere is about a log that is missing"]
    );
    for note in
        ["rubbish", &stored_log(&whole.linked, &LedgerKey::from_secret(&[2; 32])).checkpoint]
    {
        assert!(!whole.verify_against(&[note]).is_intact(), "no checkpoint of this key");
    }
}

#[test]
fn a_chain_deleted_with_its_head_is_missed_beside_the_reports_of_others() {
    let (mut entries, _, linked) = entries(4);
    for (_, report) in &mut entries {
        if let Some(report) = report {
            report.recipients = br#"["acme","hull"]"#.to_vec();
        }
    }
    for (index, (entry, _)) in entries.iter_mut().enumerate() {
        entry.report_id = entry.report_id.map(|_| i64::try_from(index).expect("small"));
    }
    // The chain of hull, its head and its log are gone.
    let outcome = verify(&entries, signed(&linked, &key()));
    assert_eq!(
        messages(&outcome),
        ["an organisation stands beside a report of which its chain has no entry"]
    );
}
