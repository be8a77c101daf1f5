//! Decisions open and close fields.

use asi_model::{DataValue, messages::ValueSource};
use serde_json::{Value, json};

use crate::{
    scene::{Scene, at, decision, field},
    use_cases::{
        decide::{DecisionCommand, DecisionRequest},
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
