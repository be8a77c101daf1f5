//! Change sets of several use cases in one transaction.

use asi_model::messages::ValueSource;
use serde_json::json;
use spool::{ReportRow, RowId};

use crate::{
    scene::{Scene, at, decision, field, network},
    transaction::DeliveryState,
    use_cases::{
        decide::DecisionCommand,
        revise::receive_withdrawal,
        revoke::{Revocation, revoke},
    },
    writes::WaitingRow,
};

fn revocation(names: &[&str]) -> Revocation {
    Revocation {
        fields: names.iter().map(|name| field(name)).collect(),
        command: DecisionCommand::LeavePending,
        reason: Some("Enough.".to_owned()),
        revoked_by: "eve".to_owned(),
    }
}

/// Returns the receipts of a transaction as JSON.
fn receipts(scene: &mut Scene) -> Vec<serde_json::Value> {
    let (writes, _) = scene.commit(9);
    let rows = writes.ledger.revocations.iter();
    rows.map(|row| serde_json::from_str(&row.content).expect("JSON")).collect()
}

#[test]
fn consents_that_are_revoked_together_share_one_receipt() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.commit(0);
    scene.attempt(|state| revoke(state, &revocation(&["made", "note"]), at(1))).expect("revoked");
    let receipts = receipts(&mut scene);
    assert_eq!(receipts.len(), 1);
    assert_eq!(receipts[0]["fields"].as_array().map(Vec::len), Some(2));
}

#[test]
fn separate_revocations_of_one_transaction_state_the_writer_as_it_was_at_the_first() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.commit(0);
    scene.attempt(|state| revoke(state, &revocation(&["made"]), at(1))).expect("revoked");
    scene.decide("note", decision(DecisionCommand::LeavePending), 2).expect("decided");
    let receipts = receipts(&mut scene);
    assert_eq!(receipts.len(), 2, "each has a receipt of its own");
    let epoch = |receipt: &serde_json::Value| receipt["writers"][0]["epoch"].clone();
    assert_eq!(epoch(&receipts[0]), epoch(&receipts[1]));
}

#[test]
fn a_withdrawal_is_stated_in_one_receipt() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.map("note", ValueSource::Manual, "{}");
    scene.commit(0);
    scene.arrive(network(2, |request| {
        request["reportDataFormat"]["reportFieldList"] = json!([]);
    }));
    let receipts = receipts(&mut scene);
    assert_eq!(receipts.len(), 1);
    assert_eq!(receipts[0]["fields"].as_array().map(Vec::len), Some(2));
}

/// Commits while one report waits, and returns the cause that the gap states.
fn gap_cause(scene: &mut Scene) -> String {
    let id = *scene.pending.purges.keys().next().expect("reports are taken back");
    let row = ReportRow {
        id: RowId(1),
        data_set_writer_id: id,
        epoch: scene.state.writers().get(id).expect("a writer").epoch(),
        sequence: 0,
        bytes: 10,
        created_at: at(0).into(),
        sent_at: None,
        sent_count: 0,
    };
    let waiting =
        WaitingRow { row, recipients: Vec::new(), is_revoked: false, message: 1, is_done: false };
    let delivery =
        DeliveryState { purged: [(id, vec![waiting])].into(), ..DeliveryState::default() };
    let (writes, _) = scene.commit_with(delivery, 9);
    let gaps: Vec<serde_json::Value> = writes
        .controls
        .queued
        .iter()
        .filter(|control| control.subject == "gap")
        .map(|control| serde_json::from_str(&control.body).expect("JSON"))
        .collect();
    let [gap] = &gaps[..] else { panic!("one gap, not {gaps:?}") };
    gap["cause"].as_str().expect("a cause").to_owned()
}

/// A decision of a person is the cause of the gap, whichever of the use cases of a transaction came
/// first; only the end of the whole request is stated instead.
#[test]
fn of_several_use_cases_the_gap_states_one_cause() {
    let open = || {
        let mut scene = Scene::default();
        scene.map("made", ValueSource::Manual, "{}");
        scene.map("note", ValueSource::Manual, "{}");
        scene.commit(0);
        scene
    };
    let pending = || decision(DecisionCommand::LeavePending);
    let without_made = || {
        network(2, |request| {
            let fields = request["reportDataFormat"]["reportFieldList"].as_array_mut();
            fields.expect("fields").remove(0);
        })
    };
    let mut scene = open();
    scene.arrive(without_made());
    assert_eq!(gap_cause(&mut scene), "WITHDRAWN");

    let mut scene = open();
    scene.arrive(without_made());
    scene.decide("note", pending(), 1).expect("decided");
    assert_eq!(gap_cause(&mut scene), "REVOKED");

    let mut scene = open();
    scene.decide("note", pending(), 1).expect("decided");
    scene.arrive(without_made());
    assert_eq!(gap_cause(&mut scene), "REVOKED");

    let mut scene = open();
    scene.decide("note", pending(), 1).expect("decided");
    let withdrawal = json!({ "messageId": "w", "factoryId": "F", "operationNetworkId": "n",
        "revision": 2 });
    let withdrawal = serde_json::from_value(withdrawal).expect("a withdrawal");
    scene.run(|state| receive_withdrawal(state, withdrawal, at(2)));
    assert_eq!(gap_cause(&mut scene), "WITHDRAWN");
}

#[test]
fn a_transaction_without_changes_writes_nothing() {
    let mut scene = Scene::default();
    assert!(!scene.commit(0).0.is_empty());
    let (writes, effects) = scene.commit(1);
    assert!(writes.is_empty(), "{writes:?}");
    assert!(effects.values.is_empty() && effects.twin.is_empty());
}

/// A field that was decided and removed in one transaction leaves no row that refers to it.
#[test]
fn a_removed_field_leaves_no_row() {
    let mut scene = Scene::default();
    scene.commit(0);
    let id = scene.state.field(&field("made")).expect("a field").id();
    scene.map("made", ValueSource::Mapping, "{}");
    scene.arrive(network(2, |request| {
        request["reportDataFormat"]["reportFieldList"] = json!([]);
    }));
    let (writes, _) = scene.commit(1);
    assert!(writes.fields.removed.contains(&id));
    assert!(!writes.fields.decided.contains_key(&id));
    assert!(!writes.fields.values.contains_key(&id));
    assert!(writes.mappings.versions.iter().all(|row| row.field_id != id));
}
