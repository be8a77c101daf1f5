//! Standing rules.

use asi_model::messages::{MappingState, ValueSource};
use disclosure::{DisclosurePolicy, Rule, RuleAction};
use serde_json::json;

use crate::{
    queries::rule_offer,
    scene::{Scene, at, decision, field, network},
    use_cases::{
        decide::{DecisionCommand, DecisionError},
        rules::{apply_rules, put_rule, undo_rule_decision},
    },
};

fn put(scene: &mut Scene, name: &str, action: &str, value_source: &str) {
    let rule = json!({ "name": "n", "isEnabled": true, "action": action,
        "when": { "partners": ["acme", "hull"], "namePattern": "made" },
        "valueSource": value_source, "reason": "no", "disclosure": { "roundingStep": 10 } });
    let rule: Rule = serde_json::from_value(rule).expect("a rule");
    let id = name.parse().expect("an id");
    scene.attempt(|state| put_rule(state, &id, rule, None, "eve", at(0))).expect("stored");
}

fn apply(scene: &mut Scene, ms: i64) -> usize {
    let (count, changes) = apply_rules(&mut scene.state, None, at(ms));
    scene.pending.merge(changes);
    count
}

fn mapping_state(scene: &Scene, name: &str) -> MappingState {
    scene.state.field(&field(name)).expect("a field").decision().mapping_state
}

#[test]
fn a_rule_decides_on_demand_and_can_be_undone() {
    let mut scene = Scene::default();
    put(&mut scene, "r", "ACCEPT", "MANUAL");
    assert_eq!(mapping_state(&scene, "made"), MappingState::Pending, "present fields wait");
    assert_eq!(apply(&mut scene, 1), 1);
    assert_eq!(mapping_state(&scene, "made"), MappingState::Mapped);
    assert_eq!(mapping_state(&scene, "note"), MappingState::Pending);
    let (writes, effects) = scene.commit(1);
    assert_eq!((effects.decisions.count, effects.decisions.rule_count), (1, 1));
    let decided = &writes.policies.rule_decisions[0];
    assert_eq!((decided.action, decided.rules[0].version), (RuleAction::Accept, 1));
    let basis = r#""rules":[{"id":"r","version":1}]"#;
    let consented = &writes.fields.consents[0].basis;
    assert!(consented.as_deref().is_some_and(|text| text.contains(basis)), "{consented:?}");
    assert_eq!(scene.offer("made", 17_u64, 2)[0]["Payload"]["made"]["Body"], "20");
    let undo = |scene: &mut Scene, ms| {
        let (id, consent) = (decided.id, decided.consent_version);
        scene.attempt(|state| {
            undo_rule_decision(state, id, &field("made"), consent, "eve", at(ms))
                .map(|changes| ((), changes))
        })
    };
    undo(&mut scene, 3).expect("undone");
    assert_eq!(mapping_state(&scene, "made"), MappingState::Pending);
    assert_eq!(apply(&mut scene, 4), 0, "the field waits for an engineer now");
    assert_eq!(undo(&mut scene, 5), Err(DecisionError::DecidedSince));
}

#[test]
fn a_rule_never_covers_a_recipient_that_it_does_not_name() {
    let mut scene = Scene::default();
    put(&mut scene, "r", "ACCEPT", "MANUAL");
    scene.arrive(network(2, |request| {
        request["recipientList"] = json!(["acme", "hull", "spy"]);
    }));
    assert_eq!(mapping_state(&scene, "made"), MappingState::Pending);
    scene.arrive(network(3, |request| request["recipientList"] = json!(["acme", "hull"])));
    assert_eq!(mapping_state(&scene, "made"), MappingState::Mapped, "decided with the revision");
    put(&mut scene, "s", "REFUSE", "MANUAL");
    scene.arrive(network(4, |request| request["purpose"] = json!("something else")));
    assert_eq!(mapping_state(&scene, "made"), MappingState::Refused, "the strictest rule holds");
}

#[test]
fn a_rule_without_a_source_of_values_only_offers() {
    let mut scene = Scene::default();
    put(&mut scene, "r", "ACCEPT", "MAPPING");
    assert_eq!(apply(&mut scene, 1), 0);
    let offer = rule_offer(&scene.state, &field("made"), at(1));
    assert_eq!(offer.map(|offer| offer.action), Some(RuleAction::Prefill));
    // The mapping that a field had is used again.
    let mapping = json!({ "mappingId": "m", "target": field("made"), "targetType": "UInt64",
        "targetUnit": "PIECE", "inputs": [], "steps": [] });
    let mapping = serde_json::from_value(mapping).expect("a mapping");
    let command = DecisionCommand::Map {
        value_source: ValueSource::Mapping,
        mapping: Some(Box::new(mapping)),
        policy: DisclosurePolicy::default(),
    };
    scene.decide("made", decision(command), 2).expect("decided");
    scene.arrive(network(2, |request| request["purpose"] = json!("something else")));
    assert_eq!(mapping_state(&scene, "made"), MappingState::Mapped);
}
