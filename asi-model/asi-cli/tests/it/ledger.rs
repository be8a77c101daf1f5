//! `asi ledger verify`.

use std::{fmt::Write as _, path::Path};

use ::ledger::{
    Event, Head, Heads, LedgerKey, Log, SequenceRange,
    audit::{AuditEntry, AuditStart},
    log_verifier,
};
use asi_model::{DateTime, FactoryId, OrganisationId};
use serde_json::json;
use transparency_log::{KeyKind, NoteKey, SignedNote};

use crate::asi;

/// Writes an audit file of so many reports, a checkpoint over the first, and returns the key.
fn write_reports(folder: &Path, count: u32) -> String {
    let factory: FactoryId = "F".parse().unwrap();
    let acme: OrganisationId = "acme".parse().unwrap();
    let key = LedgerKey::from_secret(&[1; 32]);
    let mut log = Log::new(factory.clone(), acme.clone(), &Head::default());
    let mut heads = Heads::default();
    let mut lines = String::new();
    let leaf = transparency_log::leaf_hash(log.start().canonical().as_bytes());
    for sequence in 4..4 + count {
        let report = format!(
            r#"{{"DataSetWriterId":1,"Payload":{{"a":{{"Type":9,"Body":"{sequence}"}},"b":2}}}}"#
        );
        let range = SequenceRange {
            data_set_writer_id: 1,
            epoch: 1,
            first_sequence: sequence,
            last_sequence: sequence,
        };
        let queued = Event::Queued {
            range,
            values: hex::encode(::ledger::values_root(&report, &[7; 16]).unwrap()),
            consents: std::collections::BTreeMap::new(),
        };
        let at = DateTime::from_unix_micros(i64::from(sequence) * 1_000_000);
        let line = AuditEntry {
            entry: heads.append(&acme, at, queued).content,
            report: Some(serde_json::value::RawValue::from_string(report).unwrap()),
            salt: Some(hex::encode([7; 16])),
            sent_at: None,
            message_id: None,
            delivered_at: None,
        };
        log.append(&line.entry);
        writeln!(lines, "{}", serde_json::to_string(&line).unwrap()).unwrap();
        if sequence == 4 {
            log.sign_checkpoint(&key);
            std::fs::write(folder.join("checkpoint"), log.checkpoint().unwrap()).unwrap();
        }
    }
    log.sign_checkpoint(&key);
    let start = AuditStart {
        log_start: log.start().canonical(),
        number: 0,
        leaves: vec![hex::encode(leaf)],
        checkpoint: log.checkpoint().map(str::to_owned),
    };
    let start = serde_json::to_string(&start).unwrap();
    std::fs::write(folder.join("audit.jsonl"), format!("{start}\n{lines}")).unwrap();
    log_verifier(&factory, &acme, &key.public()).unwrap().to_string()
}

/// Writes an audit file of one report and its checkpoint, and returns the key.
fn write_files(folder: &Path) -> String {
    write_reports(folder, 1)
}

