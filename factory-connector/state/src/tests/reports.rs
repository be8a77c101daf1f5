//! Reports: values, their ledger entries, and what nodes and pages show.

use asi_model::{DateTime, FieldName, messages::ValueSource};
use serde_json::{Value, json};

use crate::{
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::DecisionCommand,
        keep_alive::keep_alives,
        validity::{begin_requests, end_requests},
        values::release_due,
    },
};

#[test]
fn a_report_and_its_ledger_entries_are_one_change() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.commit(0);
    scene.candidate("made", ValueSource::Manual, 7_u64, 5);
    let (writes, effects) = scene.commit(6);
    let [report] = &writes.reports.queued[..] else { panic!("{:?}", writes.reports) };
    let is_queued = |recipient: &str| {
        writes.ledger.entries.iter().any(|(entry, about)| {
            entry.recipient.as_str() == recipient
                && entry.content.contains("QUEUED")
                && *about == Some(report.id)
        })
    };
    assert!(is_queued("acme") && is_queued("hull"));
    assert_eq!(writes.ledger.heads.len(), 2, "the heads of both chains are signed");
    assert_eq!(effects.values.len(), 1, "the node shows what the partner gets");
    let report: Value = serde_json::from_str(&report.body).expect("JSON");
    let names: Vec<&String> = report["Payload"].as_object().expect("members").keys().collect();
    let header = [
        "reportName",
        "dynamicDataRequestId",
        "operationId",
        "operationNetworkId",
        "shopfloorTimestamp",
        "recipientList",
    ];
    assert_eq!(names, [&header[..], &["made", "madeUnit"]].concat());
    assert_eq!(report["Payload"]["recipientList"], json!({ "Type": 12, "Body": ["acme", "hull"] }));
    assert_eq!(report["Payload"]["made"], json!({ "Type": 9, "Body": "7" }));
}

/// The consent under which a report is made settles who may read it: recipients that a revision
/// adds are named by the reports of the next consent, in a new epoch.
#[test]
fn a_report_names_the_recipients_of_its_consent() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    let first = scene.offer("made", 1_u64, 1);
    scene.arrive(network(2, |request| request["recipientList"] = json!(["acme", "hull", "new"])));
    assert_eq!(scene.offer("made", 2_u64, 2), Vec::<Value>::new(), "the consent has ended");
    scene.map("made", ValueSource::Manual, "{}");
    let second = scene.offer("made", 3_u64, 3);
    let named = |reports: &[Value]| reports[0]["Payload"]["recipientList"]["Body"].clone();
    assert_eq!(named(&first), json!(["acme", "hull"]));
    assert_eq!(named(&second), json!(["acme", "hull", "new"]));
    let epoch = |reports: &[Value]| reports[0]["MetaDataVersion"]["MajorVersion"].as_u64();
    assert!(epoch(&second) > epoch(&first));
}

/// A network of before the name was reserved has a field of the name: its reports go on as they
/// were, and name no recipients.
#[test]
fn a_field_with_the_name_of_the_recipients_keeps_it() {
    let mut scene = Scene::empty();
    scene.arrive(network(1, |request| {
        request["reportDataFormat"]["reportFieldList"][0] =
            json!({ "name": "recipientList", "type": 9 });
    }));
    scene.map("recipientList", ValueSource::Manual, "{}");
    let described = descriptions_from(&mut scene, 5);
    assert_eq!(described[0].0, ["recipientList"]);
    let reports = scene.offer("recipientList", 7_u64, 1);
    assert_eq!(reports[0]["Payload"]["recipientList"], json!({ "Type": 9, "Body": "7" }));
}

/// The metadata messages of a transaction, without the members of the header: the fields that each describes, MajorVersion and
/// MinorVersion.
fn descriptions(scene: &mut Scene) -> Vec<(Vec<String>, u64, u64)> {
    descriptions_from(scene, 6)
}

/// The same without the first `header_members`.
fn descriptions_from(scene: &mut Scene, header_members: usize) -> Vec<(Vec<String>, u64, u64)> {
    let (writes, _) = scene.commit(0);
    let controls = writes.controls.queued.iter();
    let meta_data = controls.filter(|control| control.subject == "ua-metadata");
    let describe = |body: &str| {
        let message: Value = serde_json::from_str(body).expect("JSON");
        let meta = &message["MetaData"];
        let names = meta["Fields"].as_array().expect("fields").iter().skip(header_members);
        let names = names.filter_map(|field| field["Name"].as_str().map(str::to_owned)).collect();
        let version =
            |member: &str| meta["ConfigurationVersion"][member].as_u64().expect("a version");
        (names, version("MajorVersion"), version("MinorVersion"))
    };
    meta_data.map(|control| describe(&control.body)).collect()
}

#[test]
fn all_decisions_of_a_transaction_are_described_once() {
    let mut scene = Scene::default();
    scene.map("note", ValueSource::Manual, "{}");
    scene.map("made", ValueSource::Manual, "{}");
    assert!(scene.pending.is_urgent());
    let described = descriptions(&mut scene);
    let names: Vec<_> = described.iter().map(|(names, ..)| names.clone()).collect();
    assert_eq!(names, [["made", "madeUnit", "note"]]);
    assert_eq!(described[0].2, described[0].1 + 1, "two fields were added at once");
    scene.map("note", ValueSource::Manual, "{}");
    let again = descriptions(&mut scene);
    assert_eq!((again[0].1, again[0].2), (described[0].1, described[0].2 + 1));
}

