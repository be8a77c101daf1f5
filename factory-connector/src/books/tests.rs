use asi_model::{
    DataValue, Variant,
    messages::{GapCause, MappingState, ValueSource},
};
use mapping_engine::{Mapping, Published};
use serde_json::{Value, json};

use super::*;
use disclosure::DisclosurePolicy;

const START: i64 = 1_800_000_000_000_000;
const SOURCES: [ValueSource; 3] =
    [ValueSource::Mapping, ValueSource::Manual, ValueSource::External];

pub(crate) fn at(ms: i64) -> DateTime {
    DateTime::from_unix_micros(START + ms * 1_000)
}

pub(crate) fn network(revision: u64, change: impl FnOnce(&mut Value)) -> OperationNetworkMessage {
    let mut request = json!({ "dynamicDataRequestId": "R1", "requesterId": "acme", "recipientList": ["acme", "hull"],
        "purpose": "Plan", "updateFrequency": 1, "updateFrequencyUnit": "HOUR",
        "reportDataFormat": { "reportName": "Progress", "reportFieldList": [
            { "name": "made", "type": 9, "unit": "PIECE", "semantic": "PRODUCED_QUANTITY" }, { "name": "note", "type": 12 } ] } });
    change(&mut request);
    serde_json::from_value(json!({ "messageId": format!("m{revision}"), "factoryId": "F", "collaborationId": "c",
        "revision": revision, "operationNetwork": { "operationNetworkId": "n", "operationList": [
            { "operationId": "op", "operationType": "PRODUCTION", "dynamicDataRequestList": [request] } ] } }))
    .expect("a network")
}

pub(crate) fn books() -> Books {
    let config =
        BooksConfig { factory_id: "F".parse().expect("an id"), encoding: Encoding::Digicor };
    let mut books = Books::new(config, Snapshot::default(), false, at(0)).expect("empty books");
    arrive(&mut books, network(1, |_| ()));
    books
}

pub(crate) fn arrive(books: &mut Books, message: OperationNetworkMessage) {
    let raw = serde_json::to_string(&message).expect("serialises");
    books.network_arrived(message, raw, at(0));
}

pub(crate) fn field(name: &str) -> FieldKey {
    let request = RequestKey {
        operation_network_id: "n".parse().expect("an id"),
        operation_id: "op".parse().expect("an id"),
        dynamic_data_request_id: "R1".parse().expect("an id"),
    };
    request.field(name.parse().expect("a name"))
}

pub(crate) fn map(books: &mut Books, name: &str, value_source: ValueSource, policy: &str) {
    let mapping = (value_source == ValueSource::Mapping).then(|| {
        let json =
            json!({ "mappingId": "m", "target": field(name), "targetType": "UInt64", "inputs": [], "steps": [] });
        serde_json::from_value(json).expect("a mapping")
    });
    let policy: DisclosurePolicy = serde_json::from_str(policy).expect("a policy");
    let verdict = Verdict::Map { value_source, mapping, policy };
    books.decide(&field(name), verdict, None, "eve", at(0)).expect("decided");
}

/// Offers a value and reports; the bodies of what left.
pub(crate) fn offer(
    books: &mut Books,
    name: &str,
    value: impl Into<Variant>,
    ms: i64,
) -> Vec<Value> {
    let value = DataValue::good(value, at(ms));
    books.candidate(&field(name), ValueSource::Manual, value, None, at(ms));
    books.report(at(ms), || [7; SALT]);
    let (changes, _) = books.take();
    changes.reports.iter().map(|report| serde_json::from_str(&report.body).expect("JSON")).collect()
}

const SALT: usize = ledger::SALT_BYTES;

/// Every way in is the one function, and it opens for the decided source only.
#[test]
fn only_the_decided_source_gets_a_value_through() {
    let value = || DataValue::good(1_u64, at(1));
    for open in SOURCES {
        for offered in SOURCES {
            let mut books = books();
            assert_eq!(
                books.candidate(&field("made"), offered, value(), None, at(1)),
                None,
                "undecided"
            );
            map(&mut books, "made", open, "{}");
            let outcome = books.candidate(&field("made"), offered, value(), None, at(1));
            assert_eq!(outcome.is_some(), open == offered, "{open:?} decided, {offered:?} offered");
            assert_eq!(books.has_news(), open == offered);
            let refused =
                books.decide(&field("made"), Verdict::Refuse, Some("no".to_owned()), "eve", at(2));
            refused.expect("refused");
            assert_eq!(
                books.candidate(&field("made"), offered, value(), None, at(3)),
                None,
                "refused"
            );
        }
    }
    assert_eq!(
        books().candidate(&field("unknown"), ValueSource::Manual, value(), None, at(1)),
        None
    );
}

