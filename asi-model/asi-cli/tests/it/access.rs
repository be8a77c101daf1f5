//! `asi access verify`.

use std::path::Path;

use access_log::{
    Access, AccessKind, AccessLog, AccessLogKey, AccessLogStart, Agent, AgentKind, RemovedEntries,
    access_log_verifier,
    audit::{AccessAuditLine, AccessAuditStart},
};
use asi_model::{DateTime, RequestKey};

use crate::asi;

/// Writes an audit file with one entry and its checkpoint, and returns the key.
fn write_files(folder: &Path) -> String {
    let key = AccessLogKey::from_secret(&[1; 32]);
    let start = AccessLogStart { factory_id: "F".parse().unwrap(), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start);
    let begin = AccessAuditStart::after(log.start(), &RemovedEntries::none()).line();
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
