//! Transitions of a gate: another policy, another source, the end of a consent.

use std::sync::Arc;

use asi_model::{DataValue, DateTime};

use super::Gate;
use crate::{Aggregation, DisclosurePolicy, WithholdCondition, coarsening::coarsen};

impl Gate {
    /// Replaces the policy. What waited under the former one is dropped or coarsened again, and so is
    /// the value released last, which key frames repeat; intervals and rates continue.
    pub fn change_policy(&mut self, policy: Arc<DisclosurePolicy>, now: DateTime) {
        let former = std::mem::replace(&mut self.policy, policy);
        self.is_immediate = self.policy.is_immediate();
        self.not_before = None;
        let has_other_windows = former.aggregate != self.policy.aggregate;
        if has_other_windows {
            // Values that were part of an aggregate are never released individually.
            self.state.aggregation = Aggregation::default();
        }
        // Single values and those of other windows are finer than a window's, and the states that
        // came with former values are not known any more.
        if (has_other_windows && self.policy.aggregate.is_some())
            || adds_condition(&former, &self.policy)
        {
            self.drop_waiting();
            self.state.disclosed = None;
        }
        if former.withhold_while != self.policy.withhold_while {
            // Outside of all former states the value is outside of the remaining ones.
            let is_known = !self.state.is_in_withheld_state
                && own_conditions(&self.policy).all(|own| former.withhold_while.contains(own));
            if !is_known && !own_conditions(&former).eq(own_conditions(&self.policy)) {
                self.forget_own_state();
            }
            self.state.withheld_by.clear();
        }
        if coarsens_otherwise(&former, &self.policy) {
            self.coarsen_again();
        }
        self.on_time(now);
    }

    /// Closes the gate because the consent or the source ended: waiting values are dropped, and none
    /// is shown.
    pub fn close(&mut self) {
        self.drop_waiting();
        self.forget_own_state();
        self.state.disclosed = None;
        self.has_released = false;
    }

    fn drop_waiting(&mut self) {
        self.releasable = None;
        self.not_before = None;
        self.state.waiting.clear();
        self.state.aggregation = Aggregation::default();
    }

    /// Forgets the state of the field's own value. An unknown state counts as a withheld one.
    fn forget_own_state(&mut self) {
        self.state.is_in_withheld_state = own_conditions(&self.policy).next().is_some();
    }

    fn coarsen_again(&mut self) {
        let Self { policy, field_type, state, releasable, .. } = self;
        let waiting = state.waiting.iter_mut().map(|(_, value)| value);
        let releasable = releasable.iter_mut().map(|(_, value)| value);
        for value in waiting.chain(releasable).chain(&mut state.disclosed) {
            let former: DataValue = std::mem::take(value);
            *value = coarsen(policy, *field_type, former).value;
        }
    }
}

fn own_conditions(policy: &DisclosurePolicy) -> impl Iterator<Item = &WithholdCondition> {
    policy.withhold_while.iter().filter(|condition| condition.field.is_none())
}

/// Returns true where a policy withholds in states in which the former one did not.
fn adds_condition(former: &DisclosurePolicy, policy: &DisclosurePolicy) -> bool {
    policy.withhold_while.iter().any(|condition| !former.withhold_while.contains(condition))
}

/// Returns true where a policy makes another value of the same candidate.
fn coarsens_otherwise(former: &DisclosurePolicy, policy: &DisclosurePolicy) -> bool {
    let parts = |policy: &DisclosurePolicy| {
        let DisclosurePolicy {
            rounding_step, significant_digits, time_step_ms, status_codes, ..
        } = *policy;
        (rounding_step, significant_digits, time_step_ms, status_codes)
    };
    parts(former) != parts(policy) || former.bands != policy.bands
}
