//! Standing rules beside fields alike: a partner that asks for the same in another form gets no
//! second interval, rate or window.

use std::collections::BTreeMap;

use asi_model::{
    DataValue, DateTime,
    messages::{MappingState, ValueSource},
};
use disclosure::RuleAction;
use proptest::prelude::*;

use super::{
    plant::Plant,
    requests::{Requests, Revision, any_revision},
};
use crate::{
    ConnectorState, Field, IdSource,
    queries::rule_offer,
    scene::at,
    use_cases::values::{receive_candidate, release_due},
};

const DAY_MS: i64 = 86_400_000;
const DAILY: &str = r#"{"minimumIntervalMs":86400000}"#;

/// Returns a plant with one request of one field that a rule accepted.
fn accepted(policy: &str) -> Plant {
    let mut plant = Plant::of(Requests::of_one_field());
    plant.rule(policy).expect("stored");
    plant.revise(&Revision::Purpose(0));
    assert_eq!(plant.mapping_state("a/one"), MappingState::Mapped);
    plant
}

fn last(plant: &Plant) -> String {
    format!("{}/one", plant.requests.all.last().expect("a request").id)
}

#[test]
fn a_request_beside_a_field_alike_is_left_to_the_engineer() {
    let mut plant = accepted(DAILY);
    plant.revise(&Revision::Copy(0));
    let copy = last(&plant);
    assert_eq!(plant.mapping_state(&copy), MappingState::Pending, "a second gate");
    let now = plant.now();
    let offer = rule_offer(&plant.scene.state, &plant.key(&copy), now).expect("an offer");
    assert_eq!((offer.action, offer.is_second_gate), (RuleAction::Prefill, true));
    plant.open(&copy, DAILY, None).expect("an engineer may");
}

#[test]
fn a_request_in_place_of_a_field_alike_waits_for_the_longest_period() {
    let mut plant = accepted(DAILY);
    for _ in 0..3 {
        plant.revise(&Revision::Id(0));
        assert_eq!(plant.mapping_state(&last(&plant)), MappingState::Pending, "open a moment ago");
    }
    plant.wait(DAY_MS - 60_000);
    plant.revise(&Revision::Id(0));
    assert_eq!(plant.mapping_state(&last(&plant)), MappingState::Pending);
    plant.wait(60_000);
    plant.revise(&Revision::Purpose(0));
    assert_eq!(plant.mapping_state(&last(&plant)), MappingState::Mapped, "the day is over");
}

#[test]
fn a_field_in_place_of_one_alike_waits_after_a_restart() {
    let mut plant = accepted(DAILY);
    plant.revise(&Revision::Presence(0));
    let (snapshot, ms) = (plant.snapshot(), plant.wait(1));
    let config = plant.scene.state.config().clone();
    let loaded = ConnectorState::load(config, snapshot, IdSource::new([8; 32]), false, at(ms));
    plant.scene.state = loaded.expect("it can be read").0;
    plant.revise(&Revision::Presence(0));
    assert_eq!(plant.mapping_state("a/one"), MappingState::Pending);
    plant.wait(DAY_MS);
    plant.revise(&Revision::Purpose(0));
    assert_eq!(plant.mapping_state("a/one"), MappingState::Mapped);
}

