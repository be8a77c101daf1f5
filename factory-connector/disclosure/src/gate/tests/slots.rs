//! Times of releases: a machine that ends a state whenever it likes chooses among the slots that the leak
//! budget counts, and no instant between two of them.

use proptest::prelude::*;

use super::{
    properties,
    strategies::{self, Step, other, policies, steps},
    *,
};
use crate::time_resolution_ms;

/// Returns the times of all releases, of a gate whose state is known from the beginning and that never restarts.
fn released(policy: &DisclosurePolicy, steps: &[(u64, Step)]) -> Vec<DateTime> {
    let steps = steps.iter().filter(|(_, step)| !matches!(step, Step::Restart)).cloned();
    let steps: Vec<_> = std::iter::once((0, Step::State(Some(false)))).chain(steps).collect();
    let left = properties::run(policy, &steps, false);
    left.into_iter().map(|(ms, _)| strategies::at(ms)).collect()
}

proptest! {
    #[test]
    fn every_release_is_in_a_slot_that_the_budget_counts(policy in policies(), steps in steps(3_000)) {
        let policy = DisclosurePolicy { working_hours: None, ..policy };
        let (step, delay) = (policy.time_step(), policy.delay());
        let window = policy.aggregate.map(|aggregate| aggregate.window()).unwrap_or_default();
        let releases = released(&policy, &steps);
        for at in &releases {
            prop_assert_eq!(at.floor_to(step), *at, "on the time step");
            if !window.is_zero() {
                // The end of a window, later by the delay, and up to the next time step.
                let since_start = Duration::from_millis(u64::try_from(at.unix_millis()).expect("later"));
                let behind = (since_start - delay).as_millis() % window.as_millis();
                prop_assert!(behind < step.as_millis().max(1), "{behind} ms behind the end of a window");
            }
        }
        let resolution = Duration::from_millis(time_resolution_ms(&policy));
        // Each slot has one release: of two windows that end within one time step the last one.
        for two in releases.windows(2) {
            let apart = two[1].since(two[0]);
            prop_assert!(apart + step.min(window) >= resolution, "{apart:?} apart");
        }
    }
}

#[test]
fn what_a_state_withheld_waits_for_the_next_slot() {
    let window = r#"{"aggregate":{"function":"MAXIMUM","windowMs":60000},"withholdWhile":[{"field":"state","states":[1]}]}"#;
    let step = r#"{"timeStepMs":60000,"withholdWhile":[{"field":"state","states":[1]}]}"#;
    for policy in [window, step] {
        let mut gate = gate(policy);
        gate.on_state(at(0), &other(), Some(false));
        let begun = at(0).floor_to(Duration::from_secs(60));
        gate.on(begun.after(Duration::from_secs(70)), candidate(0, 1));
        let ends = begun.after(Duration::from_secs(120));
        gate.on_state(begun.after(Duration::from_secs(80)), &other(), Some(true));
        gate.on_time(ends);
        assert!(!gate.take_released(), "{policy}");
        // Ended shortly after the slot, when a timer may still be late.
        gate.on_state(ends.after(Duration::from_millis(1_234)), &other(), Some(false));
        assert!(
            !gate.take_released(),
            "{policy}: the time of a release tells when the state ended"
        );
        gate.on_time(begun.after(Duration::from_secs(180)));
        assert!(gate.take_released(), "{policy}");
    }
}
