//! The gate of one field: a state machine over candidates and time.

mod document;

use std::{
    collections::{BTreeMap, VecDeque},
    sync::Arc,
    time::Duration,
};

use asi_model::{BuiltInType, DataValue, DateTime, FieldName};

pub use document::{gate_from_json, gate_to_json};

use super::{
    AggregateFunction, DisclosurePolicy,
    aggregate::Aggregation,
    coarsening::{Coarsened, coarsen},
    rate,
};

/// Most values that wait for their delay; within a share of the delay the latest replaces the one
/// before it.
const DELAYED_MAX: u32 = 256;

/// What became of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It is disclosed now.
    Disclosed {
        /// Less than the candidate said is disclosed.
        is_coarsened: bool,
    },
    /// It says nothing that was not disclosed already.
    Unchanged {
        /// Less than the candidate said is disclosed.
        is_coarsened: bool,
    },
    /// It waits; a newer one may take its place until then.
    Withheld {
        /// When it may leave at the earliest.
        until: DateTime,
    },
    /// It never leaves: the policy withholds what comes in the present state.
    Suppressed,
}

/// What a gate remembers over restarts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GateState {
    /// When a value last left, for the minimum interval.
    pub last_released_at: Option<DateTime>,
    /// The value that left last.
    pub disclosed: Option<DataValue>,
    /// Coarsened values that wait, with the time they came, oldest first.
    pub waiting: VecDeque<(DateTime, DataValue)>,
    /// When values left, for the limits on their rate, oldest first.
    pub released: VecDeque<DateTime>,
    /// The window of an aggregate.
    pub aggregation: Aggregation,
    /// The field's own value is in a state in which nothing leaves.
    pub is_in_withheld_state: bool,
    /// Whether other fields are in a state in which nothing leaves, as far as that is known.
    pub withheld_by: BTreeMap<FieldName, bool>,
}

/// Decides what of a field's candidates leaves, and when.
///
/// `now` must never run backwards within one gate's life; [`Gate::new`] copes with a clock that did
/// so between lives.
#[derive(Debug, Clone)]
pub struct Gate {
    policy: Arc<DisclosurePolicy>,
    /// The policy coarsens values alone: what comes may leave at once.
    is_immediate: bool,
    field_type: BuiltInType,
    state: GateState,
    /// The newest value whose delay is over, with the time it came.
    ripe: Option<(DateTime, DataValue)>,
    /// What was due was noticed too late, outside of the hours; this is when they begin again.
    not_before: Option<DateTime>,
    has_released: bool,
}

impl Gate {
    /// A gate in a remembered state (a default one for a new field).
    #[must_use]
    pub fn new(
        policy: Arc<DisclosurePolicy>,
        field_type: BuiltInType,
        mut state: GateState,
        now: DateTime,
    ) -> Self {
        // A clock that was set back must neither open the gate early nor keep it shut for years.
        state.last_released_at = state.last_released_at.map(|at| at.min(now));
        for (arrived_at, _) in &mut state.waiting {
            *arrived_at = (*arrived_at).min(now);
        }
        for released_at in &mut state.released {
            *released_at = (*released_at).min(now);
        }
        state.aggregation.set_clock_back(now);
        let is_immediate = policy.is_immediate();
        Self {
            policy,
            is_immediate,
            field_type,
            state,
            ripe: None,
            not_before: None,
            has_released: false,
        }
    }

    /// The policy in force.
    #[must_use]
    pub const fn policy(&self) -> &Arc<DisclosurePolicy> {
        &self.policy
    }

    /// The value that left last: what the node shows and the partner has.
    #[must_use]
    pub const fn disclosed(&self) -> Option<&DataValue> {
        self.state.disclosed.as_ref()
    }

    /// What to remember over a restart.
    #[must_use]
    pub fn state(&self) -> GateState {
        let mut state = self.state.clone();
        if let Some(ripe) = &self.ripe {
            state.waiting.push_front(ripe.clone());
        }
        state
    }

    /// True once after each release.
    pub const fn take_released(&mut self) -> bool {
        std::mem::replace(&mut self.has_released, false)
    }

