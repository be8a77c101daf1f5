//! Gate of one field: a state machine over candidates and time.

mod document;
mod gate_state;
mod stored_value;
mod transition;

use std::{sync::Arc, time::Duration};

use asi_model::{BuiltInType, DataValue, DateTime, FieldName};
pub use document::{gate_from_json, gate_to_json};
pub use gate_state::GateState;

use super::{
    AggregateFunction, DisclosurePolicy, Released,
    coarsening::{Coarsened, coarsen},
    rate,
};

/// Most values that wait for their delay. Within this fraction of the delay the latest replaces the
/// one before it.
const DELAYED_MAX: u32 = 256;

/// Result of a candidate at the gate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateOutcome {
    /// Released now; `is_coarsened` when the released value is less precise than the candidate.
    Disclosed { is_coarsened: bool },
    /// Equal to the value released before; `is_coarsened` as above.
    Unchanged { is_coarsened: bool },
    /// Waiting, at least until this time; a newer candidate may replace it.
    Withheld { until: DateTime },
    /// Never released: the policy withholds candidates in the present state.
    Suppressed,
}

/// Decides which of a field's candidates are released, and at which time.
///
/// `now` must never decrease for one gate; [`Gate::new`] corrects a state from a clock that was set
/// back.
///
/// There is one gate of a field, and no second one is made of it, which could get another policy:
///
/// ```compile_fail,E0308
/// fn second(gate: &disclosure::Gate) -> disclosure::Gate {
///     gate.clone()
/// }
/// ```
#[derive(Debug)]
pub struct Gate {
    policy: Arc<DisclosurePolicy>,
    /// True when the policy only coarsens values, so that every candidate is released at once.
    is_immediate: bool,
    field_type: BuiltInType,
    state: GateState,
    /// The newest value whose delay is over, with its time of arrival.
    releasable: Option<(DateTime, DataValue)>,
    /// Begin of the next hours, when a due value was noticed too late, outside of them.
    not_before: Option<DateTime>,
    has_released: bool,
}

impl Gate {
    /// Creates a gate in a stored state; a default one for a new field.
    #[must_use]
    pub fn new(
        policy: Arc<DisclosurePolicy>,
        field_type: BuiltInType,
        mut state: GateState,
        now: DateTime,
    ) -> Self {
        // After a clock was set back, the gate must neither release early nor be closed for years.
        state.last_released_at = state.last_released_at.map(|at| at.min(now));
        state.opened_at = state.opened_at.map(|at| at.min(now));
        for (arrived_at, _) in &mut state.waiting {
            *arrived_at = (*arrived_at).min(now);
        }
        for released_at in &mut state.released {
            *released_at = (*released_at).min(now);
        }
        state.aggregation.set_clock_back(now);
        state.coarsen_statuses(&policy);
        let is_immediate = policy.is_immediate();
        Self {
            policy,
            is_immediate,
            field_type,
            state,
            releasable: None,
            not_before: None,
            has_released: false,
        }
    }

    /// Returns the present policy.
    #[must_use]
    pub const fn policy(&self) -> &Arc<DisclosurePolicy> {
        &self.policy
    }

    /// Returns the value released last, which the node shows and the partner has.
    #[must_use]
    pub const fn disclosed(&self) -> Option<&Released> {
        self.state.disclosed.as_ref()
    }

    /// Returns the state to store for a restart.
    #[must_use]
    pub fn state(&self) -> GateState {
        let mut state = self.state.clone();
        if let Some(releasable) = &self.releasable {
            // As waiting: after a restart it passes the conditions of that time again.
            state.waiting.push_front(releasable.clone());
        }
        state
    }

    /// Returns true once after each release.
    pub const fn take_released(&mut self) -> bool {
        std::mem::replace(&mut self.has_released, false)
    }

    /// Corrects the state after the clock was set back: times in the future become the present.
    pub fn set_clock_back(&mut self, now: DateTime) {
        self.state = Self::new(Arc::clone(&self.policy), self.field_type, self.state(), now).state;
        self.releasable = None;
    }