/// Reports after a revocation belong to another epoch, though the fields are the same.
#[test]
fn a_consent_that_ends_and_comes_again_in_one_transaction_begins_an_epoch() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    let before = descriptions(&mut scene);
    scene.decide("made", decision(DecisionCommand::LeavePending), 1).expect("decided");
    scene.map("made", ValueSource::Manual, "{}");
    let after = descriptions(&mut scene);
    assert_eq!(after.len(), 1);
    assert!(after[0].1 > before[0].1, "{before:?} {after:?}");
}

/// Nodes and pages never show a value that the partner does not get.
#[test]
fn of_several_values_in_one_transaction_the_newest_is_shown() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.commit(0);
    scene.candidate("made", ValueSource::Manual, 1_u64, 1);
    scene.candidate("note", ValueSource::Manual, "a", 2);
    scene.candidate("made", ValueSource::Manual, 2_u64, 3);
    scene.candidate("note", ValueSource::Manual, "b", 4);
    let (writes, effects) = scene.commit(5);
    let shown: Vec<_> =
        effects.values.iter().map(|(key, value)| (key.clone(), value.value.clone())).collect();
    assert_eq!(shown, [(field("made"), 2_u64.into()), (field("note"), "b".into())]);
    assert_eq!(effects.fields.len(), 2, "{:?}", effects.fields);
    assert_eq!((writes.reports.queued.len(), writes.fields.values.len()), (1, 2));

    scene.candidate("note", ValueSource::Manual, "c", 6);
    let (writes, effects) = scene.commit(6);
    let counts = (effects.values.len(), effects.fields.len(), writes.fields.values.len());
    assert_eq!(counts, (1, 1, 1));
}

#[test]
fn sequences_count_without_gaps_and_coarsened_repeats_do_not_count() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, r#"{"roundingStep":10}"#);
    let mut sequences = Vec::new();
    for value in 0..=30_u64 {
        let reports = scene.offer("made", value, i64::try_from(value).expect("small") + 1);
        sequences.extend(reports.iter().map(|report| report["SequenceNumber"].as_u64()));
    }
    assert_eq!(sequences, [Some(0), Some(1), Some(2), Some(3)]);
}

#[test]
fn a_field_is_carried_once_in_an_epoch() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    let mut carried: Vec<(FieldName, u32)> = Vec::new();
    for value in 1..4_u64 {
        scene.candidate("made", ValueSource::Manual, value, 1);
        let (writes, _) = scene.commit(1);
        let rows = writes.writers.carried_fields.into_iter();
        carried.extend(rows.map(|row| (row.field.field_name, row.first_sequence)));
    }
    assert_eq!(carried, [(field("made").field_name, 0)]);
}

#[test]
fn a_minimum_interval_is_respected_and_its_end_is_a_deadline() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, r#"{"minimumIntervalMs":1000}"#);
    assert_eq!(scene.offer("made", 1_u64, 0).len(), 1);
    assert_eq!(scene.offer("made", 2_u64, 10).len(), 0);
    assert_eq!(scene.state.fields().next_deadline(), Some(at(1000)));
    release_due(&mut scene.state, at(1000));
    assert_eq!(scene.commit(1000).0.reports.queued.len(), 1);
}

#[test]
fn values_flow_within_the_requests_validity_only() {
    use crate::{scene::network, use_cases::decide::DecisionError};
    let (from, until) = (at(1_000), at(2_000));
    let mut scene = Scene::default();
    scene.arrive(network(2, |request| {
        request["validFrom"] = json!(from);
        request["validUntil"] = json!(until);
    }));
    scene.map("made", ValueSource::Manual, "{}");
    assert_eq!(scene.offer("made", 1_u64, 500).len(), 0, "not yet asked for");
    assert_eq!(scene.state.fields().next_deadline(), Some(from));
    begin_requests(&mut scene.state, from);
    let (writes, _) = scene.commit(1_000);
    assert_eq!(writes.reports.queued.len(), 1, "the newest value, once it is asked for");
    assert_eq!(scene.offer("made", 2_u64, 1_500).len(), 1);
    assert_eq!(scene.state.fields().next_deadline(), Some(until));
    scene.run(|state| end_requests(state, until));
    assert!(!scene.state.field(&field("made")).expect("a field").decision().is_mapped());
    assert_eq!(scene.state.fields().next_deadline(), None);
    assert_eq!(scene.offer("made", 3_u64, 2_001).len(), 0);
    let command = DecisionCommand::Map {
        value_source: ValueSource::Manual,
        mapping: None,
        policy: disclosure::DisclosurePolicy::default(),
    };
    assert_eq!(scene.decide("made", decision(command), 2_002), Err(DecisionError::Ended));
}

#[test]
fn a_keep_alive_tells_its_time_on_the_time_step() {
    const HOUR: i64 = 3_600_000;
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, r#"{"timeStepMs":3600000}"#);
    scene.commit(0);
    let silent = keep_alives(&mut scene.state, at(HOUR + 1_234_567));
    let [keep_alive] = &silent[..] else { panic!("{silent:?}") };
    let body: Value = serde_json::from_slice(&keep_alive.body.clone().into_bytes()).expect("JSON");
    let timestamp: DateTime =
        serde_json::from_value(body["Messages"][0]["Timestamp"].clone()).expect("a time");
    assert_eq!(timestamp, at(HOUR));
}