#[test]
fn a_report_and_its_ledger_entries_are_one_change() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, "{}");
    books.take();
    books.candidate(
        &field("made"),
        ValueSource::Manual,
        DataValue::good(7_u64, at(5)),
        None,
        at(5),
    );
    books.report(at(6), || [7; SALT]);
    let (changes, aftermath) = books.take();
    assert_eq!(changes.reports.len(), 1);
    let queued = |recipient: &str| {
        changes.ledger.iter().any(|(entry, report)| {
            entry.recipient.as_str() == recipient
                && entry.content.contains("QUEUED")
                && *report == Some(changes.reports[0].id)
        })
    };
    assert!(queued("acme") && queued("hull"));
    assert_eq!(aftermath.values.len(), 1, "the node shows what the partner gets");
    let report: Value = serde_json::from_str(&changes.reports[0].body).expect("JSON");
    let names: Vec<&String> = report["Payload"].as_object().expect("members").keys().collect();
    assert_eq!(
        names,
        [
            "reportName",
            "dynamicDataRequestId",
            "operationId",
            "operationNetworkId",
            "shopfloorTimestamp",
            "made",
            "madeUnit"
        ]
    );
    assert_eq!(report["Payload"]["made"], json!({ "Type": 9, "Body": "7" }));
}

/// The metadata messages of a transaction: which fields each describes, with the versions of its
/// data set.
fn descriptions(books: &mut Books) -> Vec<(Vec<String>, u64, u64)> {
    let (changes, _) = books.take();
    let bodies = changes
        .controls
        .iter()
        .filter(|control| control.subject == "ua-metadata")
        .map(|control| &control.body);
    bodies
        .map(|body| {
            let message: Value = serde_json::from_str(body).expect("JSON");
            let meta = &message["MetaData"];
            let names = meta["Fields"].as_array().expect("fields").iter().skip(5);
            let names =
                names.filter_map(|field| field["Name"].as_str().map(str::to_owned)).collect();
            let version =
                |member: &str| meta["ConfigurationVersion"][member].as_u64().expect("a version");
            (names, version("MajorVersion"), version("MinorVersion"))
        })
        .collect()
}

#[test]
fn all_decisions_of_a_transaction_are_described_once() {
    let mut books = books();
    map(&mut books, "note", ValueSource::Manual, "{}");
    map(&mut books, "made", ValueSource::Manual, "{}");
    assert!(books.has_urgent_changes());
    let described = descriptions(&mut books);
    let names: Vec<_> = described.iter().map(|(names, ..)| names.clone()).collect();
    assert_eq!(names, [["made", "madeUnit", "note"]]);
    assert_eq!(described[0].2, described[0].1 + 1, "two fields were added at once");
    map(&mut books, "note", ValueSource::Manual, "{}");
    let again = descriptions(&mut books);
    assert_eq!((again[0].1, again[0].2), (described[0].1, described[0].2 + 1));
}

/// What was taken back is over: what comes after it is of another epoch, though the fields are the
/// same.
#[test]
fn a_consent_that_ends_and_comes_again_in_one_transaction_begins_an_epoch() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, "{}");
    let before = descriptions(&mut books);
    books.decide(&field("made"), Verdict::LeavePending, None, "eve", at(1)).expect("decided");
    map(&mut books, "made", ValueSource::Manual, "{}");
    let after = descriptions(&mut books);
    assert_eq!(after.len(), 1);
    assert!(after[0].1 > before[0].1, "{before:?} {after:?}");
}

/// What the partner does not get, no node and no page shows either.
#[test]
fn of_several_values_in_one_transaction_the_newest_is_shown() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, "{}");
    map(&mut books, "note", ValueSource::Manual, "{}");
    books.take();
    let mut offer = |name: &str, value: Variant, ms| {
        books.candidate(
            &field(name),
            ValueSource::Manual,
            DataValue::good(value, at(ms)),
            None,
            at(ms),
        );
    };
    offer("made", 1_u64.into(), 1);
    offer("note", "a".into(), 2);
    offer("made", 2_u64.into(), 3);
    offer("note", "b".into(), 4);
    books.report(at(5), || [7; SALT]);
    let (changes, aftermath) = books.take();
    let shown: Vec<_> =
        aftermath.values.iter().map(|(key, value)| (key.clone(), value.value.clone())).collect();
    assert_eq!(shown, [(field("made"), 2_u64.into()), (field("note"), "b".into())]);
    assert_eq!(aftermath.events.len(), 2, "{:?}", aftermath.events);
    assert_eq!((changes.reports.len(), changes.field_values.len()), (1, 2));

    books.candidate(&field("note"), ValueSource::Manual, DataValue::good("c", at(6)), None, at(6));
    books.report(at(6), || [7; SALT]);
    let (changes, aftermath) = books.take();
    assert_eq!(
        (aftermath.values.len(), aftermath.events.len(), changes.field_values.len()),
        (1, 1, 1)
    );
}

