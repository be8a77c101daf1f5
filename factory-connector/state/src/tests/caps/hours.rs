//! Caps over the hour: what ended counts on, whatever partners change from revision to revision.

use std::collections::{BTreeMap, BTreeSet};

use asi_model::{DateTime, OrganisationId, messages::MappingState};
use disclosure::{CapInForce, VariableKey, bits_per_hour};
use proptest::prelude::*;
use serde_json::json;

use super::{
    plant::{Plant, hourly, variable},
    properties::{Act, act, any_act},
    requests::Revision,
};
use crate::{
    ConnectorState, IdSource, Snapshot,
    queries::{use_of, variables_of},
    scene::at,
    use_cases::decide::{DecisionCommand, DecisionError},
};

const HOUR_MS: i64 = 3_600_000;

#[test]
fn a_request_that_is_replaced_makes_no_room_under_a_cap_for_an_hour() {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    let bits = plant.bits_per_hour("a/one");
    plant.cap("acme", json!({ "partner": "acme" }), 1.5 * bits, None).expect("stored");
    plant.revise(&Revision::Id(0));
    let again = format!("{}/one", plant.requests.all[0].id);
    plant.open("a2/one", &hourly(8), None).expect_err("within the hour");
    plant.open(&again, &hourly(8), None).expect_err("another field, with a gate of its own");
    plant.open(&again, &hourly(2), None).expect("beside what was disclosed");
    plant.wait(HOUR_MS);
    plant.open(&again, &hourly(8), None).expect("an hour later");
}

#[test]
fn a_consent_that_is_given_again_finds_the_room_that_it_had() {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    let bits = plant.bits_per_hour("a/one");
    plant.cap("acme", json!({ "partner": "acme" }), bits, None).expect("stored");
    plant.rule_of("MAPPING", &hourly(8)).expect("stored");
    plant.revise(&Revision::Purpose(0));
    assert_eq!(plant.mapping_state("a/one"), MappingState::Mapped, "the same gate goes on");
    plant.command("a/one", DecisionCommand::LeavePending, None).expect("closed");
    let finer = plant.open("a/one", &hourly(9), None).expect_err("above the cap");
    assert!(matches!(finer, DecisionError::OverCap(_)));
    plant.open("a/one", &hourly(8), None).expect("as before");
}

#[test]
fn what_ended_counts_on_after_a_restart() {
    let mut plant = Plant::default();
    plant.open("a/one", &hourly(8), None).expect("no cap yet");
    let bits = plant.bits_per_hour("a/one");
    plant.cap("acme", json!({ "partner": "acme" }), 1.5 * bits, None).expect("stored");
    plant.revise(&Revision::Id(0));
    let (snapshot, ms): (Snapshot, i64) = (plant.snapshot(), plant.wait(1));
    assert_eq!(snapshot.former_disclosures.len(), 1);
    let config = plant.scene.state.config().clone();
    let loaded = ConnectorState::load(config, snapshot, IdSource::new([8; 32]), false, at(ms));
    plant.scene.state = loaded.expect("it can be read").0;
    plant.open("a2/one", &hourly(8), None).expect_err("within the hour");
    plant.wait(HOUR_MS);
    plant.open("a2/one", &hourly(8), None).expect("an hour later");
    let now = plant.now();
    assert_eq!(plant.scene.state.former.uses_of_last_hour(now).count(), 0);
}

/// Information of a field that was disclosed, kept beside the state.
#[derive(Debug, Clone, PartialEq)]
struct Disclosed {
    bits: Option<f64>,
    readers: Vec<OrganisationId>,
    variables: BTreeSet<VariableKey>,
}

/// Returns what is disclosed, by the number of the field.
fn open_now(plant: &Plant) -> BTreeMap<i64, Disclosed> {
    let state = &plant.scene.state;
    let open = |field: &crate::Field| {
        let used = use_of(state, field)?;
        let bits = bits_per_hour(field.definition(), field.gate().policy());
        Some((field.id(), Disclosed { bits, readers: used.readers, variables: used.variables }))
    };
    state.fields().iter().filter_map(open).collect()
}

