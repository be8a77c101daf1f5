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

/// A revision that was rejected may have taken consents back at the platform.
#[test]
fn decisions_are_sent_again_after_a_revision_that_did_not_arrive() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.commit(0);
    let sent = |scene: &mut Scene, revision| {
        scene.arrive(network(revision, |request| {
            request["description"] = json!(revision.to_string())
        }));
        let (writes, _) = scene.commit(1);
        let decisions = writes.controls.queued.iter().filter(|row| row.subject == "decision");
        let decisions: Vec<Value> =
            decisions.map(|row| serde_json::from_str(&row.body).expect("JSON")).collect();
        let field = |sent: &Value| {
            (sent["fieldName"].clone(), sent["mappingState"].clone(), sent["decidedAt"].clone())
        };
        decisions.iter().map(field).collect::<Vec<_>>()
    };
    assert_eq!(sent(&mut scene, 2), [], "it follows the first one");
    let decided = scene.state.field(&field("made")).and_then(|made| made.decision().decided_at);
    let expected = (json!("made"), json!("MAPPED"), json!(decided));
    assert_eq!(sent(&mut scene, 4), [expected], "the third one did not arrive");
    assert_eq!(sent(&mut scene, 5), []);
}
