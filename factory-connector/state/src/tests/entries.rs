//! Entries of operators.

use asi_model::{Variant, messages::ValueSource};
use serde_json::{Value, json};

use crate::{
    operator::{OperationKey, OperatorEntry},
    scene::{Scene, at, field, network},
    use_cases::{
        enter::{EntryOutcome, enter},
        revise::receive_withdrawal,
    },
};

fn entry(id: &str, action: Value, ms: i64) -> OperatorEntry {
    OperatorEntry {
        entry_id: id.to_owned().try_into().expect("an id"),
        operation: OperationKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
        },
        made_at: at(ms),
        received_at: at(ms),
        made_by: "otto".to_owned(),
        action: serde_json::from_value(action).expect("an action"),
    }
}

fn enter_at(scene: &mut Scene, entry: OperatorEntry, ms: i64) -> EntryOutcome {
    let (outcome, changes) = enter(&mut scene.state, entry, at(ms));
    scene.pending.merge(changes);
    outcome
}

fn made(scene: &Scene) -> Option<Variant> {
    let field = scene.state.field(&field("made"))?;
    field.gate().disclosed().map(|value| value.value.clone())
}

fn taken(outcome: EntryOutcome) -> usize {
    match outcome {
        EntryOutcome::Taken(fields) => fields.len(),
        other => panic!("{other:?}"),
    }
}

fn refused(outcome: EntryOutcome) -> &'static str {
    match outcome {
        EntryOutcome::Refused(fault) => fault.code(),
        other => panic!("{other:?}"),
    }
}

/// Entries go the way of all values: the decision must be Manual, and the gate coarsens.
#[test]
fn entries_go_through_the_gate_once() {
    let mut scene = Scene::default();
    let add = json!({ "action": "ADD" });
    let before = enter_at(&mut scene, entry("a", add.clone(), 1), 1);
    assert_eq!(taken(before), 0, "nothing is open yet");
    scene.map("made", ValueSource::Manual, r#"{"roundingStep":2}"#);
    assert_eq!(taken(enter_at(&mut scene, entry("b", add.clone(), 2), 2)), 1);
    assert_eq!(made(&scene), Some(2_u64.into()));
    let again = enter_at(&mut scene, entry("b", add.clone(), 2), 3);
    assert_eq!(again, EntryOutcome::Repeated);
    let late = entry("late", json!({ "action": "ADD", "quantity": 3 }), -5);
    taken(enter_at(&mut scene, late, 4));
    assert_eq!(made(&scene), Some(6_u64.into()), "5 pieces in steps of 2");
    let value = json!({ "action": "VALUE", "dynamicDataRequestId": "R1", "fieldName": "made",
        "value": "twelve" });
    let wrong = enter_at(&mut scene, entry("c", value.clone(), 5), 5);
    assert_eq!(refused(wrong), "WRONG_TYPE");
    scene.map("made", ValueSource::External, "{}");
    assert_eq!(refused(enter_at(&mut scene, entry("d", value, 6), 6)), "NOT_MANUAL");
    let other = enter_at(&mut scene, entry("e", add, 7), 7);
    assert_eq!(taken(other), 0, "another source is decided");
    let (writes, _) = scene.commit(7);
    let stored: Vec<_> =
        writes.operator_entries.iter().map(|entry| entry.entry_id.as_str().to_owned()).collect();
    assert_eq!(stored, ["a", "b", "late", "e"], "only accepted entries are stored");
}

#[test]
fn entries_about_a_withdrawn_network_are_refused() {
    let mut scene = Scene::default();
    withdraw(&mut scene, 9);
    let done = enter_at(&mut scene, entry("f", json!({ "action": "DONE" }), 8), 8);
    assert_eq!(refused(done), "UNKNOWN_OPERATION");
}

fn withdraw(scene: &mut Scene, revision: u64) {
    let withdrawal = json!({ "messageId": "w", "factoryId": "F", "operationNetworkId": "n",
        "revision": revision });
    let withdrawal = serde_json::from_value(withdrawal).expect("a withdrawal");
    scene.run(|state| receive_withdrawal(state, withdrawal, at(8)));
}

/// The store removes a network's entries before it writes new ones.
#[test]
fn of_one_transaction_entries_after_a_withdrawal_stay() {
    let mut scene = Scene::default();
    let start = |id: &str| entry(id, json!({ "action": "START" }), 1);
    enter_at(&mut scene, start("before"), 1);
    withdraw(&mut scene, 9);
    scene.arrive(network(10, |_| ()));
    enter_at(&mut scene, start("after"), 2);
    let (writes, _) = scene.commit(2);
    let [stored] = &writes.operator_entries[..] else { panic!("{:?}", writes.operator_entries) };
    assert_eq!(stored.entry_id.as_str(), "after");
    let journal = scene.state.journal(&stored.operation).expect("a journal");
    assert_eq!(journal.newest().count(), 1, "the state is as it is stored");
}
