use asi_model::{DateTime, RequestKey};

use super::*;
use crate::{
    Access, AccessKind, AccessLog, AccessLogKey, AccessRetention, AccessRetentionRule, Agent,
    AgentKind, RemovedEntries, access_log_verifier,
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

/// Lines of a log with `count` accesses of which the first `removed` are gone, and its checkpoint. What
/// is gone is stated at the end.
fn file(count: u64, removed: u64) -> (Vec<String>, String) {
    let stated = (removed > 0).then(|| statement(AccessRetentionRule::Age, removed));
    file_with(count, removed, stated)
}

fn statement(rule: AccessRetentionRule, removed_through: u64) -> AccessRetention {
    let before = (rule == AccessRetentionRule::Age).then(|| DateTime::from_ticks(2));
    AccessRetention { rule, before, kept: None, removed_through }
}

fn file_with(
    count: u64,
    removed: u64,
    stated: impl IntoIterator<Item = AccessRetention>,
) -> (Vec<String>, String) {
    let start = AccessLogStart { factory_id: id("F"), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start);
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
    for retention in stated {
        let entry = log.append_retention(retention, DateTime::from_ticks(2)).canonical();
        lines.push(AccessAuditLine { entry }.line());
    }
    lines[0] = AccessAuditStart::of(&log, &gone, &key()).line();
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
        let statements = u64::from(removed > 0);
        assert_eq!(audit.entries_proven, count - removed + statements);
        assert_eq!((audit.entries_removed, audit.entries_after), (removed, 0));
        let stated = audit.retention.map_or(0, |entry| entry.retention.removed_through);
        assert_eq!(stated, removed);
    }
}

#[test]
fn later_entries_are_counted_apart() {
    let (lines, _) = file(7, 2);
    let (_, earlier) = file(5, 0);
    let audit = audit(&lines, &earlier).expect("it begins");
    assert!(audit.is_intact(), "{audit:?}");
    assert_eq!((audit.entries_proven, audit.entries_after), (3, 3));
}

/// Readers of yesterday are not hidden as if by retention.
#[test]
fn entries_removed_without_a_statement_are_found() {
    use AccessRetentionRule::{Age, Count, FormerVersion};
    let is_intact = |removed: u64, stated: &[AccessRetention]| {
        let (lines, checkpoint) = file_with(7, removed, stated.to_vec());
        audit(&lines, &checkpoint).expect("it begins").is_intact()
    };
    for rule in [Age, Count, FormerVersion] {
        assert!(is_intact(7, &[statement(rule, 7)]));
        assert!(is_intact(4, &[statement(rule, 2), statement(rule, 4)]));
        for other in [3, 5, 7, 8, 9] {
            assert!(!is_intact(4, &[statement(rule, other)]), "{other} are stated");
        }
        assert!(!is_intact(4, &[statement(rule, 4), statement(rule, 2)]), "an older one after it");
        assert!(!is_intact(0, &[statement(rule, 4)]), "nothing is missing");
    }
    for removed in [1, 4, 7] {
        assert!(!is_intact(removed, &[]), "{removed} of 7");
    }
    let later = AccessRetention { before: Some(DateTime::from_ticks(3)), ..statement(Age, 4) };
    assert!(!is_intact(4, &[later]), "it speaks of the future");
}

/// A statement of retention needs the key.
#[test]
fn statements_that_no_signature_covers_excuse_nothing() {
    let (lines, _) = file_with(7, 7, [statement(AccessRetentionRule::Age, 7)]);
    let (unstated, checkpoint) = file_with(7, 7, []);
    let mut forged = lines.clone();
    forged[0].clone_from(&unstated[0]);
    let found = audit(&forged, &checkpoint).expect("it begins");
    assert_eq!((found.fault_count, found.entries_unsigned), (2, 1), "{found:?}");
    let mut start: AccessAuditStart = serde_json::from_str(&lines[0]).expect("a start");
    start.checkpoint = None;
    forged[0] = start.line();
    let found = audit(&forged, &checkpoint).expect("it begins");
    assert_eq!((found.fault_count, found.entries_unsigned), (2, 1), "{found:?}");
    let thief = AccessLogKey::from_secret(&[2; 32]);
    let log_start: AccessLogStart = serde_json::from_str(&start.log_start).expect("a start");
    let resigned = AccessLog::new(log_start).sign_checkpoint(&thief);
    forged[0] = AccessAuditStart { checkpoint: Some(resigned), ..start }.line();
    assert_eq!(audit(&forged, &checkpoint), Err(AccessAuditError::FileCheckpoint));
    let intact = audit(&lines, &checkpoint).expect("it begins");
    assert!(intact.is_intact(), "signed later than the checkpoint was kept: {intact:?}");
}

#[test]
fn every_change_of_a_line_is_found() {
    let (lines, checkpoint) = file(5, 2);
    for at in 1..lines.len() - 1 {
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