#[test]
fn rules_go_on_accepting_where_nothing_is_gained() {
    // Another partner's request; without an interval also one beside.
    let mut plant = Plant::default();
    plant.rule(DAILY).expect("stored");
    plant.revise(&Revision::Presence(1));
    plant.revise(&Revision::Presence(3));
    for name in ["a/one", "a/two", "a/three", "b/one", "b/two", "b/three"] {
        assert_eq!(plant.mapping_state(name), MappingState::Mapped, "{name}");
    }
    plant.revise(&Revision::Purpose(0));
    for name in ["a/one", "a/two", "a/three"] {
        assert_eq!(plant.mapping_state(name), MappingState::Mapped, "{name} again");
    }
    plant.revise(&Revision::Presence(1));
    plant.revise(&Revision::Presence(3));
    for name in ["a2/one", "c/one"] {
        assert_eq!(plant.mapping_state(name), MappingState::Pending, "{name}");
    }
    let mut plant = accepted(r#"{"roundingStep":10}"#);
    plant.revise(&Revision::Copy(0));
    assert_eq!(plant.mapping_state(&last(&plant)), MappingState::Mapped);
}

#[test]
fn a_field_that_reads_the_same_variable_is_alike() {
    let coarse = r#"{"minimumIntervalMs":86400000,"roundingStep":1000}"#;
    for (variable, expected) in [(1, MappingState::Pending), (2, MappingState::Mapped)] {
        let mut plant = Plant::default();
        plant.map("a/one", 1, DAILY).expect("decided");
        plant.map("a2/two", variable, coarse).expect("decided");
        plant.rule_of("MAPPING", DAILY).expect("stored");
        plant.revise(&Revision::Purpose(1));
        assert_eq!(plant.mapping_state("a2/two"), expected, "with the variable {variable}");
    }
}

/// Offers a value to every open field, and returns the numbers of the fields of which acme got one,
/// each with the time of its window, or the present one without a window.
fn offer(plant: &mut Plant, number: u64, is_window: bool) -> Vec<(i64, DateTime)> {
    let now = at(plant.wait(0));
    release_due(&mut plant.scene.state, now);
    let mapped = plant.scene.state.fields().iter().filter(|field| field.decision().is_mapped());
    let mut ids: Vec<i64> = mapped.map(Field::id).collect();
    ids.sort_unstable();
    for id in ids {
        let value = DataValue::good(number, now);
        receive_candidate(&mut plant.scene.state, id, ValueSource::Manual, value, None, now);
    }
    let ms = plant.wait(0);
    let (_, effects) = plant.scene.commit(ms);
    let state = &plant.scene.state;
    let of_acme = effects.values.iter().filter(|(key, _)| {
        let recipients = state.networks().recipients(&key.request);
        recipients.iter().any(|recipient| recipient.as_str() == "acme")
    });
    let time = |key| {
        let field = state.field(key).expect("a field");
        let window = field.gate().disclosed().and_then(|value| value.source_timestamp);
        (field.id(), if is_window { window.expect("a window") } else { now })
    };
    of_acme.map(|(key, _)| time(key)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// A partner that plans as cleverly as it likes: of one request, whatever becomes of it and of
    /// its copies, it gets no more values than the policy of the rule allows for one field.
    #[test]
    fn no_revisions_beat_interval_rate_or_window(
        steps in prop::collection::vec((prop::option::of(any_revision()), 1..3_000_000_i64), 10..80),
        kind in 0..3_usize,
    ) {
        let hour = 3_600_000;
        let policy = [
            r#"{"minimumIntervalMs":3600000}"#,
            r#"{"rateLimits":[{"values":1,"periodMs":3600000}]}"#,
            r#"{"aggregate":{"function":"MEAN","windowMs":3600000}}"#,
        ][kind];
        let is_window = kind == 2;
        let mut plant = accepted(policy);
        let ms = plant.wait(0);
        plant.scene.commit(ms);
        let mut begun: BTreeMap<i64, DateTime> = BTreeMap::new();
        let mut got: Vec<DateTime> = Vec::new();
        for (number, (revision, pause)) in (1..).zip(steps) {
            if let Some(revision) = &revision {
                plant.revise(revision);
            }
            let now = at(plant.wait(0));
            for field in plant.scene.state.fields().iter() {
                begun.insert(field.id(), field.decision().decided_at.unwrap_or(now));
            }
            for (field, time) in offer(&mut plant, number, is_window) {
                let former = got.iter().filter(|former| **former != time).max();
                prop_assert!(
                    former.is_none_or(|former| time.since(*former).as_millis() >= 3_600_000),
                    "{time:?} after {former:?}"
                );
                prop_assert!(
                    !is_window || begun[&field] <= time,
                    "a part of the window of {time:?}"
                );
                got.push(time);
            }
            plant.wait(pause % (2 * hour));
        }
    }
}
