//! Caps under any sequence of decisions, settings and revisions, and under any behaviour of a machine.

use std::collections::{BTreeMap, BTreeSet};

use asi_model::{DataValue, FieldKey, messages::ValueSource};
use disclosure::{CapSubject, DisclosurePolicy, bits_per_hour, values_per_hour_max};
use proptest::prelude::*;
use serde_json::json;

use super::{
    plant::{Plant, hourly, variable},
    requests::{FIELDS, PARTNERS, Revision, any_revision},
};
use crate::{
    Field,
    queries::variables_of,
    scene::at,
    use_cases::{
        decide::DecisionCommand,
        values::{receive_candidate, release_due},
    },
};

/// Length of a run of values, in hours.
const HOURS: i64 = 3;

/// Act of an engineer or of a partner's planner.
#[derive(Debug, Clone)]
pub enum Act {
    Decide { field: usize, policy: usize, is_named: bool, variable: u32 },
    Close(usize),
    Import { field: usize, variable: u32 },
    Policy(usize),
    Recipient { partner: usize, is_set: bool },
    Alliance { without: usize, is_retired: bool },
    Cap { subject: usize, most: f64, variable: Option<u32> },
    Revise(Revision),
    Rule { policy: usize, is_mapping: bool },
    Wait(i64),
}

fn policies() -> Vec<String> {
    let withheld = json!({ "rateLimits": [{ "values": 2, "periodMs": 3_600_000 }],
        "withholdWhile": [{ "field": "one", "states": [0] }] });
    let stepped = json!({ "timeStepMs": 600_000, "significantDigits": 2 });
    let window = json!({ "aggregate": { "function": "LAST", "windowMs": 1_800_000 } });
    let open = "{}".to_owned();
    vec![hourly(1), hourly(6), withheld.to_string(), stepped.to_string(), window.to_string(), open]
}

/// Returns the name of a field by its number, where it is requested.
fn name(plant: &Plant, field: usize) -> Option<String> {
    let requests = &plant.requests.all;
    let request = &requests[field / FIELDS.len() % requests.len()];
    let name = format!("{}/{}", request.id, FIELDS[field % FIELDS.len()]);
    plant.scene.state.field(&plant.key(&name)).map(|_| name)
}

pub fn any_act() -> impl Strategy<Value = Act> {
    let field = || 0..4 * FIELDS.len();
    let policy = || 0..policies().len();
    prop_oneof![
        6 => (field(), policy(), any::<bool>(), 1..4_u32).prop_map(
            |(field, policy, is_named, variable)| Act::Decide { field, policy, is_named, variable }
        ),
        1 => field().prop_map(Act::Close),
        2 => (field(), 1..4_u32).prop_map(|(field, variable)| Act::Import { field, variable }),
        2 => policy().prop_map(Act::Policy),
        2 => (0..3_usize, any::<bool>())
            .prop_map(|(partner, is_set)| Act::Recipient { partner, is_set }),
        2 => (0..3_usize, any::<bool>())
            .prop_map(|(without, is_retired)| Act::Alliance { without, is_retired }),
        3 => (0..4_usize, 0.0..3000.0_f64, prop::option::of(1..4_u32))
            .prop_map(|(subject, most, variable)| Act::Cap { subject, most, variable }),
        6 => any_revision().prop_map(Act::Revise),
        1 => (policy(), any::<bool>())
            .prop_map(|(policy, is_mapping)| Act::Rule { policy, is_mapping }),
        2 => (1..4_000_000_i64).prop_map(Act::Wait),
    ]
}

/// Does it; what is refused changes nothing.
pub fn act(plant: &mut Plant, act: Act) {
    let policies = policies();
    match act {
        Act::Decide { field, policy, is_named, variable } => {
            let (named, field) = (is_named.then_some("p"), name(plant, field));
            field.map(|field| plant.decide(&field, &policies[policy], named, variable));
        }
        Act::Close(field) => {
            let field = name(plant, field);
            field.map(|field| plant.command(&field, DecisionCommand::LeavePending, None));
        }
        Act::Import { field, variable } => {
            name(plant, field).map(|field| plant.import(&field, variable));
        }
        Act::Policy(policy) => {
            plant.policy("p", &policies[policy]).ok();
        }
        Act::Recipient { partner, is_set } => {
            plant.set_policy(PARTNERS[partner], is_set.then_some("p")).ok();
        }
        Act::Alliance { without, is_retired } => {
            let others = PARTNERS.iter().enumerate().filter(|(index, _)| *index != without);
            let members: Vec<&str> = others.map(|(_, partner)| *partner).collect();
            plant.alliance("g", &members, is_retired).ok();
        }
        Act::Cap { subject, most, variable: number } => {
            let name = format!("{subject}-{}", number.unwrap_or_default());
            let subject = PARTNERS.get(subject).map_or_else(
                || json!({ "allianceId": "g" }),
                |partner| json!({ "partner": partner }),
            );
            plant.cap(&name, subject, most, number.map(variable)).ok();
        }
        Act::Revise(revision) => plant.revise(&revision),
        Act::Rule { policy, is_mapping } => {
            let source = if is_mapping { "MAPPING" } else { "MANUAL" };
            plant.rule_of(source, &policies[policy]).ok();
        }
        Act::Wait(ms) => drop(plant.wait(ms)),
    }
}

fn inputs(field: &Field) -> BTreeSet<disclosure::VariableKey> {
    let mapping = field.decision().mapping.as_deref();
    let mapping = mapping.filter(|_| field.decision().is_open_for(ValueSource::Mapping));
    mapping.map(|mapping| variables_of(&mapping.inputs)).unwrap_or_default()
}

