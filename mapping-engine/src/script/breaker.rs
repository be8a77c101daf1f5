//! Circuit breaker of a script that exceeds its budget.

use std::time::Duration;

use asi_model::DateTime;

/// Longest time for which a circuit stays open, reached by doubling.
const BACKOFF_MAX: Duration = Duration::from_secs(3600);

/// Circuit breaker of one script: it pauses the script after calls that exceeded a budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Breaker {
    exhausted_in_a_row: u32,
    /// Number of openings since the last call that succeeded.
    openings: u32,
    state: BreakerState,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum BreakerState {
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
    /// The circuit is open, or the one call that tries is under way.
    Open,
}

impl Breaker {
    /// Admits a call, or one call to try again after the backoff.
    pub fn admit(&mut self, now: DateTime) -> Admission {
        match self.state {
            BreakerState::Closed => Admission::Admitted,
            BreakerState::Open { until } if now >= until => {
                self.state = BreakerState::Trying;
                Admission::Admitted
            }
            BreakerState::Open { .. } | BreakerState::Trying => Admission::Open,
        }
    }

    /// Closes the breaker.
    pub fn succeeded(&mut self) {
        *self = Self::default();
    }

    /// Records a call that failed within its budget: such faults do not open the breaker.
    pub fn failed(&mut self) {
        self.exhausted_in_a_row = 0;
        if self.state == BreakerState::Trying {
            *self = Self::default();
        }
    }

    /// Records a call that used up time or memory. Returns true where that opens the breaker.
    pub fn exhausted(&mut self, now: DateTime, in_a_row_max: u32, backoff: Duration) -> bool {
        self.exhausted_in_a_row += 1;
        let opens = self.state == BreakerState::Trying || self.exhausted_in_a_row >= in_a_row_max;
        if opens {
            self.open(now, backoff);
        }
        opens
    }

    /// Opens the breaker: twice as long as the time before, at most [`BACKOFF_MAX`].
    pub fn open(&mut self, now: DateTime, backoff: Duration) {
        let backoff = backoff.saturating_mul(2_u32.saturating_pow(self.openings)).min(BACKOFF_MAX);
        self.openings = self.openings.saturating_add(1);
        self.exhausted_in_a_row = 0;
        self.state = BreakerState::Open { until: now.after(backoff) };
    }

    /// Returns the time until which the circuit is open, by the local clock.
    pub const fn open_until(&self) -> Option<DateTime> {
        match self.state {
            BreakerState::Open { until } => Some(until),
            _ => None,
        }
    }

    /// Returns true while calls are admitted without condition.
    pub const fn is_closed(&self) -> bool {
        matches!(self.state, BreakerState::Closed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_backoff_grows_until_a_call_succeeds() {
        let backoff = Duration::from_secs(30);
        let at = |seconds: i64| DateTime::from_unix_micros(seconds * 1_000_000);
        let mut breaker = Breaker::default();
        assert!(!breaker.exhausted(at(0), 2, backoff));
        breaker.failed();
        assert!(!breaker.exhausted(at(0), 2, backoff), "only faults in a row count");
        assert!(breaker.exhausted(at(0), 2, backoff));
        assert_eq!(breaker.admit(at(29)), Admission::Open);
        assert_eq!(breaker.admit(at(30)), Admission::Admitted);
        assert_eq!(breaker.admit(at(30)), Admission::Open, "one call tries");
        assert!(breaker.exhausted(at(31), 2, backoff), "one fault while trying is enough");
        assert_eq!(breaker.open_until(), Some(at(91)));
        assert_eq!(breaker.admit(at(91)), Admission::Admitted);
        breaker.succeeded();
        assert!(breaker.is_closed());
        for _ in 0..40 {
            breaker.open(at(0), backoff);
        }
        assert_eq!(breaker.open_until(), Some(at(3600)));
    }
}