#[test]
fn sequences_count_without_gaps_and_coarsened_repeats_do_not_count() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, r#"{"roundingStep":10}"#);
    let mut sequences = Vec::new();
    for value in 0..=30_u64 {
        for report in offer(&mut books, "made", value, i64::try_from(value).expect("small") + 1) {
            sequences.push(report["SequenceNumber"].as_u64());
        }
    }
    assert_eq!(sequences, [Some(0), Some(1), Some(2), Some(3)]);
}

#[test]
fn a_minimum_interval_is_kept_and_its_end_is_noted() {
    let mut books = books();
    map(&mut books, "made", ValueSource::Manual, r#"{"minimumIntervalMs":1000}"#);
    assert_eq!(offer(&mut books, "made", 1_u64, 0).len(), 1);
    assert_eq!(offer(&mut books, "made", 2_u64, 10).len(), 0);
    assert_eq!(books.next_due(), Some(at(1000)));
    books.release_due(at(1000));
    books.report(at(1000), || [7; SALT]);
    assert_eq!(books.take().0.reports.len(), 1);
}

#[test]
fn a_revision_takes_consent_back_only_where_more_is_asked_for() {
    let check = |change: fn(&mut Value), expected| {
        let mut books = books();
        map(&mut books, "made", ValueSource::Manual, "{}");
        arrive(&mut books, network(2, change));
        let state = books.field(&field("made")).map(|field| field.decision.mapping_state);
        assert_eq!(state, expected);
        books
    };
    check(|request| request["description"] = json!("more words"), Some(MappingState::Mapped));
    check(|request| request["purpose"] = json!("something else"), Some(MappingState::Pending));
    check(
        |request| request["recipientList"] = json!(["acme", "hull", "spy"]),
        Some(MappingState::Pending),
    );
    check(|request| request["updateFrequency"] = json!(60), Some(MappingState::Pending));
    let books = check(
        |request| {
            drop(request["reportDataFormat"]["reportFieldList"].as_array_mut().map(|l| l.remove(0)))
        },
        None,
    );
    assert_eq!(
        books.purges.values().next(),
        Some(&GapCause::Withdrawn),
        "what was queued is announced as a gap"
    );
}

#[test]
fn an_old_revision_changes_nothing() {
    let mut books = books();
    arrive(&mut books, network(3, |_| ()));
    books.take();
    arrive(&mut books, network(2, |request| request["purpose"] = json!("older")));
    let (changes, _) = books.take();
    assert!(changes.networks.is_empty() && changes.fields.is_empty());
    assert!(changes.controls.iter().any(|control| control.body.contains("UNCHANGED")));
}

fn entry(id: &str, action: Value, ms: i64) -> crate::operator::OperatorEntry {
    crate::operator::OperatorEntry {
        entry_id: id.to_owned().try_into().expect("an id"),
        operation: crate::operator::OperationKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
        },
        made_at: at(ms),
        received_at: at(ms),
        made_by: "otto".to_owned(),
        action: serde_json::from_value(action).expect("an action"),
    }
}

fn made(books: &Books) -> Option<Variant> {
    books
        .field(&field("made"))
        .and_then(|field| field.gate.disclosed())
        .map(|value| value.value.clone())
}