    /// Handles a candidate. Values that were due before it are released first.
    pub fn on(&mut self, now: DateTime, candidate: DataValue) -> GateOutcome {
        if self.is_idle() && self.state.last_released_at.is_none_or(|last| last <= now) {
            return self.release_at_once(now, candidate);
        }
        self.on_time(now);
        self.note_own_state(now, &candidate);
        if self.is_withheld() {
            // A mean must not weight the value before with the time in which candidates are
            // withheld.
            self.state.aggregation.pause(now);
            return GateOutcome::Suppressed;
        }
        // Set aside, to tell whether this candidate is released; the flag is joined again below.
        let released_before = self.take_released();
        let mut is_coarsened = true;
        if let Some(aggregate) = self.policy.aggregate {
            self.state.aggregation.take(
                aggregate,
                now,
                self.checked_type(candidate),
                self.field_type,
            );
        } else {
            let coarsened = coarsen(&self.policy, self.field_type, candidate);
            is_coarsened = coarsened.is_coarsened;
            self.wait(now, coarsened.value);
        }
        self.on_time(now);
        let is_released = self.has_released;
        self.has_released |= released_before;
        match self.due() {
            _ if is_released => GateOutcome::Disclosed { is_coarsened },
            None => GateOutcome::Unchanged { is_coarsened },
            Some(until) => GateOutcome::Withheld { until },
        }
    }

    /// Notes the state of a candidate that comes before anything is asked for. Returns true where a
    /// state withholds it, so that it may not be offered later either.
    pub fn withholds(&mut self, now: DateTime, candidate: &DataValue) -> bool {
        self.note_own_state(now, candidate);
        self.is_withheld()
    }

    fn note_own_state(&mut self, now: DateTime, candidate: &DataValue) {
        let Some(is_withheld) = self.policy.is_own_state_withheld(candidate) else { return };
        if self.state.is_in_withheld_state && !is_withheld {
            self.open_from(now);
        }
        self.state.is_in_withheld_state = is_withheld;
    }

    /// Returns true when no value waits, and no candidate has to.
    fn is_idle(&self) -> bool {
        self.is_immediate
            && self.releasable.is_none()
            && self.state.waiting.is_empty()
            && !self.state.is_in_withheld_state
    }

    /// Handles a candidate when [`Self::is_idle`], with the same result as the general path. For the
    /// many fields of which every change is released.
    fn release_at_once(&mut self, now: DateTime, candidate: DataValue) -> GateOutcome {
        let Coarsened { value, is_coarsened } = coarsen(&self.policy, self.field_type, candidate);
        if self.is_known(&value) {
            return GateOutcome::Unchanged { is_coarsened };
        }
        self.state.disclosed = Some(Released::by_gate(value));
        self.state.last_released_at = Some(now);
        self.has_released = true;
        GateOutcome::Disclosed { is_coarsened }
    }

    /// Notes that another field entered or left a state in which this one is withheld; `None` when
    /// its state is not known. Returns whether that is a change.
    pub fn on_state(
        &mut self,
        now: DateTime,
        other: &FieldName,
        is_withheld: Option<bool>,
    ) -> bool {
        self.on_time(now);
        let before = self.state.withheld_by.get(other).copied();
        let was_withheld = self.is_withheld();
        match is_withheld {
            Some(is_withheld) => drop(self.state.withheld_by.insert(other.clone(), is_withheld)),
            None => drop(self.state.withheld_by.remove(other)),
        }
        if self.is_withheld() {
            self.state.aggregation.pause(now);
        } else if was_withheld {
            self.open_from(now);
        }
        self.on_time(now);
        before != is_withheld
    }

    /// Notes that a state which withheld has ended: what is due already is released in the next slot from
    /// now on, so that the time of a release tells no more than others do.
    fn open_from(&mut self, now: DateTime) {
        if self.policy.aggregate.is_some() || !self.policy.time_step().is_zero() {
            self.state.opened_at = Some(now);
        }
    }

    /// Returns whether the state of another field withholds this one; `None` where it is unknown.
    #[must_use]
    pub fn known_state(&self, other: &FieldName) -> Option<bool> {
        self.state.withheld_by.get(other).copied()
    }

    /// Forgets the state of another field at a restart, and releases nothing by it any more.
    pub fn forget_state(&mut self, now: DateTime, other: &FieldName) {
        self.close_windows(now);
        self.state.withheld_by.remove(other);
        if self.is_withheld() {
            self.state.aggregation.pause(now);
        }
    }

    /// Returns true while no value is released because of a state; candidates of this time never are.
    #[must_use]
    pub fn is_withheld(&self) -> bool {
        self.state.is_in_withheld_state
            || self
                .policy
                .withhold_while
                .iter()
                .filter_map(|condition| condition.field.as_ref())
                // Withheld as well while the state of the other field is unknown: a policy errs on
                // the safe side.
                .any(|other| self.state.withheld_by.get(other) != Some(&false))
    }

