//! Tampering of every kind with an audit file, its checkpoint and its key.

use ::tampering::{AuditFile, Kinds};

use super::*;

/// Returns the files to tamper with: one whose end is proven by the checkpoint in the file only, and
/// one that the kept checkpoint proves as far as its last entry but one.
fn files() -> [AuditFile; 2] {
    let (sample, foreign) = (Sample::new(7), Sample::new(8).lines);
    let of = |checkpoint: String| AuditFile {
        lines: sample.lines.clone(),
        checkpoint,
        foreign: foreign.clone(),
    };
    [of(sample.early.clone()), of(sample.kept.clone())]
}

/// Checkpoints and keys of others.
fn keys(sample: &Sample, kinds: &mut Kinds<'_>) {
    let genuine = sample.checkpoint();
    let mut attempt = |name: &str, lines: &[String], checkpoint: &str, by: &VerifierKey| {
        kinds.note(name, faults(lines, checkpoint, by));
    };
    let (own, thief) = (vkey(&key()), LedgerKey::from_secret(&[2; 32]));
    let resigned = Sample::signed_by(8, &thief);
    let checkpoint = resigned.checkpoint();
    attempt("everything signed by another key", &resigned.lines, &checkpoint, &own);
    attempt("the file signed by another key", &resigned.lines, &genuine, &own);
    attempt("the checkpoint under another key", &sample.lines, &genuine, &vkey(&thief));
    let fork = Sample::new(8);
    attempt("a fork under the own key", &fork.lines, &genuine, &own);
    attempt("a fork under the own key from an early entry on", &fork.lines, &sample.early, &own);
    let mut longer = Sample::new(7);
    longer.log.append("{}");
    longer.log.sign_checkpoint(&key());
    attempt("an older copy of the file", &sample.lines, &longer.checkpoint(), &own);
    let mut other = Log::new(factory(), "other".parse().expect("an id"), &Head::default());
    other.sign_checkpoint(&key());
    let other_key =
        log_verifier(&factory(), &"other".parse().expect("an id"), &key().public()).expect("a key");
    let of_other = other.checkpoint().expect("signed");
    attempt("the log of another recipient", &sample.lines, of_other, &other_key);
    attempt("another's checkpoint under the own key", &sample.lines, of_other, &own);
    let mut start: AuditStart = serde_json::from_str(&sample.lines[0]).expect("a start");
    start.checkpoint = Some(of_other.to_owned());
    let mut lines = sample.lines.clone();
    lines[0] = serde_json::to_string(&start).expect("JSON");
    attempt("another's checkpoint in the file", &lines, &genuine, &own);
    let cosigner = VerifierKey::new("F/to/acme", KeyKind::CosignatureV1, &key().public());
    attempt("the key of another kind", &sample.lines, &genuine, &cosigner.expect("a key"));
}

#[test]
fn every_kind_of_tampering_is_found() {
    let own = vkey(&key());
    let audit = |lines: &[String], checkpoint: &str| faults(lines, checkpoint, &own);
    for file in files() {
        assert_eq!(audit(&file.lines, &file.checkpoint), 0, "the file itself is intact");
        let mut kinds = ::tampering::try_all(&file, &audit);
        keys(&Sample::new(7), &mut kinds);
        kinds.assert_all_found(500);
    }
}

/// An entry is appended without a key. What it says counts only below a signature.
#[test]
fn entries_that_no_signature_covers_excuse_nothing() {
    let sample = Sample::new(7);
    let mut lines = sample.lines.clone();
    let mut emptied: Value = serde_json::from_str(&lines[2]).expect("JSON");
    emptied["report"] = Value::Null;
    emptied["salt"] = Value::Null;
    lines[2] = emptied.to_string();
    let statement = RetentionStatement {
        rule: RetentionRule::ValueDays,
        days: Some(30),
        before: DateTime::from_unix_micros(30_000_000),
        emptied: vec![range(0, 0)],
        removed_through: None,
    };
    let number = lines.len() as u64 - 1;
    let mut heads = Heads::new([(acme(), Head { number, hash: [0; 32] })]);
    let at = DateTime::from_unix_micros(30_000_000);
    let entry = heads.append(&acme(), at, Event::Retention(statement));
    lines.push(bare_line(&entry.content));
    let mut auditor =
        Auditor::new(&sample.kept, &vkey(&key()), &lines[0], None).expect("it begins");
    lines[1..].iter().for_each(|line| auditor.take(line));
    let outcome = auditor.finish();
    assert_eq!(outcome.entries_unsigned, 1);
    let faults: Vec<_> = outcome.fault_list.iter().map(|fault| fault.message.as_str()).collect();
    let emptied = "the values were emptied without a statement of retention";
    assert_eq!(faults, ["no signature covers the entry", emptied]);
}
