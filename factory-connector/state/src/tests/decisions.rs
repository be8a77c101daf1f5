//! Decisions open and close fields.

use asi_model::{DataValue, messages::ValueSource};
use serde_json::{Value, json};

use crate::{
    queries::shown_tag,
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::{DecisionCommand, DecisionError, DecisionRequest, decide_as_shown},
        values::write_value,
    },
};

const SOURCES: [ValueSource; 3] =
    [ValueSource::Mapping, ValueSource::Manual, ValueSource::External];

/// All values go through one function, and it opens for the decided source only.
#[test]
fn only_the_decided_source_gets_a_value_through() {
    for open in SOURCES {
        for offered in SOURCES {
            let mut scene = Scene::default();
            assert_eq!(scene.candidate("made", offered, 1_u64, 1), None, "undecided");
            scene.map("made", open, "{}");
            let outcome = scene.candidate("made", offered, 1_u64, 1);
            assert_eq!(outcome.is_some(), open == offered, "{open:?} decided, {offered:?} offered");
            assert_eq!(scene.state.writers().has_unreported(), open == offered);
            let reason = Some("no".to_owned());
            let refusal = DecisionRequest { reason, ..decision(DecisionCommand::Refuse) };
            scene.decide("made", refusal, 2).expect("refused");
            assert_eq!(scene.candidate("made", offered, 1_u64, 3), None, "refused");
        }
    }
    let mut scene = Scene::default();
    let value = DataValue::good(1_u64, at(1));
    let unknown =
        write_value(&mut scene.state, &field("unknown"), ValueSource::Manual, value, at(1));
    assert_eq!(unknown, Err(asi_model::StatusCode::BAD_NODE_ID_UNKNOWN));
}

/// The platform goes by the latest of two decisions: a clock that was set back must not make the end of a consent the
/// earlier one.
#[test]
fn a_decision_is_never_dated_before_the_one_that_it_follows() {
    let mut scene = Scene::default();
    scene.map("made", ValueSource::Manual, "{}");
    scene.decide("made", decision(DecisionCommand::LeavePending), 5_000).expect("decided");
    scene.commit(5_000);
    let refusal =
        DecisionRequest { reason: Some("no".to_owned()), ..decision(DecisionCommand::Refuse) };
    scene.decide("made", refusal, 1_000).expect("refused");
    let (writes, _) = scene.commit(1_000);
    let sent = writes.controls.queued.iter().filter(|row| row.subject == "decision");
    let sent: Vec<Value> = sent.map(|row| serde_json::from_str(&row.body).expect("JSON")).collect();
    let dated: Vec<_> =
        sent.iter().map(|sent| (&sent["mappingState"], &sent["decidedAt"])).collect();
    assert_eq!(dated, [(&json!("REFUSED"), &json!(at(5_000)))]);
    let stored = scene.state.field(&field("made")).and_then(|made| made.decision().decided_at);
    assert_eq!(stored, Some(at(5_000)), "it is sent again with the same date");
}

/// Two people who decide about one field at once, or a partner who changes the request meanwhile: a decision rests on
/// what its author saw, or is not taken.
#[test]
fn a_decision_on_what_was_shown_is_refused_once_it_changed() {
    let mut scene = Scene::default();
    let key = field("made");
    let refusal =
        || DecisionRequest { reason: Some("no".to_owned()), ..decision(DecisionCommand::Refuse) };
    let shown = |scene: &Scene| shown_tag(&scene.state, &key).expect("a field");
    let decide = |scene: &mut Scene, tag: Option<&str>| {
        let decided = |state: &mut _| decide_as_shown(state, &key, tag, refusal(), at(9));
        scene.attempt(|state| decided(state).map(|changes| ((), changes)))
    };
    let mut seen = shown(&scene);
    assert_eq!(shown(&scene), seen, "the same while nothing changes");
    scene.map("note", ValueSource::Manual, "{}");
    assert_eq!(shown(&scene), seen, "another field is none of its business");
    for change in [
        json!({ "recipientList": ["acme", "hull", "spy"] }),
        json!({ "purpose": "Something else" }),
        json!({ "updateFrequency": 2 }),
        json!({ "validUntil": "2030-01-01T00:00:00Z" }),
    ] {
        let revision = scene.state.networks().iter().map(|(_, network)| network.revision).max();
        scene.arrive(network(revision.expect("one") + 1, |request| {
            for (member, value) in change.as_object().expect("an object") {
                request[member] = value.clone();
            }
        }));
        let version = scene.state.field(&key).map(|made| made.decision().version);
        assert_eq!(decide(&mut scene, Some(&seen)), Err(DecisionError::DecidedSince), "{change}");
        assert_eq!(scene.state.field(&key).map(|made| made.decision().version), version);
        seen = shown(&scene);
    }
    scene.map("made", ValueSource::Manual, "{}");
    assert_eq!(decide(&mut scene, Some(&seen)), Err(DecisionError::DecidedSince));
    let now = shown(&scene);
    assert_eq!(decide(&mut scene, Some(&now)), Ok(()));
    assert_eq!(decide(&mut scene, Some(&now)), Err(DecisionError::DecidedSince));
    assert_eq!(decide(&mut scene, None), Ok(()), "who names nothing decides about it as it is");
}