    /// Releases the value that is due. The caller wakes the gate at [`Gate::due`].
    pub fn on_time(&mut self, now: DateTime) {
        self.close_windows(now);
        let delay = self.policy.delay();
        while let Some((arrived_at, _)) = self.state.waiting.front() {
            if arrived_at.after(delay) > now {
                break;
            }
            // Of several whose delay is over the newest counts: one value is released, and the
            // others are past.
            self.releasable = self.state.waiting.pop_front();
        }
        // The partner has it already; a repetition would only show that a candidate came.
        if self.releasable.as_ref().is_some_and(|(_, value)| self.is_known(value)) {
            self.releasable = None;
        }
        if self.release_at().is_some_and(|at| at <= now) {
            // Noticed late, for example after a restart: a value that was due on the step or within
            // the hours must not be released between two steps or after the hours.
            match self.policy.first_punctual(now) {
                Some(at) if at > now => self.not_before = Some(at),
                None => {}
                Some(_) => self.release(now),
            }
        }
    }

    fn release(&mut self, now: DateTime) {
        self.state.disclosed = self.releasable.take().map(|(_, value)| Released::by_gate(value));
        self.state.last_released_at = Some(now);
        rate::remember(&mut self.state.released, &self.policy.rate_limits, now);
        self.not_before = None;
        self.has_released = true;
    }

    /// Closes windows that are over; their aggregates wait for the delay.
    fn close_windows(&mut self, now: DateTime) {
        let Some(aggregate) = self.policy.aggregate else { return };
        while let Some((ended_at, value)) =
            self.state.aggregation.close(aggregate, now, self.field_type)
        {
            let value = coarsen(&self.policy, self.field_type, value).value;
            self.wait(ended_at, value);
        }
    }

    /// Replaces a candidate of another type than the field's by a Bad one, which aggregates skip.
    fn checked_type(&self, candidate: DataValue) -> DataValue {
        // The aggregate is coarsened; its candidates must go in exactly.
        let untouched = DisclosurePolicy::default();
        coarsen(&untouched, self.field_type, candidate).value
    }

    /// Returns the time at which a value may be released next.
    #[must_use]
    pub fn due(&self) -> Option<DateTime> {
        if self.is_idle() {
            return None;
        }
        let releasable_at =
            self.state.waiting.front().map(|(arrived_at, _)| arrived_at.after(self.policy.delay()));
        let ends_at =
            self.policy.aggregate.and_then(|aggregate| self.state.aggregation.ends_at(aggregate));
        [self.release_at(), releasable_at, ends_at].into_iter().flatten().min()
    }

    fn wait(&mut self, now: DateTime, value: DataValue) {
        let delay = self.policy.delay();
        if delay.is_zero() {
            // No delay: replaces any value still waiting.
            self.state.waiting.clear();
            self.releasable = Some((now, value));
            return;
        }
        let share: Duration = delay / DELAYED_MAX;
        let waiting = &mut self.state.waiting;
        if waiting.len() >= 2 && now.since(waiting[waiting.len() - 2].0) < share {
            waiting.pop_back();
        }
        waiting.push_back((now, value));
    }

    /// Returns true when a value is equal to the one released last. A sum is new in every window,
    /// unless it is zero.
    fn is_known(&self, value: &DataValue) -> bool {
        let is_sum = || {
            self.policy
                .aggregate
                .is_some_and(|aggregate| aggregate.function == AggregateFunction::Sum)
        };
        let is_zero = || value.value.as_f64() == Some(0.0);
        let known = self.state.disclosed.as_ref();
        known.is_some_and(|known| known.value == value.value && known.status == value.status)
            && (!is_sum() || is_zero())
    }

    /// Returns the time at which the releasable value is released.
    fn release_at(&self) -> Option<DateTime> {
        let (arrived_at, _) = self.releasable.as_ref().filter(|_| !self.is_withheld())?;
        let mut at = arrived_at.after(self.policy.delay());
        if let Some(last) = self.state.last_released_at {
            at = at.max(last.after(self.policy.minimum_interval()));
            let window = self.policy.aggregate.map(|aggregate| aggregate.window());
            for step in [self.policy.time_step(), window.unwrap_or_default()] {
                if !step.is_zero() {
                    at = at.max(last.floor_to(step).after(step));
                }
            }
        }
        for limit in &self.policy.rate_limits {
            at = at.max(limit.next_at(&self.state.released).unwrap_or(at));
        }
        let not_before = self.not_before.max(self.state.opened_at);
        at = at.max(not_before.unwrap_or(at));
        self.policy.first_slot(self.policy.end_of_window(at))
    }
}

#[cfg(test)]
mod tests;