/// Returns the bits of one field under a cap: of what it disclosed within the hour the most at once.
fn bits_of_field<'t>(cap: &CapInForce, open: impl Iterator<Item = &'t Disclosed>) -> Option<f64> {
    let covered = open.filter(|open| {
        let variable = cap.cap.document.variable.as_ref();
        open.readers.iter().any(|reader| cap.readers.contains(reader))
            && variable.is_none_or(|own| open.variables.contains(own))
    });
    covered.map(|open| open.bits).try_fold(0.0, |most: f64, bits| Some(most.max(bits?)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    /// Consents that end and begin, by whomever: what is disclosed together with what ended within
    /// the hour, since the cap was set, stays within the cap.
    #[test]
    fn no_sequence_of_revisions_gets_past_a_cap_within_an_hour(
        acts in prop::collection::vec(any_act(), 1..60),
    ) {
        let mut plant = Plant::default();
        plant.policy("p", &hourly(2)).expect("stored");
        let mut ended: Vec<(DateTime, i64, Disclosed)> = Vec::new();
        for one in acts {
            let before = open_now(&plant);
            let is_in_place = matches!(
                one,
                Act::Decide { .. } | Act::Import { .. } | Act::Policy(_) | Act::Recipient { .. }
            );
            act(&mut plant, one.clone());
            let now = at(plant.wait(0));
            let after = open_now(&plant);
            for (id, open) in before {
                // What a person changes in place does not end.
                if after.get(&id).is_none_or(|present| !is_in_place && *present != open) {
                    ended.push((now, id, open));
                }
            }
            for cap in plant.scene.state.budgets().caps_in_force() {
                let recent = |at: &DateTime| {
                    *at > cap.cap.changed_at && now.since(*at).as_millis() < 3_600_000
                };
                let recent: Vec<_> = ended.iter().filter(|(at, ..)| recent(at)).collect();
                let ids = recent.iter().map(|(_, id, _)| *id).chain(after.keys().copied());
                let ids: BTreeSet<i64> = ids.collect();
                let sum: Option<f64> = ids.into_iter().map(|id| {
                    let former = recent.iter().filter(|(_, other, _)| *other == id);
                    bits_of_field(&cap, former.map(|(.., open)| open).chain(after.get(&id)))
                }).sum();
                let most = cap.cap.document.bits_per_hour_max;
                prop_assert!(
                    sum.is_some_and(|sum| sum <= most * (1.0 + 1e-6) + 1e-3),
                    "{sum:?} above {most} after {one:?}"
                );
            }
        }
    }
}

#[test]
fn a_variable_that_a_withheld_field_rested_on_counts_on() {
    let mut plant = Plant::default();
    plant.map("a/one", 1, &hourly(8)).expect("no cap yet");
    let mut policy: serde_json::Value = serde_json::from_str(&hourly(8)).expect("JSON");
    policy["withholdWhile"] = json!([{ "field": "one", "states": [0] }]);
    plant.map("a/two", 2, &policy.to_string()).expect("no cap yet");
    let bits = plant.bits_per_hour("a/one") + plant.bits_per_hour("a/two");
    plant.cap("v", json!({ "partner": "acme" }), bits, Some(variable(1))).expect("stored");
    let one = plant.scene.state.field(&plant.key("a/one")).expect("a field");
    let mapping = one.decision().mapping.as_deref().expect("a mapping");
    assert_eq!(variables_of(&mapping.inputs), [variable(1)].into());
    plant.revise(&Revision::Field { request: 0, field: 0 });
    plant.map("a2/one", 1, &hourly(8)).expect_err("both told about it within the hour");
    plant.wait(HOUR_MS);
    plant.map("a2/one", 1, &hourly(8)).expect("an hour later");
}
