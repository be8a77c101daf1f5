use asi_model::{DateTime, RequestKey};

use super::*;
use crate::{
    Access, AccessKind, AccessLog, AccessLogKey, Agent, AgentKind, RemovedEntries,
    access_log_verifier,
};

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

fn access(value_count: u64) -> Access {
    Access {
        viewer: id("acme"),
        agent: Agent { kind: AgentKind::User, id: "00ff".to_owned(), role: None },
        kind: AccessKind::Looked,
        request: RequestKey {
            operation_network_id: id("net"),
            operation_id: id("op"),
            dynamic_data_request_id: id("req"),
        },
        fields: ["count".to_owned()].into(),
        values_from: None,
        values_to: None,
        value_count,
        since: DateTime::from_ticks(1),
    }
}

fn key() -> AccessLogKey {
    AccessLogKey::from_secret(&[1; 32])
}

fn vkey(factory: &str, key: &AccessLogKey) -> VerifierKey {
    access_log_verifier(&id(factory), &key.public()).expect("a key")
}

/// Lines of a log with `count` entries of which the first `removed` are gone, and its checkpoint.
fn file(count: u64, removed: u64) -> (Vec<String>, String) {
    let start = AccessLogStart { factory_id: id("F"), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start.clone());
    let mut gone = RemovedEntries::none();
    let mut lines = vec![String::new()];
    for number in 1..=count {
        let entry = log.append(access(number), DateTime::from_ticks(2)).canonical();
        if number <= removed {
            gone.append_text(&entry);
        } else {
            lines.push(AccessAuditLine { entry }.line());
        }
    }
    lines[0] = AccessAuditStart::after(&start, &gone).line();
    (lines, log.sign_checkpoint(&key()))
}

fn audit(lines: &[String], checkpoint: &str) -> Result<AccessAudit, AccessAuditError> {
    let mut auditor = AccessAuditor::new(checkpoint, &vkey("F", &key()), &lines[0])?;
    for line in &lines[1..] {
        auditor.take(line);
    }
    Ok(auditor.finish())
}

#[test]
fn a_true_log_is_proven() {
    for (count, removed) in [(0, 0), (1, 0), (7, 0), (7, 1), (7, 4), (7, 7)] {
        let (lines, checkpoint) = file(count, removed);
        let audit = audit(&lines, &checkpoint).expect("it begins");
        assert!(audit.is_intact(), "{audit:?}");
        assert_eq!((audit.entries_proven, audit.entries_removed), (count - removed, removed));
    }
}

#[test]
fn later_entries_are_counted_apart() {
    let (lines, _) = file(7, 2);
    let (_, earlier) = file(5, 0);
    let audit = audit(&lines, &earlier).expect("it begins");
    assert!(audit.is_intact(), "{audit:?}");
    assert_eq!((audit.entries_proven, audit.entries_after), (3, 2));
}

#[test]
fn every_change_of_a_line_is_found() {
    let (lines, checkpoint) = file(5, 2);
    for at in 1..lines.len() {
        for (from, to) in [
            ("acme", "ecma"),
            ("00ff", "00fe"),
            ("LOOKED", "EXPORTED"),
            ("count", "other"),
            ("\\\"number\\\":", "\\\"number\\\":1"),
        ] {
            let mut changed = lines.clone();
            changed[at] = changed[at].replacen(from, to, 1);
            assert_ne!(changed, lines, "{from}");
            assert!(audit(&changed, &checkpoint).is_ok_and(|a| !a.is_intact()), "{at} {from}");
        }
        let mut removed = lines.clone();
        removed.remove(at);
        assert!(audit(&removed, &checkpoint).is_ok_and(|a| !a.is_intact()), "{at} removed");
        let mut doubled = lines.clone();
        doubled.insert(at, lines[at].clone());
        assert!(audit(&doubled, &checkpoint).is_ok_and(|a| !a.is_intact()), "{at} doubled");
    }
    let mut swapped = lines.clone();
    swapped.swap(1, 2);
    assert!(audit(&swapped, &checkpoint).is_ok_and(|a| !a.is_intact()));
}

#[test]
fn a_changed_beginning_is_found() {
    let (lines, checkpoint) = file(5, 2);
    let fails = |first: String| {
        let mut changed = lines.clone();
        changed[0] = first;
        audit(&changed, &checkpoint).map_or(true, |audit| !audit.is_intact())
    };
    let other = AccessAuditStart { number: 3, ..serde_json::from_str(&lines[0]).expect("a start") };
    assert!(fails(other.line()));
    assert!(fails(lines[0].replace("0a", "0b")), "another log of the factory");
    assert!(fails("{}".to_owned()));
    let (whole, _) = file(5, 0);
    let hidden: Vec<String> = [&whole[..1], &whole[3..]].concat();
    assert!(audit(&hidden, &checkpoint).is_ok_and(|audit| !audit.is_intact()));
}

#[test]
fn others_keys_and_logs_are_refused() {
    let (lines, checkpoint) = file(2, 0);
    let other = vkey("F", &AccessLogKey::from_secret(&[2; 32]));
    assert!(matches!(
        AccessAuditor::new(&checkpoint, &other, &lines[0]),
        Err(AccessAuditError::Signature(_))
    ));
    let start = AccessLogStart { factory_id: id("G"), log_id: "0a".to_owned() };
    let foreign = AccessLog::new(start).sign_checkpoint(&key());
    assert!(matches!(
        AccessAuditor::new(&foreign, &vkey("G", &key()), &lines[0]),
        Err(AccessAuditError::OtherLog { .. })
    ));
}

#[test]
fn a_key_survives_its_text() {
    let again = AccessLogKey::from_pem(&key().to_pem().expect("a text")).expect("the same key");
    assert_eq!(again.public(), key().public());
    assert!(AccessLogKey::from_pem("rubbish").is_err());
    assert_eq!(format!("{:?}", key()), "AccessLogKey");
}
