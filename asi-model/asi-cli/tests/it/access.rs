//! `asi access verify`.

use std::path::Path;

use access_log::{
    Access, AccessKind, AccessLog, AccessLogKey, AccessLogStart, AccessRetention,
    AccessRetentionRule, Agent, AgentKind, RemovedEntries, access_log_verifier,
    audit::{AccessAuditLine, AccessAuditStart},
};
use asi_model::{DateTime, RequestKey};

use crate::asi;

/// Writes an audit file with one entry and its checkpoint, and returns the key.
fn write_files(folder: &Path) -> String {
    let key = AccessLogKey::from_secret(&[1; 32]);
    let start = AccessLogStart { factory_id: "F".parse().unwrap(), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start);
    let at = DateTime::from_unix_micros(1_000_000);
    let access = Access {
        viewer: "acme".parse().unwrap(),
        agent: Agent { kind: AgentKind::User, id: "00ff".to_owned(), role: None },
        kind: AccessKind::Looked,
        request: RequestKey {
            operation_network_id: "net".parse().unwrap(),
            operation_id: "op".parse().unwrap(),
            dynamic_data_request_id: "req".parse().unwrap(),
        },
        fields: ["count".to_owned()].into(),
        values_from: None,
        values_to: None,
        value_count: 1,
        since: at,
    };
    let entry = log.append(access, at).canonical();
    let line = AccessAuditLine { entry }.line();
    let begin = AccessAuditStart::of(&log, &RemovedEntries::none(), &key).line();
    std::fs::write(folder.join("audit.jsonl"), format!("{begin}{line}")).unwrap();
    std::fs::write(folder.join("checkpoint"), log.sign_checkpoint(&key)).unwrap();
    access_log_verifier(&"F".parse().unwrap(), &key.public()).unwrap().to_string()
}

#[test]
fn an_access_log_is_checked_against_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_files(folder.path());
    let [file, checkpoint] =
        ["audit.jsonl", "checkpoint"].map(|name| folder.path().join(name).display().to_string());
    let verify = |key: &str| {
        asi(&["access", "verify", &file, "--checkpoint", &checkpoint, "--key", key], "")
    };
    let intact = verify(&key);
    assert_eq!(intact.code, 0, "{}{}", intact.out, intact.err);
    assert!(intact.out.contains("\"entriesProven\": 1"), "{}", intact.out);
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("LOOKED", "EXPORTED")).unwrap();
    let changed = verify(&key);
    assert_eq!(changed.code, 1, "{}", changed.out);
    assert!(changed.out.contains("not those of the checkpoint"), "{}", changed.out);
    std::fs::write(&file, text).unwrap();
    let other = AccessLogKey::from_secret(&[2; 32]).public();
    let other = access_log_verifier(&"F".parse().unwrap(), &other).unwrap();
    assert_eq!(verify(&other.to_string()).code, 1);
    assert_eq!(verify("rubbish").code, 2);
}

/// A removal is shown with its rule and its time; without a statement it is a fault.
#[test]
fn removed_accesses_are_shown_with_their_statement() {
    let folder = tempfile::tempdir().unwrap();
    let key = AccessLogKey::from_secret(&[1; 32]);
    let start = AccessLogStart { factory_id: "F".parse().unwrap(), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start);
    let mut removed = RemovedEntries::none();
    log.append_text("{}");
    removed.append_text("{}");
    let [file, checkpoint] =
        ["audit.jsonl", "checkpoint"].map(|name| folder.path().join(name).display().to_string());
    std::fs::write(&checkpoint, log.sign_checkpoint(&key)).unwrap();
    let begin = AccessAuditStart::of(&log, &removed, &key).line();
    std::fs::write(&file, begin).unwrap();
    let vkey = access_log_verifier(&"F".parse().unwrap(), &key.public()).unwrap().to_string();
    let verify =
        || asi(&["access", "verify", &file, "--checkpoint", &checkpoint, "--key", &vkey], "");
    let unstated = verify();
    assert_eq!(unstated.code, 1, "{}", unstated.out);
    assert!(unstated.out.contains("without a statement of retention"), "{}", unstated.out);
    let at = DateTime::from_unix_micros(1_000_000);
    let stated = AccessRetention {
        rule: AccessRetentionRule::Age,
        before: Some(at),
        kept: None,
        removed_through: 1,
    };
    let entry = log.append_retention(stated, at).canonical();
    let begin = AccessAuditStart::of(&log, &removed, &key).line();
    std::fs::write(&file, format!("{begin}{}", AccessAuditLine { entry }.line())).unwrap();
    let shown = verify();
    assert_eq!(shown.code, 0, "{}", shown.out);
    let audit: serde_json::Value = serde_json::from_str(&shown.out).unwrap();
    assert_eq!(audit["retention"]["retention"]["rule"], "AGE");
    assert_eq!(audit["retention"]["recordedAt"], "1970-01-01T00:00:01Z");
    assert_eq!((&audit["entriesRemoved"], &audit["entriesAfter"]), (&1.into(), &1.into()));
}