/// Returns the variables behind a field: the inputs of its mapping, and those of the fields whose states
/// withhold it.
fn variables_behind(plant: &Plant, field: &Field) -> BTreeSet<disclosure::VariableKey> {
    let mut variables = inputs(field);
    for condition in &field.gate().policy().withhold_while {
        let watched = condition.field.clone().map(|name| field.key().request.field(name));
        let watched = watched.and_then(|key| plant.scene.state.field(&key));
        variables.extend(watched.map(inputs).unwrap_or_default());
    }
    variables
}

/// Returns the bits per hour under each cap in force, with the cap, by going through all fields.
fn naive_sums(plant: &Plant) -> Vec<(f64, Option<f64>)> {
    let state = &plant.scene.state;
    let alliance = |id: Option<&str>, partner: Option<&str>| -> BTreeSet<String> {
        let found = state.budgets().alliances().find(|alliance| {
            let members = &alliance.document.member_list;
            !alliance.document.is_retired
                && id.is_none_or(|id| alliance.key.id.as_str() == id)
                && partner.is_none_or(|own| members.iter().any(|other| other.as_str() == own))
        });
        let members = found.into_iter().flat_map(|alliance| &alliance.document.member_list);
        members.map(ToString::to_string).chain(partner.map(str::to_owned)).collect()
    };
    let caps = state.budgets().caps().filter(|cap| !cap.document.is_retired);
    let sum = |cap: &disclosure::Cap| {
        let readers = match &cap.subject {
            CapSubject::Partner(partner) => alliance(None, Some(partner.as_str())),
            CapSubject::AllianceId(id) => alliance(Some(id.as_str()), None),
        };
        let mapped = state.fields().iter().filter(|field| field.decision().is_mapped());
        let covered = mapped.filter(|field| {
            let recipients = state.networks().recipients(&field.key().request);
            let variables = variables_behind(plant, field);
            recipients.iter().any(|recipient| readers.contains(recipient.as_str()))
                && cap.variable.as_ref().is_none_or(|own| variables.contains(own))
        });
        covered.map(|field| bits_per_hour(field.definition(), field.gate().policy())).sum()
    };
    caps.map(|cap| (cap.document.bits_per_hour_max, sum(&cap.document))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn no_sequence_of_decisions_gets_past_a_cap(acts in prop::collection::vec(any_act(), 1..60)) {
        let mut plant = Plant::default();
        plant.policy("p", &hourly(2)).expect("stored");
        for one in acts {
            act(&mut plant, one.clone());
            for (most, sum) in naive_sums(&plant) {
                prop_assert!(
                    sum.is_some_and(|sum| sum <= most * (1.0 + 1e-6) + 1e-3),
                    "{sum:?} above {most} after {one:?}"
                );
            }
        }
    }

    /// A machine that wants to tell as much as it can: any number of values at any times. What is
    /// released in some hours is within what the caps allow in them, but for the one value of each
    /// field at their end.
    #[test]
    fn nothing_that_a_machine_does_gets_past_a_cap(
        acts in prop::collection::vec(any_act(), 1..40),
        pauses in prop::collection::vec(prop_oneof![1..50_i64, 1..400_000_i64], 40..200),
    ) {
        let mut plant = Plant::default();
        plant.policy("p", &hourly(2)).expect("stored");
        acts.into_iter().for_each(|one| act(&mut plant, one));
        plant.scene.commit(0);
        let released = run(&mut plant, &pauses);
        let state = &plant.scene.state;
        let bits_each = |key: &FieldKey| {
            let field = state.field(key).expect("a field");
            let policy: &DisclosurePolicy = field.gate().policy();
            let values = values_per_hour_max(policy).filter(|values| *values > 0.0)?;
            bits_per_hour(field.definition(), policy).map(|bits| bits / values)
        };
        for cap in state.budgets().caps_in_force() {
            let document = &cap.cap.document;
            let is_counted = |key: &&FieldKey| {
                let recipients = state.networks().recipients(&key.request);
                let variables = variables_behind(&plant, state.field(key).expect("a field"));
                recipients.iter().any(|recipient| cap.readers.contains(recipient))
                    && document.variable.as_ref().is_none_or(|own| variables.contains(own))
            };
            let keys = || released.keys().filter(is_counted);
            let disclosed: f64 = keys().map(|key| f64::from(released[key]) * bits_each(key).expect("bounded")).sum();
            let ends: f64 = keys().map(|key| bits_each(key).expect("bounded")).sum();
            let hours = f64::from(i32::try_from(HOURS).expect("few"));
            let most = document.bits_per_hour_max * hours + ends;
            prop_assert!(disclosed <= most * (1.0 + 1e-6) + 1e-3, "{disclosed} above {most}");
        }
    }
}

/// Offers a value to every field after each pause, again and again, and returns the number of
/// values that left.
fn run(plant: &mut Plant, pauses: &[i64]) -> BTreeMap<FieldKey, u32> {
    let mut released: BTreeMap<FieldKey, u32> = BTreeMap::new();
    let begin = plant.wait(0);
    let mapped = plant.scene.state.fields().iter().filter(|field| field.decision().is_mapped());
    let ids: Vec<i64> = mapped.map(Field::id).collect();
    for (number, pause) in (1_u64..).zip(pauses.iter().cycle()) {
        let ms = plant.wait(*pause);
        if ms > begin + HOURS * 3_600_000 || number > 3000 {
            return released;
        }
        release_due(&mut plant.scene.state, at(ms));
        for id in &ids {
            let value = DataValue::good(number, at(ms));
            receive_candidate(
                &mut plant.scene.state,
                *id,
                ValueSource::Mapping,
                value,
                None,
                at(ms),
            );
        }
        let (_, effects) = plant.scene.commit(ms);
        for (key, _) in effects.values {
            *released.entry(key).or_default() += 1;
        }
    }
    released
}
