//! Caps and alliances: what they refuse, what they hold back, and that nothing gets past them.

mod hours;
mod plant;
mod properties;
mod requests;
mod second_gates;

use asi_model::messages::MappingState;
use serde_json::json;

use crate::{
    ConnectorState, DocumentError,
    load::UnreadableState,
    queries::{cap_preview, fields_held_back, open_fields},
    scene::at,
    tests::caps::plant::{Plant, hourly, id, variable},
    use_cases::decide::DecisionError,
};

/// Returns the bits per hour that a partner gets, as its budget states them.
fn bits_of(plant: &Plant, partner: &str) -> f64 {
    let open = open_fields(&plant.scene.state, at(0), None);
    let found = open.iter().find(|(known, _)| known.as_str() == partner);
    let fields = found.map(|(_, fields)| &fields[..]).unwrap_or_default();
    disclosure::leak_budget(fields).bits_per_hour_max.expect("bounded")
}

fn excess_of(error: DocumentError) -> disclosure::CapExcess {
    let DocumentError::OverCap(mut excesses) = error else { panic!("{error:?}") };
    excesses.remove(0)
}

#[test]
fn a_consent_above_a_cap_is_refused_with_the_figures() {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    let one = bits_of(&plant, "acme");
    plant.cap("acme", json!({ "partner": "acme" }), 1.5 * one, None).expect("stored");
    let refused = plant.open("a/two", &hourly(8), None).expect_err("two are too much");
    let DecisionError::OverCap(excesses) = &refused else { panic!("{refused:?}") };
    let [excess] = &excesses[..] else { panic!("{excesses:?}") };
    assert_eq!(excess.bits_per_hour_now, Some(one));
    assert!(excess.bits_per_hour_then.is_some_and(|then| (then - 2.0 * one).abs() < 1e-9));
    assert!(refused.to_string().contains("raise the cap"), "{refused}");
    assert_eq!(plant.mapping_state("a/two"), MappingState::Pending);
    assert_eq!(plant.open("a/two", "{}", None).expect_err("no bound"), {
        let DecisionError::OverCap(mut excesses) = refused else { unreachable!() };
        excesses[0].bits_per_hour_then = None;
        DecisionError::OverCap(excesses)
    });
    plant.open("a/one", &hourly(4), None).expect("less than before");
    plant.open("b/one", &hourly(8), None).expect("another partner's request");
}