/// A script of another language that knows nothing but `docs/audit.md` agrees with the command, and
/// refuses what was changed.
#[test]
fn another_program_computes_an_audit_file_again() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_reports(folder.path(), 6);
    let [file, checkpoint] =
        ["audit.jsonl", "checkpoint"].map(|name| folder.path().join(name).display().to_string());
    let script =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/foreign/ledger/verify.py").to_owned();
    let verify = |key: &str| {
        let arguments = [&script, &file, &checkpoint, key];
        let output = std::process::Command::new("python3").args(arguments).output().unwrap();
        let own = ["ledger", "verify", &file, "--checkpoint", &checkpoint, "--key", key];
        let own = asi(&own, "").code == 0;
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.success(), own, "both agree: {said}");
        (own, said)
    };
    assert_eq!(verify(&key), (true, String::new()));
    let genuine = std::fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = genuine.lines().collect();
    let without = |place: usize| [&lines[..place], &lines[place + 1..]].concat().join("\n");
    let refused = [
        (genuine.replace(r#""Body":"9""#, r#""Body":"8""#), "the values of entry 6"),
        (genuine.replacen(r#""b":2"#, r#""b":3"#, 1), "the values of entry 1"),
        (genuine.replacen(r#""salt":"07"#, r#""salt":"08"#, 1), "the values of entry 1"),
        (genuine.replace("00:00:04Z", "00:00:05Z"), "the entries up to 1 are not those"),
        (genuine.replace("00:00:09Z", "00:00:08Z"), "the entries up to 6 are not those"),
        (without(6), "a checkpoint covers entries"),
        (without(3), "entry 3 stands in another's place"),
        (
            format!("{genuine}{}", lines[6].replace(r#"number\":6"#, r#"number\":7"#)),
            "no signature",
        ),
        (genuine.replacen("logStart", "logEnd", 1), "not proven"),
        (genuine.replacen(r"F/to/acme\n7", r"F/to/acme\n8", 1), "the signature is wrong"),
    ];
    for (changed, why) in refused {
        assert_ne!(changed, genuine, "{why}");
        std::fs::write(&file, changed).unwrap();
        let (is_intact, said) = verify(&key);
        assert!(!is_intact && said.contains(why), "{why}: {said}");
    }
    std::fs::write(&file, genuine).unwrap();
    let other = LedgerKey::from_secret(&[2; 32]).public();
    let other = log_verifier(&"F".parse().unwrap(), &"acme".parse().unwrap(), &other).unwrap();
    let (is_intact, said) = verify(&other.to_string());
    assert!(!is_intact && said.contains("not signed with this key"), "{said}");
}

#[test]
fn an_audit_file_is_checked_against_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_files(folder.path());
    let [file, checkpoint] =
        ["audit.jsonl", "checkpoint"].map(|name| folder.path().join(name).display().to_string());
    let verify = |key: &str| {
        asi(&["ledger", "verify", &file, "--checkpoint", &checkpoint, "--key", key], "")
    };
    let intact = verify(&key);
    assert_eq!(intact.code, 0, "{}{}", intact.out, intact.err);
    let audit: serde_json::Value = serde_json::from_str(&intact.out).unwrap();
    assert_eq!((&audit["entriesProven"], &audit["valuesCompared"]), (&json!(1), &json!(1)));
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("QUEUED", "SENT")).unwrap();
    let changed = verify(&key);
    assert_eq!(changed.code, 1, "{}", changed.out);
    assert!(changed.out.contains("not those of the checkpoint"), "{}", changed.out);
    std::fs::write(&file, text).unwrap();
    let other = LedgerKey::from_secret(&[2; 32]).public();
    let other = log_verifier(&"F".parse().unwrap(), &"acme".parse().unwrap(), &other).unwrap();
    let foreign = verify(&other.to_string());
    assert_eq!(foreign.code, 1);
    assert!(foreign.out.contains("not signed with this key"), "{}", foreign.out);
    assert_eq!(verify("rubbish").code, 2);
}

#[test]
fn a_witness_can_be_demanded() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_files(folder.path());
    let [file, checkpoint] =
        ["audit.jsonl", "checkpoint"].map(|name| folder.path().join(name).display().to_string());
    let verify = |witness: &NoteKey| {
        let witness = witness.verifier().to_string();
        let args =
            ["ledger", "verify", &file, "--checkpoint", &checkpoint, "--key", &key, "--witness"];
        asi(&[&args[..], &[&witness]].concat(), "")
    };
    let key_of = |secret: u8| {
        let secret = ed25519_dalek::SigningKey::from_bytes(&[secret; 32]);
        NoteKey::new("cloud/witness", KeyKind::CosignatureV1, secret).unwrap()
    };
    let witness = key_of(9);
    let missing = verify(&witness);
    assert_eq!(missing.code, 1);
    assert!(missing.out.contains("not countersigned by this witness"), "{}", missing.out);
    let mut note = SignedNote::parse(&std::fs::read_to_string(&checkpoint).unwrap()).unwrap();
    note.cosign(&witness, 1_700_000_000).unwrap();
    std::fs::write(&checkpoint, note.to_string()).unwrap();
    let intact = verify(&witness);
    assert_eq!(intact.code, 0, "{}{}", intact.out, intact.err);
    let audit: serde_json::Value = serde_json::from_str(&intact.out).unwrap();
    assert_eq!(audit["witnessedAt"], "2023-11-14T22:13:20Z");
    assert_eq!(verify(&key_of(8)).code, 1, "another witness");
}