    /// The clock was set back: what was remembered of a time yet to come counts as of now.
    pub fn set_clock_back(&mut self, now: DateTime) {
        let Self { state, .. } =
            Self::new(Arc::clone(&self.policy), self.field_type, self.state(), now);
        self.state = state;
        self.ripe = None;
    }

    /// Takes a candidate. Whatever was due before it is released first.
    pub fn on(&mut self, now: DateTime, candidate: DataValue) -> Outcome {
        if self.is_idle() && self.state.last_released_at.is_none_or(|last| last <= now) {
            return self.on_at_once(now, candidate);
        }
        self.on_time(now);
        if let Some(is_withheld) = self.policy.is_own_state_withheld(&candidate) {
            self.state.is_in_withheld_state = is_withheld;
        }
        if self.is_withheld() {
            self.state.aggregation.pause(now);
            return Outcome::Suppressed;
        }
        let released_before = self.take_released();
        let mut is_coarsened = true;
        if let Some(aggregate) = self.policy.aggregate {
            self.state.aggregation.take(
                aggregate,
                now,
                self.of_its_type(candidate),
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
            _ if is_released => Outcome::Disclosed { is_coarsened },
            None => Outcome::Unchanged { is_coarsened },
            Some(until) => Outcome::Withheld { until },
        }
    }

    /// Nothing waits, and nothing that comes has to.
    fn is_idle(&self) -> bool {
        self.is_immediate
            && self.ripe.is_none()
            && self.state.waiting.is_empty()
            && !self.state.is_in_withheld_state
    }

    /// Takes a candidate where [`Self::is_idle`]: what all of the above comes to then, for the many
    /// fields of which every change leaves.
    fn on_at_once(&mut self, now: DateTime, candidate: DataValue) -> Outcome {
        let Coarsened { value, is_coarsened } = coarsen(&self.policy, self.field_type, candidate);
        if self.is_known(&value) {
            return Outcome::Unchanged { is_coarsened };
        }
        self.state.disclosed = Some(value);
        self.state.last_released_at = Some(now);
        self.has_released = true;
        Outcome::Disclosed { is_coarsened }
    }

    /// Another field came into, or left, a state in which nothing of this one leaves; `None` where
    /// its state is not known. True where that is news.
    pub fn on_state(
        &mut self,
        now: DateTime,
        other: &FieldName,
        is_withheld: Option<bool>,
    ) -> bool {
        self.on_time(now);
        let before = self.state.withheld_by.get(other).copied();
        match is_withheld {
            Some(is_withheld) => drop(self.state.withheld_by.insert(other.clone(), is_withheld)),
            None => drop(self.state.withheld_by.remove(other)),
        }
        if self.is_withheld() {
            self.state.aggregation.pause(now);
        }
        self.on_time(now);
        before != is_withheld
    }

    /// Nothing leaves at present because of a state, and what comes now never will.
    #[must_use]
    pub fn is_withheld(&self) -> bool {
        self.state.is_in_withheld_state
            || self
                .policy
                .withhold_while
                .iter()
                .filter_map(|condition| condition.field.as_ref())
                .any(|other| self.state.withheld_by.get(other) != Some(&false))
    }

    /// Releases what is due. The caller wakes the gate at [`Gate::due`].
    pub fn on_time(&mut self, now: DateTime) {
        self.close_windows(now);
        let delay = self.policy.delay();
        while let Some((arrived_at, _)) = self.state.waiting.front() {
            if arrived_at.after(delay) > now {
                break;
            }
            self.ripe = self.state.waiting.pop_front();
        }
        if self.ripe.as_ref().is_some_and(|(_, value)| self.is_known(value)) {
            self.ripe = None;
        }
        if self.release_at().is_some_and(|at| at <= now) {
            // Noticed late, perhaps after a restart: what was due within the hours must not leave
            // after them.
            match self.first_within_hours(now) {
                Some(at) if at > now => self.not_before = Some(at),
                None => {}
                Some(_) => self.release(now),
            }
        }
    }

    fn release(&mut self, now: DateTime) {
        self.state.disclosed = self.ripe.take().map(|(_, value)| value);
        self.state.last_released_at = Some(now);
        rate::remember(&mut self.state.released, &self.policy.rate_limits, now);
        self.not_before = None;
        self.has_released = true;
    }

    /// Lets the aggregates of windows that are over wait for their delay.
    fn close_windows(&mut self, now: DateTime) {
        let Some(aggregate) = self.policy.aggregate else { return };
        while let Some((ended_at, value)) =
            self.state.aggregation.close(aggregate, now, self.field_type)
        {
            let value = coarsen(&self.policy, self.field_type, value).value;
            self.wait(ended_at, value);
        }
    }

    /// A candidate of another type than the field's is none: it is left out of an aggregate as Bad.
    fn of_its_type(&self, candidate: DataValue) -> DataValue {
        let untouched = DisclosurePolicy::default();
        coarsen(&untouched, self.field_type, candidate).value
    }

    /// When something may be released next.
    #[must_use]
    pub fn due(&self) -> Option<DateTime> {
        if self.is_idle() {
            return None;
        }
        let ripens_at =
            self.state.waiting.front().map(|(arrived_at, _)| arrived_at.after(self.policy.delay()));
        let ends_at =
            self.policy.aggregate.and_then(|aggregate| self.state.aggregation.ends_at(aggregate));
        [self.release_at(), ripens_at, ends_at].into_iter().flatten().min()
    }

    /// Another policy takes effect. What waits was coarsened under the old one and is coarsened
    /// again under the new one; the minimum interval goes on counting. What was to leave as part of
    /// an aggregate only never leaves singly.
    pub fn change_policy(&mut self, policy: Arc<DisclosurePolicy>, now: DateTime) {
        if self.policy.aggregate != policy.aggregate {
            self.state.aggregation = Aggregation::default();
        }
        if self.policy.withhold_while != policy.withhold_while {
            self.state.is_in_withheld_state = false;
            self.state.withheld_by.clear();
        }
        self.not_before = None;
        self.is_immediate = policy.is_immediate();
        self.policy = policy;
        let again = |value: DataValue| coarsen(&self.policy, self.field_type, value).value;
        self.ripe = self.ripe.take().map(|(at, value)| (at, again(value)));
        self.state.waiting = std::mem::take(&mut self.state.waiting)
            .into_iter()
            .map(|(at, v)| (at, again(v)))
            .collect();
        self.on_time(now);
    }

    /// The consent ended: nothing that waits will leave, and nothing is shown any more.
    pub fn close(&mut self) {
        self.ripe = None;
        self.not_before = None;
        self.state.waiting.clear();
        self.state.aggregation = Aggregation::default();
        self.state.disclosed = None;
        self.has_released = false;
    }

    fn wait(&mut self, now: DateTime, value: DataValue) {
        let delay = self.policy.delay();
        if delay.is_zero() {
            // Ripe at once; what was kept from leaving until now gives way to it.
            self.state.waiting.clear();
            self.ripe = Some((now, value));
            return;
        }
        let share: Duration = delay / DELAYED_MAX;
        let waiting = &mut self.state.waiting;
        if waiting.len() >= 2 && now.since(waiting[waiting.len() - 2].0) < share {
            waiting.pop_back();
        }
        waiting.push_back((now, value));
    }

    /// Nothing new for those who know what left last. A sum is new with every window: two fives are
    /// ten.
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

    /// When the ripe value may leave.
    fn release_at(&self) -> Option<DateTime> {
        let (arrived_at, _) = self.ripe.as_ref().filter(|_| !self.is_withheld())?;
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
        self.policy.first_slot(at.max(self.not_before.unwrap_or(at)))
    }

    /// The first instant from `at` on within all working hours.
    fn first_within_hours(&self, at: DateTime) -> Option<DateTime> {
        if self.policy.has_hours() {
            self.policy.first_slot_of(at, Duration::ZERO)
        } else {
            Some(at)
        }
    }
}

#[cfg(test)]
mod tests;