#[test]
fn a_looser_policy_above_a_cap_is_refused_and_changes_nothing() {
    let mut plant = Plant::default();
    plant.policy("p", &hourly(2)).expect("stored");
    plant.open("a/one", r#"{"minimumIntervalMs":1000}"#, Some("p")).expect("no cap yet");
    let bits = bits_of(&plant, "acme");
    plant.cap("acme", json!({ "partner": "acme" }), bits, None).expect("stored");
    let excess = excess_of(plant.policy("p", &hourly(8)).expect_err("looser"));
    assert_eq!(excess.bits_per_hour_now, Some(bits));
    let version = plant.policy("p", &hourly(1)).expect("stricter");
    assert_eq!(version, 2, "the refused version was not stored");
    assert!(bits_of(&plant, "acme") < bits);

    plant.open("a/two", r#"{"minimumIntervalMs":1000}"#, None).expect_err("without the policy");
    plant.set_policy("acme", Some("p")).expect("set");
    plant.cap("acme", json!({ "partner": "acme" }), 2.0 * bits, None).expect("raised");
    plant.open("a/two", r#"{"minimumIntervalMs":1000}"#, None).expect("with the policy of acme");
    excess_of(plant.set_policy("acme", None).expect_err("without the policy of acme"));
    let version = plant.set_policy("acme", Some("p")).expect("the same");
    assert_eq!(version, 2, "the refused setting was not stored");
}

#[test]
fn an_alliance_is_counted_together_and_refused_above_a_cap() {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    plant.open("b/one", &hourly(8), None).expect("no cap yet");
    let one = bits_of(&plant, "acme");
    plant.cap("acme", json!({ "partner": "acme" }), 1.5 * one, None).expect("stored");
    let excess = excess_of(plant.alliance("g", &["acme", "hull"], false).expect_err("too much"));
    assert_eq!(excess.bits_per_hour_now, Some(one));
    assert_eq!(plant.scene.state.budgets().alliances().count(), 0);
    plant.alliance("g", &["acme", "keel"], false).expect("keel gets nothing");
    plant.open("c/one", &hourly(8), None).expect_err("keel would tell acme");

    let other = plant.alliance("h", &["keel", "hull"], false).expect_err("in two alliances");
    let DocumentError::Faults(faults) = other else { panic!("{other:?}") };
    assert_eq!(faults[0].pointer, "/memberList/1");
    plant.cap("g", json!({ "allianceId": "g" }), 2.0 * one, None).expect("stored");
    let retired = plant.alliance("g", &["acme", "keel"], true).expect_err("a cap is about it");
    let DocumentError::Faults(faults) = retired else { panic!("{retired:?}") };
    assert_eq!(faults[0].pointer, "/isRetired");
    let unknown = plant.cap("x", json!({ "allianceId": "none" }), 1.0, None).expect_err("unknown");
    assert!(matches!(unknown, DocumentError::Faults(_)), "{unknown:?}");
}

#[test]
fn a_cap_below_the_present_use_holds_the_newest_consents_back() {
    let mut plant = Plant::default();
    for name in ["a/one", "a/two", "b/one"] {
        plant.open(name, &hourly(8), None).expect("no cap yet");
    }
    plant.scene.commit(0);
    let one = bits_of(&plant, "hull");
    let draft = plant.draft(json!({ "partner": "acme" }), 1.5 * one, None);
    let preview = cap_preview(&plant.scene.state, &id("acme"), draft, at(9)).expect("no fault");
    assert_eq!(preview.len(), 1, "nothing is changed by a preview");
    let held = plant.cap("acme", json!({ "partner": "acme" }), 1.5 * one, None).expect("stored");
    assert_eq!(held, [plant.key("a/two")], "the newest consent to acme");
    assert_eq!(fields_held_back(&plant.scene.state)[&id("acme")], held);

    let field = plant.scene.state.field(&held[0]).expect("a field");
    let decision = field.decision();
    assert_eq!((decision.mapping_state, decision.value_source), (MappingState::Pending, None));
    assert!(!field.is_undecided(), "standing rules leave it alone");
    assert!(decision.mapping.is_some(), "its mapping is suggested again");
    let (writes, effects) = plant.scene.commit(10);
    let [consent] = &writes.fields.consents[..] else { panic!("{:?}", writes.fields.consents) };
    let caps = r#""caps":[{"id":"acme","version":1}]"#;
    assert!(consent.basis.as_deref().is_some_and(|text| text.contains(caps)), "{consent:?}");
    assert_eq!(consent.decided_by.as_deref(), Some("eve"));
    let mut entries = writes.ledger.entries.iter();
    assert!(
        entries.all(|(entry, _)| !entry.content.contains("caps")),
        "partners read their chains"
    );
    let pending = writes.controls.queued.iter().filter(|control| control.body.contains("PENDING"));
    let pending: Vec<_> = pending.collect();
    assert!(
        pending.len() == 1 && pending[0].body.contains("limits how much it discloses"),
        "{pending:?}"
    );
    assert_eq!(writes.ledger.revocations.len(), 1, "the partner gets a receipt");
    assert_eq!(writes.policies.caps.len(), 1);
    assert!(effects.engine.len() == 1 && !effects.log.is_empty());

    let refused = plant.open("a/two", &hourly(8), None).expect_err("it is still too much");
    assert!(matches!(refused, DecisionError::OverCap(_)));
    plant.open("a/two", &hourly(1), None).expect("coarser");
    assert!(fields_held_back(&plant.scene.state).is_empty());
}

#[test]
fn a_field_without_a_bound_is_held_back_before_newer_ones_that_have_one() {
    let mut plant = Plant::default();
    plant.open("a/one", "{}", None).expect("no cap yet");
    plant.open("a/two", &hourly(1), None).expect("no cap yet");
    let held = plant.cap("acme", json!({ "partner": "acme" }), 1e9, None).expect("stored");
    assert_eq!(held, [plant.key("a/one")]);
}

#[test]
fn a_cap_of_a_variable_counts_all_requests_and_refuses_mappings_to_it() {
    let mut plant = Plant::default();
    plant.map("a/one", 1, &hourly(8)).expect("no cap yet");
    let one = bits_of(&plant, "acme");
    plant.cap("v", json!({ "partner": "acme" }), 1.5 * one, Some(variable(1))).expect("stored");
    plant.map("a2/one", 2, &hourly(8)).expect("another variable");
    let refused = plant.map("a/two", 1, &hourly(8)).expect_err("the same variable");
    assert!(matches!(refused, DecisionError::OverCap(_)));
    let excesses = plant.import("a2/one", 1).expect_err("the same variable by an import");
    assert_eq!(excesses[0].variable, Some(variable(1)));
    plant.import("a2/one", 3).expect("yet another variable");
    plant.map("b/one", 1, &hourly(8)).expect("another partner");
}

#[test]
fn a_state_that_withholds_rests_on_its_variable_too() {
    let mut plant = Plant::default();
    plant.map("a/one", 1, &hourly(8)).expect("no cap yet");
    let one = bits_of(&plant, "acme");
    plant.cap("v", json!({ "partner": "acme" }), 1.5 * one, Some(variable(1))).expect("stored");
    let mut policy: serde_json::Value = serde_json::from_str(&hourly(8)).expect("JSON");
    policy["withholdWhile"] = json!([{ "field": "one", "states": [0] }]);
    plant.map("a/two", 2, &policy.to_string()).expect_err("it tells when `one` is zero");
    plant.map("a/one", 3, &hourly(8)).expect("now `one` rests on another variable");
    plant.map("a/two", 2, &policy.to_string()).expect("nothing else rests on the first one");
    plant.map("a/three", 1, &hourly(4)).expect("half of it");
    plant.map("a/one", 1, &hourly(1)).expect_err("`two` would rest on it, too");
}

#[test]
fn caps_hold_after_a_restart() -> Result<(), UnreadableState> {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    let one = bits_of(&plant, "acme");
    plant.cap("acme", json!({ "partner": "acme" }), one, None).expect("stored");
    let mut snapshot = plant.snapshot();
    snapshot.budgets.caps[0].document.bits_per_hour_max = one / 2.0;
    let config = plant.scene.state.config().clone();
    let ids = crate::IdSource::new([8; 32]);
    let (state, changes) = ConnectorState::load(config, snapshot, ids, false, at(60))?;
    let field = state.field(&plant.key("a/one")).expect("a field");
    assert_eq!(field.decision().mapping_state, MappingState::Pending);
    assert_eq!(changes.writes.fields.consents.len(), 1, "it is a decision like any other");
    Ok(())
}
