//! Revisions and withdrawals of networks.

use asi_model::messages::{GapCause, MappingState, ValueSource};
use serde_json::{Value, json};

use crate::scene::{Scene, field, network};

#[test]
fn a_revision_takes_consent_back_only_where_more_is_asked_for() {
    let check = |change: fn(&mut Value), expected| {
        let mut scene = Scene::default();
        scene.map("made", ValueSource::Manual, "{}");
        scene.arrive(network(2, change));
        let field = scene.state.field(&field("made"));
        assert_eq!(field.map(|field| field.decision().mapping_state), expected);
        scene
    };
    check(|request| request["description"] = json!("more words"), Some(MappingState::Mapped));
    check(|request| request["purpose"] = json!("something else"), Some(MappingState::Pending));
    check(
        |request| request["recipientList"] = json!(["acme", "hull", "spy"]),
        Some(MappingState::Pending),
    );
    check(|request| request["updateFrequency"] = json!(60), Some(MappingState::Pending));
    let without_made = |request: &mut Value| {
        let fields = request["reportDataFormat"]["reportFieldList"].as_array_mut();
        fields.expect("fields").remove(0);
    };
    let scene = check(without_made, None);
    let purges: Vec<_> = scene.pending.purges.values().map(|purge| purge.cause).collect();
    assert_eq!(purges, [GapCause::Withdrawn], "what was queued is announced as a gap");
}

#[test]
fn an_old_revision_changes_nothing() {
    let mut scene = Scene::default();
    scene.arrive(network(3, |_| ()));
    scene.commit(0);
    scene.arrive(network(2, |request| request["purpose"] = json!("older")));
    let (writes, _) = scene.commit(1);
    assert!(writes.networks.is_empty() && writes.fields.decided.is_empty());
    assert!(writes.controls.queued.iter().any(|control| control.body.contains("UNCHANGED")));
}
