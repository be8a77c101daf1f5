//! Circuit breaker of a script that exceeds its budget.

use std::time::Duration;

use asi_model::DateTime;

/// Longest pause of a script that exceeded its budget, reached by doubling.
const REST_MAX: Duration = Duration::from_secs(3600);

/// Circuit breaker of one script: it pauses the script after calls that exceeded a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Breaker {
    exhausted_in_a_row: u32,
    rests: u32,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    #[default]
    Closed,
    Open {
        until: DateTime,
    },
    /// One call is under way to see whether it works again.
    Trying,
}

/// Answer to a request for a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Admission {
    Admitted,
    Resting,
}

impl Breaker {
    /// Admits a call, or one call to try again after a rest.
    pub fn admit(&mut self, now: DateTime) -> Admission {
        match self.state {
            State::Closed => Admission::Admitted,
            State::Open { until } if now >= until => {
                self.state = State::Trying;
                Admission::Admitted
            }
            State::Open { .. } | State::Trying => Admission::Resting,
        }
    }

    /// Closes the breaker.
    pub fn succeeded(&mut self) {
        *self = Self::default();
    }

    /// Records a call that failed within its budget: such faults do not open the breaker.
    pub fn failed(&mut self) {
        self.exhausted_in_a_row = 0;
        if self.state == State::Trying {
            *self = Self::default();
        }
    }

    /// Records a call that used up time or memory. Returns true if the script rests from now on.
    pub fn exhausted(&mut self, now: DateTime, in_a_row_max: u32, rest: Duration) -> bool {
        self.exhausted_in_a_row += 1;
        let rests = self.state == State::Trying || self.exhausted_in_a_row >= in_a_row_max;
        if rests {
            self.open(now, rest);
        }
        rests
    }

    /// Opens the breaker: twice as long as the time before, at most [`REST_MAX`].
    pub fn open(&mut self, now: DateTime, rest: Duration) {
        let rest = rest.saturating_mul(2_u32.saturating_pow(self.rests)).min(REST_MAX);
        self.rests = self.rests.saturating_add(1);
        self.exhausted_in_a_row = 0;
        self.state = State::Open { until: now.after(rest) };
    }

    /// Returns the end of the rest, by the local clock.
    pub const fn resting_until(&self) -> Option<DateTime> {
        match self.state {
            State::Open { until } => Some(until),
            _ => None,
        }
    }

    /// Returns true while calls are admitted without condition.
    pub const fn is_closed(&self) -> bool {
        matches!(self.state, State::Closed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rests_grow_until_a_call_succeeds() {
        let rest = Duration::from_secs(30);
        let at = |seconds: i64| DateTime::from_unix_micros(seconds * 1_000_000);
        let mut breaker = Breaker::default();
        assert!(!breaker.exhausted(at(0), 2, rest));
        breaker.failed();
        assert!(!breaker.exhausted(at(0), 2, rest), "only faults in a row count");
        assert!(breaker.exhausted(at(0), 2, rest));
        assert_eq!(breaker.admit(at(29)), Admission::Resting);
        assert_eq!(breaker.admit(at(30)), Admission::Admitted);
        assert_eq!(breaker.admit(at(30)), Admission::Resting, "one call tries");
        assert!(breaker.exhausted(at(31), 2, rest), "one fault while trying is enough");
        assert_eq!(breaker.resting_until(), Some(at(91)));
        assert_eq!(breaker.admit(at(91)), Admission::Admitted);
        breaker.succeeded();
        assert!(breaker.is_closed());
        for _ in 0..40 {
            breaker.open(at(0), rest);
        }
        assert_eq!(breaker.resting_until(), Some(at(3600)));
    }
}