/// Entries of the operator's page take the way of all values: the decision must be Manual, and the
/// gate coarsens.
#[test]
fn entries_go_through_the_gate_once() {
    let mut books = books();
    let taken = |outcome| match outcome {
        EntryOutcome::Taken(fields) => fields.len(),
        other => panic!("{other:?}"),
    };
    let add = json!({ "action": "ADD" });
    assert_eq!(taken(books.enter(entry("a", add.clone(), 1), at(1))), 0, "nothing is open yet");
    map(&mut books, "made", ValueSource::Manual, r#"{"roundingStep":2}"#);
    assert_eq!(taken(books.enter(entry("b", add.clone(), 2), at(2))), 1);
    assert_eq!(made(&books), Some(2_u64.into()));
    assert_eq!(books.enter(entry("b", add.clone(), 2), at(3)), EntryOutcome::Repeated);
    taken(books.enter(entry("late", json!({ "action": "ADD", "quantity": 3 }), -5), at(4)));
    assert_eq!(made(&books), Some(6_u64.into()), "5 pieces in steps of 2");
    let value = json!({ "action": "VALUE", "dynamicDataRequestId": "R1", "fieldName": "made", "value": "twelve" });
    let refused = |outcome| match outcome {
        EntryOutcome::Refused(fault) => fault.code(),
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(books.enter(entry("c", value.clone(), 5), at(5))), "WRONG_TYPE");
    map(&mut books, "made", ValueSource::External, "{}");
    assert_eq!(refused(books.enter(entry("d", value, 6), at(6))), "NOT_MANUAL");
    assert_eq!(taken(books.enter(entry("e", add, 7), at(7))), 0, "another source is decided");
    let stored: Vec<_> = books
        .take()
        .0
        .operator_entries
        .iter()
        .map(|entry| entry.entry_id.as_str().to_owned())
        .collect();
    assert_eq!(stored, ["a", "b", "late", "e"], "only what was taken is stored");
    books.network_withdrawn(
        serde_json::from_value(
            json!({ "messageId": "w", "factoryId": "F", "operationNetworkId": "n", "revision": 9 }),
        )
        .expect("a withdrawal"),
        at(8),
    );
    assert_eq!(
        refused(books.enter(entry("f", json!({ "action": "DONE" }), 8), at(8))),
        "UNKNOWN_OPERATION"
    );
}

/// A mapping of `made` with these functions, as the field takes it.
fn fitted(books: &Books, steps: &Value) -> Mapping {
    let json = json!({ "mappingId": "x", "target": field("made"), "targetType": "UInt64", "targetUnit": "PIECE",
        "inputs": [{ "name": "a", "sourceId": "s", "nodeId": "nsu=urn:x;i=1" }], "steps": steps });
    books.fitted(serde_json::from_value(json).expect("a mapping")).expect("it fits")
}

#[test]
fn a_corrected_mapping_is_a_version_and_no_consent() {
    let mut books = books();
    let steps = json!([{ "function": "counter" }]);
    let place = |books: &mut Books, steps: &Value| {
        let placing =
            Placing { mapping: fitted(books, steps), author: "eve".to_owned(), note: None };
        books.place(vec![placing], at(1));
        let (changes, aftermath) = books.take();
        let versions: Vec<u32> = changes.mappings.versions.iter().map(|row| row.version).collect();
        (versions, changes.consents.len(), aftermath.mappings.len())
    };
    books.take();
    assert_eq!(place(&mut books, &steps), (vec![], 0, 0), "undecided: a proposal");
    let decided = Verdict::Map {
        value_source: ValueSource::Mapping,
        mapping: Some(Box::new(fitted(&books, &steps))),
        policy: DisclosurePolicy::default(),
    };
    books.decide(&field("made"), decided.clone(), None, "eve", at(2)).expect("decided");
    assert_eq!(books.take().0.mappings.versions[0].version, 1);
    books.decide(&field("made"), decided, None, "eve", at(2)).expect("decided");
    assert!(books.take().0.mappings.versions.is_empty(), "the same is no version");

    let state: mapping_engine::TransformState =
        serde_json::from_str(r#"[{"function":"counter","total":5,"last":15,"level":null}]"#)
            .expect("a state");
    let value = DataValue::good(5_u64, at(3));
    books.candidate(&field("made"), ValueSource::Mapping, value, Some(state), at(3));
    let scaled = json!([{ "function": "counter" }, { "function": "scale", "factor": 2 }]);
    assert_eq!(place(&mut books, &scaled), (vec![2], 0, 1));
    assert_eq!(place(&mut books, &scaled), (vec![], 0, 0));
    let kept =
        books.field(&field("made")).and_then(|field| serde_json::to_string(&field.transform).ok());
    assert!(
        kept.is_some_and(|kept| kept.contains(r#""total":5"#)),
        "a counter goes on through a correction"
    );

    let misfit = Mapping { target_unit: Some("KGM".to_owned()), ..fitted(&books, &scaled) };
    assert_eq!(books.fitted(misfit).expect_err("another unit")[0].member, "targetUnit");
}

#[test]
fn a_shadow_goes_with_its_field() {
    let mut books = books();
    let shadow = fitted(&books, &json!([]));
    books.set_shadow(&field("made"), Some(shadow), "eve", at(1)).expect("there is the field");
    let started = books.take();
    assert!(matches!(
        started.1.mappings.as_slice(),
        [MappingWork::Put(Published { is_shadow: true, .. })]
    ));
    arrive(
        &mut books,
        network(2, |request| request["reportDataFormat"]["reportFieldList"] = json!([])),
    );
    let (changes, aftermath) = books.take();
    assert!(changes.mappings.is_empty());
    assert!(aftermath.mappings.iter().any(|work| matches!(work, MappingWork::Remove(_))));
}
