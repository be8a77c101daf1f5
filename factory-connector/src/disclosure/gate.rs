//! The gate of one field: a state machine over candidates and time.

use std::{collections::VecDeque, sync::Arc, time::Duration};

use asi_model::{BuiltInType, DataValue, DateTime};

use super::{DisclosurePolicy, coarsening::coarsen};

/// Most values that wait for their delay; within a share of the delay the latest replaces the one before it.
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
}

/// Decides what of a field's candidates leaves, and when.
///
/// `now` must never run backwards within one gate's life; [`Gate::new`] copes with a clock that did so between lives.
#[derive(Debug, Clone)]
pub struct Gate {
    policy: Arc<DisclosurePolicy>,
    field_type: BuiltInType,
    state: GateState,
    /// The newest value whose delay is over, with the time it came.
    ripe: Option<(DateTime, DataValue)>,
    has_news: bool,
}

impl Gate {
    /// A gate in a remembered state (a default one for a new field).
    #[must_use]
    pub fn new(policy: Arc<DisclosurePolicy>, field_type: BuiltInType, mut state: GateState, now: DateTime) -> Self {
        // A clock that was set back must neither open the gate early nor keep it shut for years.
        state.last_released_at = state.last_released_at.map(|at| at.min(now));
        for (arrived_at, _) in &mut state.waiting {
            *arrived_at = (*arrived_at).min(now);
        }
        Self { policy, field_type, state, ripe: None, has_news: false }
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
    pub const fn take_news(&mut self) -> bool {
        std::mem::replace(&mut self.has_news, false)
    }

    /// The clock was set back: what was remembered of a time yet to come counts as of now.
    pub fn set_clock_back(&mut self, now: DateTime) {
        let Self { state, .. } = Self::new(Arc::clone(&self.policy), self.field_type, self.state(), now);
        self.state = state;
        self.ripe = None;
    }

    /// Takes a candidate. Whatever was due before it is released first.
    pub fn on(&mut self, now: DateTime, candidate: DataValue) -> Outcome {
        self.on_time(now);
        let coarsened = coarsen(&self.policy, self.field_type, candidate);
        let is_coarsened = coarsened.is_coarsened;
        self.wait(now, coarsened.value);
        let released_before = self.take_news();
        self.on_time(now);
        let is_released = self.has_news;
        self.has_news |= released_before;
        match self.due() {
            _ if is_released => Outcome::Disclosed { is_coarsened },
            None => Outcome::Unchanged { is_coarsened },
            Some(until) => Outcome::Withheld { until },
        }
    }

    /// Releases what is due. The caller wakes the gate at [`Gate::due`].
    pub fn on_time(&mut self, now: DateTime) {
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
            self.state.disclosed = self.ripe.take().map(|(_, value)| value);
            self.state.last_released_at = Some(now);
            self.has_news = true;
        }
    }

    /// When something may be released next.
    #[must_use]
    pub fn due(&self) -> Option<DateTime> {
        let ripens_at = self.state.waiting.front().map(|(arrived_at, _)| arrived_at.after(self.policy.delay()));
        match (self.release_at(), ripens_at) {
            (Some(release), Some(ripe)) => Some(release.min(ripe)),
            (release, ripe) => release.or(ripe),
        }
    }

    /// Another policy takes effect. What waits was coarsened under the old one and is coarsened again under the new
    /// one; the minimum interval goes on counting.
    pub fn change_policy(&mut self, policy: Arc<DisclosurePolicy>, now: DateTime) {
        self.policy = policy;
        let again = |value: DataValue| coarsen(&self.policy, self.field_type, value).value;
        self.ripe = self.ripe.take().map(|(at, value)| (at, again(value)));
        self.state.waiting =
            std::mem::take(&mut self.state.waiting).into_iter().map(|(at, v)| (at, again(v))).collect();
        self.on_time(now);
    }

    /// The consent ended: nothing that waits will leave, and nothing is shown any more.
    pub fn close(&mut self) {
        self.ripe = None;
        self.state.waiting.clear();
        self.state.disclosed = None;
        self.has_news = false;
    }

    fn wait(&mut self, now: DateTime, value: DataValue) {
        let delay = self.policy.delay();
        if delay.is_zero() {
            // The newest wins, but the wait counts from the first that had news.
            self.state.waiting.clear();
            self.state.waiting.push_back((now, value));
            return;
        }
        let share: Duration = delay / DELAYED_MAX;
        let waiting = &mut self.state.waiting;
        if waiting.len() >= 2 && now.since(waiting[waiting.len() - 2].0) < share {
            waiting.pop_back();
        }
        waiting.push_back((now, value));
    }

    fn is_known(&self, value: &DataValue) -> bool {
        self.state.disclosed.as_ref().is_some_and(|known| known.value == value.value && known.status == value.status)
    }

    /// When the ripe value may leave.
    fn release_at(&self) -> Option<DateTime> {
        let (arrived_at, _) = self.ripe.as_ref()?;
        let mut at = arrived_at.after(self.policy.delay());
        if let Some(last) = self.state.last_released_at {
            at = at.max(last.after(self.policy.minimum_interval()));
        }
        let step = self.policy.time_step();
        if let Some(last) = self.state.last_released_at.filter(|_| !step.is_zero()) {
            at = at.max(last.floor_to(step).after(step));
        }
        let mut at = ceil_to(at, step);
        if let Some(hours) = &self.policy.working_hours {
            // An opening that is not on a step is followed by one that is, which lies within the hours or past them.
            for _ in 0..2 {
                at = ceil_to(hours.first_open(at)?, step);
            }
        }
        Some(at)
    }
}

/// Rounded up to a multiple of `step` since 1970; unchanged where the step is zero.
fn ceil_to(at: DateTime, step: Duration) -> DateTime {
    let floor = at.floor_to(step);
    if floor == at { at } else { floor.after(step) }
}

#[cfg(test)]
mod tests;
