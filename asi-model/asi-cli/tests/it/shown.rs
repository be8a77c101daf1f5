//! Reports that the platform showed, and accesses, compared with what left.

use std::{collections::BTreeMap, fmt::Write as _, path::Path};

use ::ledger::{
    Event, Head, Heads, LedgerKey, Log, SequenceRange,
    audit::{AuditEntry, AuditStart},
    log_verifier,
};
use access_log::{
    Access, AccessKind, AccessLog, AccessLogKey, AccessLogStart, Agent, AgentKind, RemovedEntries,
    access_log_verifier,
    audit::{AccessAuditLine, AccessAuditStart},
};
use asi_model::{DateTime, FactoryId, OrganisationId, RequestKey};
use serde_json::{Value, json};

use crate::{Run, asi};

const FIRST: u32 = 4;
const LAST: u32 = 9;

fn at(seconds: u32) -> DateTime {
    DateTime::from_unix_micros(i64::from(seconds) * 1_000_000)
}

/// Writes the audit file of a recipient with a report for each second, its checkpoint, and its key.
fn write_ledger(folder: &Path) -> String {
    let factory: FactoryId = "F".parse().unwrap();
    let acme: OrganisationId = "acme".parse().unwrap();
    let key = LedgerKey::from_secret(&[1; 32]);
    let mut log = Log::new(factory.clone(), acme.clone(), &Head::default());
    let mut heads = Heads::default();
    let mut lines = String::new();
    let leaf = transparency_log::leaf_hash(log.start().canonical().as_bytes());
    for sequence in FIRST..=LAST {
        let text = |text: &str| json!({ "Type": 12, "Body": text });
        let mut report = json!({
            "DataSetWriterId": 1, "SequenceNumber": sequence, "Timestamp": at(sequence),
            "Payload": {
                "reportName": text("P"), "dynamicDataRequestId": text("req"), "operationId": text("op"),
                "operationNetworkId": text("net"),
                "shopfloorTimestamp": { "Type": 13, "Body": at(sequence) },
                "recipientList": { "Type": 12, "Body": ["acme"] },
                "count": { "Type": 9, "Body": sequence.to_string() },
            },
        });
        if sequence == FIRST {
            report["Payload"]["begin"] = json!({ "Type": 9, "Body": "1" });
        }
        let report = report.to_string();
        let range = SequenceRange {
            data_set_writer_id: 1,
            epoch: 1,
            first_sequence: sequence,
            last_sequence: sequence,
        };
        let queued = Event::Queued {
            range,
            values: hex::encode(::ledger::values_root(&report, &[7; 16]).unwrap()),
            consents: BTreeMap::from([("count".parse().unwrap(), 1)]),
        };
        let line = AuditEntry {
            entry: heads.append(&acme, at(sequence), queued).content,
            report: Some(serde_json::value::RawValue::from_string(report).unwrap()),
            salt: Some(hex::encode([7; 16])),
            sent_at: None,
            message_id: None,
            delivered_at: None,
        };
        log.append(&line.entry);
        writeln!(lines, "{}", serde_json::to_string(&line).unwrap()).unwrap();
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
    std::fs::write(folder.join("checkpoint"), log.checkpoint().unwrap()).unwrap();
    log_verifier(&factory, &acme, &key.public()).unwrap().to_string()
}

/// A report as a page of the history shows it.
fn shown(sequence: u32) -> Value {
    let field = |value: String| json!({ "value": value, "status": "Good", "sourceTimestamp": at(sequence) });
    let mut fields = json!({ "count": field(sequence.to_string()) });
    if sequence == FIRST {
        fields["begin"] = field("1".to_owned());
    }
    json!({
        "factoryId": "F", "dataSetWriterId": 1, "epoch": 1, "sequence": sequence,
        "operationNetworkId": "net", "operationId": "op", "dynamicDataRequestId": "req",
        "reportName": "P", "shopfloorTimestamp": at(sequence), "reportTimestamp": at(sequence),
        "receivedAt": at(sequence + 1),
        "fields": fields,
    })
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// Compares a page of these reports with the ledger.
fn compare(folder: &Path, key: &str, reports: &[Value]) -> (Run, Value) {
    std::fs::write(folder.join("shown"), json!({ "items": reports }).to_string()).unwrap();
    let [audit, checkpoint, export] =
        ["audit.jsonl", "checkpoint", "shown"].map(|name| path(folder, name));
    let arguments = ["ledger", "verify", &audit, "--checkpoint", &checkpoint, "--key", key];
    let run = asi(&[&arguments[..], &["--shown", &export]].concat(), "");
    let outcome = serde_json::from_str(&run.out).unwrap_or_default();
    (run, outcome)
}

#[test]
fn a_report_that_never_left_for_its_reader_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_ledger(folder.path());
    let honest: Vec<Value> = (FIRST..=LAST).map(shown).collect();
    let (run, outcome) = compare(folder.path(), &key, &honest);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert_eq!(outcome["shown"]["reportsCompared"], json!(6), "{outcome:#}");

    // What is not shown is said, and widens nothing.
    let mut fewer = honest.clone();
    fewer.remove(2);
    let (run, outcome) = compare(folder.path(), &key, &fewer);
    assert_eq!((run.code, &outcome["shown"]["missingCount"]), (0, &json!(1)), "{outcome:#}");

    let widened: Vec<(&str, Value)> = vec![
        ("/sequence", json!(LAST + 1)),
        ("/sequence", json!(FIRST - 1)),
        ("/epoch", json!(2)),
        ("/dataSetWriterId", json!(2)),
    ];
    for (pointer, value) in widened {
        let mut other = shown(LAST);
        *other.pointer_mut(pointer).unwrap() = value;
        let (run, outcome) = compare(folder.path(), &key, &[&honest[..], &[other]].concat());
        assert_eq!(run.code, 1, "{pointer}: {outcome:#}");
        let message = &outcome["shown"]["faultList"][0]["message"];
        assert_eq!(message, "shown, but never left for you", "{pointer}");
    }
    let changed: Vec<(&str, Value)> = vec![
        ("/fields/count/value", json!("8")),
        ("/fields/count/status", json!("Uncertain")),
        ("/fields/count/sourceTimestamp", json!(at(LAST + 1))),
        ("/fields", json!({})),
        ("/reportTimestamp", json!(at(1))),
        ("/shopfloorTimestamp", json!(at(1))),
        ("/dynamicDataRequestId", json!("other")),
        ("/reportName", json!("Q")),
    ];
    for (pointer, value) in changed {
        let mut reports = honest.clone();
        *reports[5].pointer_mut(pointer).unwrap() = value;
        let (run, outcome) = compare(folder.path(), &key, &reports);
        assert_eq!((run.code, &outcome["shown"]["faultCount"]), (1, &json!(1)), "{pointer}");
    }
    let mut more = honest.clone();
    more[0]["fields"]["scrap"] = more[0]["fields"]["count"].clone();
    assert_eq!(compare(folder.path(), &key, &more).0.code, 1, "a field that did not leave");
    let mut of_other_factory = shown(LAST + 1);
    of_other_factory["factoryId"] = json!("G");
    let (run, outcome) = compare(folder.path(), &key, &[of_other_factory]);
    assert_eq!((run.code, &outcome["shown"]["reportsOfOtherFactories"]), (0, &json!(1)));
}

/// Writes the access log of the factory with one access, and compares it with the ledger.
fn compare_access(folder: &Path, ledger_key: &str, change: impl FnOnce(&mut Access)) -> Run {
    let key = AccessLogKey::from_secret(&[1; 32]);
    let start = AccessLogStart { factory_id: "F".parse().unwrap(), log_id: "0a".to_owned() };
    let mut log = AccessLog::new(start);
    let mut access = Access {
        viewer: "acme".parse().unwrap(),
        agent: Agent { kind: AgentKind::User, id: "00ff".to_owned(), role: None },
        kind: AccessKind::Looked,
        request: RequestKey {
            operation_network_id: "net".parse().unwrap(),
            operation_id: "op".parse().unwrap(),
            dynamic_data_request_id: "req".parse().unwrap(),
        },
        fields: ["count".to_owned()].into(),
        values_from: Some(at(FIRST)),
        values_to: Some(at(LAST)),
        value_count: 6,
        since: at(LAST),
    };
    change(&mut access);
    let entry = log.append(access, at(LAST + 1)).canonical();
    let line = AccessAuditLine { entry }.line();
    let begin = AccessAuditStart::of(&log, &RemovedEntries::none(), &key).line();
    std::fs::write(folder.join("accesses"), format!("{begin}{line}")).unwrap();
    std::fs::write(folder.join("access-checkpoint"), log.sign_checkpoint(&key)).unwrap();
    let access_key = access_log_verifier(&"F".parse().unwrap(), &key.public()).unwrap().to_string();
    let [file, checkpoint, ledger] =
        ["accesses", "access-checkpoint", "audit.jsonl"].map(|name| path(folder, name));
    let arguments = ["access", "verify", &file, "--checkpoint", &checkpoint, "--key", &access_key];
    asi(&[&arguments[..], &["--ledger", &ledger, "--ledger-key", ledger_key]].concat(), "")
}

/// A widened access: what it is about, and the change that makes it.
type Change = (&'static str, fn(&mut Access));

#[test]
fn an_access_to_what_never_left_for_the_reader_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let key = write_ledger(folder.path());
    let honest = compare_access(folder.path(), &key, |_| {});
    assert_eq!(honest.code, 0, "{}{}", honest.out, honest.err);
    let outcome: Value = serde_json::from_str(&honest.out).unwrap();
    assert_eq!(outcome["left"]["accessesCovered"], json!(1), "{outcome:#}");
    let of_both = compare_access(folder.path(), &key, |access| {
        access.fields.insert("begin".to_owned());
    });
    assert_eq!(of_both.code, 0, "{}{}", of_both.out, of_both.err);
    let changes: [Change; 6] = [
        ("another organisation", |access| access.viewer = "hull".parse().unwrap()),
        ("another field", |access| access.fields = ["level".to_owned()].into()),
        ("another request", |access| {
            access.request.dynamic_data_request_id = "other".parse().unwrap();
        }),
        ("a value before the first", |access| access.values_from = Some(at(FIRST - 1))),
        ("a field that did not leave within the span", |access| {
            access.fields.insert("begin".to_owned());
            access.values_from = Some(at(FIRST + 1));
        }),
        ("a value after the last", |access| access.values_to = Some(at(LAST + 1))),
    ];
    for (what, change) in changes {
        let widened = compare_access(folder.path(), &key, change);
        assert_eq!(widened.code, 1, "{what}: {}{}", widened.out, widened.err);
        let outcome: Value = serde_json::from_str(&widened.out).unwrap();
        assert_eq!(outcome["left"]["faultCount"], json!(1), "{what}: {outcome:#}");
    }
}
