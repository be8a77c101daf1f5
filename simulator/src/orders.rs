//! Orders that a machine works off, one after the other, each counted from its own start.

use serde::{Deserialize, Serialize};

/// Step in which the expected end moves while a failed machine stands still, in seconds: it is not known any better.
const GUESS_STEP: f64 = 10.0;

/// Orders of a machine; each starts at a fixed time after the one before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OrdersConfig {
    /// Ids are this name and a number, `4711-1`.
    pub name: String,
    /// Number of the first order.
    #[serde(default = "first_number")]
    pub first_number: u64,
    /// Parts of each.
    pub quantity: u32,
    /// Start of the first, in simulated seconds after the epoch.
    #[serde(default)]
    pub begins_after_seconds: f64,
    /// Simulated seconds from start to start. What is not done by then stays unfinished.
    pub every_seconds: f64,
    /// Failure in each of them; none if absent.
    #[serde(default)]
    pub failure: Option<FailureConfig>,
}

/// Failure of a machine in the middle of an order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FailureConfig {
    /// Simulated seconds from the start of the order to the failure.
    pub after_seconds: f64,
    /// Simulated seconds until the machine works again.
    pub lasts_seconds: f64,
}

const fn first_number() -> u64 {
    1
}

impl OrdersConfig {
    /// Returns the reason why they cannot be worked off.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let is_time = |seconds: f64| (0.0..=1e9).contains(&seconds);
        let FailureConfig { after_seconds, lasts_seconds } =
            self.failure.unwrap_or(FailureConfig { after_seconds: 0.0, lasts_seconds: 0.0 });
        if self.quantity == 0 || self.every_seconds < 1.0 {
            Some("need a quantity, and at least a second from start to start")
        } else if [self.begins_after_seconds, self.every_seconds, after_seconds, lasts_seconds]
            .into_iter()
            .all(is_time)
        {
            None
        } else {
            Some("need times between 0 and 1000000000 seconds")
        }
    }

    pub(crate) fn rhythm(&self) -> OrderRhythm {
        OrderRhythm {
            quantity: self.quantity,
            begins_after: self.begins_after_seconds,
            every: self.every_seconds,
            failure: self.failure,
        }
    }

    /// Returns the id of an order by its place in the row.
    pub(crate) fn id(&self, index: u64) -> String {
        format!("{}-{}", self.name, self.first_number.saturating_add(index))
    }
}

/// Rhythm of orders, in simulated seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderRhythm {
    /// Parts of each order.
    pub quantity: u32,
    /// Start of the first.
    pub begins_after: f64,
    /// Time from start to start.
    pub every: f64,
    pub failure: Option<FailureConfig>,
}

/// Phase of an order; its number is what machines show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderPhase {
    /// Before its start.
    Waiting = 0,
    Running = 1,
    /// The machine has failed.
    Interrupted = 2,
    /// All parts are made, and the next order has not begun.
    Done = 3,
}

/// Order of a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderProgress {
    /// Its place in the row, from 0.
    pub index: u64,
    pub phase: OrderPhase,
    /// Seconds in which it was worked on.
    pub worked: f64,
    /// Seconds in which it and those before were worked on.
    pub worked_in_all: f64,
    /// Failures that have begun, in it and those before.
    pub failures: u64,
    /// Simulated time of its start.
    pub start: f64,
    /// Simulated time of its end: as expected, or as it was.
    pub end: f64,
}

impl OrderRhythm {
    /// Returns the order of a simulated time, of a machine with this time per part.
    #[must_use]
    pub fn at(&self, seconds: f64, cycle: f64) -> OrderProgress {
        let position = ((seconds - self.begins_after) / self.every).floor().max(0.0);
        let start = self.begins_after + position * self.every;
        let within = (seconds - start).max(0.0);
        let work = f64::from(self.quantity) * cycle;
        // An order that is done by then has no failure.
        let failure = self.failure.filter(|failure| failure.after_seconds < work);
        let (fails_at, lasts) =
            failure.map_or((f64::MAX, 0.0), |found| (found.after_seconds, found.lasts_seconds));
        let stands = (within - fails_at).clamp(0.0, lasts);
        let worked = (within - stands).min(work);
        let has_failed = within >= fails_at;
        let phase = if seconds < start {
            OrderPhase::Waiting
        } else if worked >= work {
            OrderPhase::Done
        } else if has_failed && stands < lasts {
            OrderPhase::Interrupted
        } else {
            OrderPhase::Running
        };
        let lost = if phase == OrderPhase::Interrupted {
            (stands / GUESS_STEP).floor() * GUESS_STEP
        } else {
            stands
        };
        let index = position as u64;
        OrderProgress {
            index,
            phase,
            worked,
            worked_in_all: position * (self.every - lasts).min(work) + worked,
            failures: if failure.is_some() { index + u64::from(has_failed) } else { 0 },
            start,
            end: start + work + lost,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: f64 = 40.0;
    const RHYTHM: OrderRhythm = OrderRhythm {
        quantity: 12,
        begins_after: 20.0,
        every: 1200.0,
        failure: Some(FailureConfig { after_seconds: 70.0, lasts_seconds: 45.0 }),
    };

    #[test]
    fn an_order_waits_runs_fails_recovers_and_ends_and_the_next_begins() {
        use OrderPhase::{Done, Interrupted, Running, Waiting};
        for (seconds, place, worked, end) in [
            (0.0, (0, Waiting), 0.0, 500.0),
            (20.0, (0, Running), 0.0, 500.0),
            (80.0, (0, Running), 60.0, 500.0),
            (90.0, (0, Interrupted), 70.0, 500.0),
            (119.0, (0, Interrupted), 70.0, 520.0),
            (135.0, (0, Running), 70.0, 545.0),
            (544.0, (0, Running), 479.0, 545.0),
            (545.0, (0, Done), 480.0, 545.0),
            (1219.0, (0, Done), 480.0, 545.0),
            (1220.0, (1, Running), 0.0, 1700.0),
            (4220.0, (3, Done), 480.0, 4145.0),
        ] {
            let order = RHYTHM.at(seconds, CYCLE);
            assert_eq!((order.index, order.phase), place, "at {seconds} s");
            assert_eq!((order.worked, order.end), (worked, end), "work and end at {seconds} s");
        }
    }

    #[test]
    fn work_and_failures_of_all_orders_only_grow() {
        let mut last = RHYTHM.at(0.0, CYCLE);
        for second in 1..10_000 {
            let next = RHYTHM.at(f64::from(second), CYCLE);
            let grown = next.worked_in_all - last.worked_in_all;
            assert!((0.0..=1.0).contains(&grown), "{last:?} {next:?}");
            assert!((0..=1).contains(&(next.failures - last.failures)), "{last:?} {next:?}");
            last = next;
        }
        assert_eq!(last.failures, 9);
    }

    #[test]
    fn a_failure_after_the_end_does_not_happen() {
        let late = FailureConfig { after_seconds: 500.0, lasts_seconds: 45.0 };
        let order = OrderRhythm { failure: Some(late), ..RHYTHM }.at(20.0 + 510.0, CYCLE);
        assert_eq!((order.phase, order.failures), (OrderPhase::Done, 0));
    }
}
