//! `asi ledger verify`.

use std::path::Path;

use ::ledger::{Event, Head, Heads, LedgerKey, Log, SequenceRange, log_verifier};
use asi_model::{DateTime, FactoryId, OrganisationId};
use serde_json::json;
use transparency_log::{KeyKind, NoteKey, SignedNote};

use crate::asi;

/// Writes an audit file and its checkpoint, and returns the key.
fn write_files(folder: &Path) -> String {
    let factory: FactoryId = "F".parse().unwrap();
    let acme: OrganisationId = "acme".parse().unwrap();
    let key = LedgerKey::from_secret(&[1; 32]);
    let mut log = Log::new(factory.clone(), acme.clone(), &Head::default());
    let range =
        SequenceRange { data_set_writer_id: 1, epoch: 1, first_sequence: 4, last_sequence: 4 };
    let queued = Event::Queued {
        range,
        values: hex::encode(::ledger::values_root("{}", &[7; 16]).unwrap()),
        consents: std::collections::BTreeMap::new(),
    };
    let at = DateTime::from_unix_micros(1_000_000);
    let entry = Heads::default().append(&acme, at, queued);
    log.append(&entry.content);
    log.sign_checkpoint(&key);
    let start = json!({ "logStart": log.start().canonical(), "number": 0,
                        "leaves": [hex::encode(transparency_log::leaf_hash(
                            log.start().canonical().as_bytes()))] });
    let line = json!({ "entry": entry.content, "report": {}, "salt": hex::encode([7; 16]),
                       "sentAt": null, "messageId": null, "deliveredAt": null });
    std::fs::write(folder.join("audit.jsonl"), format!("{start}\n{line}\n")).unwrap();
    std::fs::write(folder.join("checkpoint"), log.checkpoint().unwrap()).unwrap();
    log_verifier(&factory, &acme, &key.public()).unwrap().to_string()
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
