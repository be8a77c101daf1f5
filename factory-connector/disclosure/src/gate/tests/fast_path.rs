//! Equality of the fast path through the gate, on which no value waits, and the general path.

use proptest::prelude::*;

use super::{
    strategies::{Step, at, other, policies, steps},
    *,
};

proptest! {
    /// Both paths have the same results and the same state.
    #[test]
    fn the_fast_path_equals_the_general_one(policy in policies(), steps in steps(900), is_clock_set_back in any::<bool>()) {
        let DisclosurePolicy { rounding_step, bands, significant_digits, .. } = policy;
        let policy = DisclosurePolicy { rounding_step, bands, significant_digits, ..Default::default() };
        let gate = || Gate::new(Arc::new(policy.clone()), BuiltInType::Int64, GateState::default(), at(0));
        let (mut short, mut long) = (gate(), Gate { is_immediate: false, ..gate() });
        let (mut now, last) = (0, steps.len() / 2);
        for (index, (pause, step)) in steps.into_iter().enumerate() {
            now += pause;
            if is_clock_set_back && index == last {
                now /= 2;
            }
            match step {
                Step::Candidate(value) => prop_assert_eq!(short.on(at(now), value.clone()), long.on(at(now), value)),
                Step::State(state) => {
                    let (one, two) = (short.on_state(at(now), &other(), state), long.on_state(at(now), &other(), state));
                    prop_assert_eq!(one, two);
                }
                Step::Wake | Step::Restart => { short.on_time(at(now)); long.on_time(at(now)); }
            }
            prop_assert_eq!(short.state(), long.state());
            prop_assert_eq!((short.due(), short.take_released()), (long.due(), long.take_released()));
        }
    }
}
