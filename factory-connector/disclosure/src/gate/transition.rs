//! Transitions of a gate: another policy, another source, the end of a consent.

use std::sync::Arc;

use asi_model::{BuiltInType, DataValue, DateTime};

use super::Gate;
use crate::{Aggregation, DisclosurePolicy, Released, WithholdCondition, coarsening::coarsen};

impl Gate {
    /// Replaces the policy. What waited under the former one is dropped or coarsened again, and so is
    /// the value released last, which key frames repeat; where the new policy lets values out later
    /// or less often, that value waits for it. Intervals and rates continue.
    pub fn change_policy(&mut self, policy: Arc<DisclosurePolicy>, now: DateTime) {
        let former = std::mem::replace(&mut self.policy, policy);
        self.is_immediate = self.policy.is_immediate();
        self.not_before = None;
        let has_other_windows = former.aggregate != self.policy.aggregate;
        if has_other_windows {
            // Values that were part of an aggregate are never released individually.
            self.state.aggregation = self.aggregation_from(now);
        }
        // Single values and those of other windows are finer than a window's, and the states that
        // came with former values are not known any more.
        if (has_other_windows && self.policy.aggregate.is_some())
            || adds_condition(&former, &self.policy)
        {
            self.drop_waiting(now);
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
        if delays_more(&former, &self.policy) {
            self.hold_disclosed_back(now);
        }
        if coarsens_otherwise(&former, &self.policy) {
            self.coarsen_again();
        }
        self.on_time(now);
    }

    /// Closes the gate because a consent or a source ended or begins: waiting values are dropped,
    /// and none is shown. A window that began before has no aggregate; intervals and rates continue.
    pub fn close(&mut self, now: DateTime) {
        self.drop_waiting(now);
        self.forget_own_state();
        self.state.disclosed = None;
        self.has_released = false;
    }

    /// Closes the gate for values of another type. Intervals and rates continue, too.
    pub fn change_type(&mut self, field_type: BuiltInType, now: DateTime) {
        self.close(now);
        self.field_type = field_type;
    }

    /// Lets the value released last wait again: the report with it may not have left, and the next
    /// one would bring it earlier than the policy allows. It counts as arrived when it was released,
    /// if not before: never too early.
    fn hold_disclosed_back(&mut self, now: DateTime) {
        let Some(disclosed) = self.state.disclosed.take() else { return };
        let waiting = &mut self.state.waiting;
        if let Some(releasable) = self.releasable.take() {
            waiting.push_front(releasable);
        }
        let released_at = self.state.last_released_at.unwrap_or(now);
        let next_at = waiting.front().map_or(released_at, |(arrived_at, _)| *arrived_at);
        waiting.push_front((released_at.min(next_at), disclosed.into_value()));
    }

    fn drop_waiting(&mut self, now: DateTime) {
        self.releasable = None;
        self.not_before = None;
        self.state.waiting.clear();
        self.state.aggregation = self.aggregation_from(now);
    }

    /// Returns an aggregation without values. Of a window that has begun it never knows all.
    fn aggregation_from(&self, now: DateTime) -> Aggregation {
        self.policy.aggregate.map(|_| Aggregation::begin(now)).unwrap_or_default()
    }

    /// Forgets the state of the field's own value. An unknown state counts as a withheld one.
    fn forget_own_state(&mut self) {
        self.state.is_in_withheld_state = own_conditions(&self.policy).next().is_some();
    }

    fn coarsen_again(&mut self) {
        let Self { policy, field_type, state, releasable, .. } = self;
        let waiting = state.waiting.iter_mut().map(|(_, value)| value);
        let releasable = releasable.iter_mut().map(|(_, value)| value);
        for value in waiting.chain(releasable) {
            let former: DataValue = std::mem::take(value);
            *value = coarsen(policy, *field_type, former).value;
        }
        let again = |old: Released| coarsen(policy, *field_type, old.into_value()).value;
        state.disclosed = state.disclosed.take().map(|old| Released::by_gate(again(old)));
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

/// Returns true where a policy lets values out later, less often or at other times than the former
/// one.
fn delays_more(former: &DisclosurePolicy, policy: &DisclosurePolicy) -> bool {
    let times = |policy: &DisclosurePolicy| DisclosurePolicy {
        minimum_interval_ms: policy.minimum_interval_ms,
        rate_limits: policy.rate_limits.clone(),
        time_step_ms: policy.time_step_ms,
        delay_ms: policy.delay_ms,
        working_hours: policy.working_hours.clone(),
        further_hours: policy.further_hours.clone(),
        ..DisclosurePolicy::default()
    };
    !times(policy).allows_all_of(&times(former))
}
