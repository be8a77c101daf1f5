//! Change sets of several use cases in one transaction.

use asi_model::messages::ValueSource;
use serde_json::json;

use crate::{
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::DecisionCommand,
        revoke::{Revocation, revoke},
    },
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
    let id = scene.state.field(&field("made")).expect("a field").id;
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
