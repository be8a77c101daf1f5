//! Reports that a small spool may have had no room for: those made, or not yet receipted, while their factory could not
//! deliver. They are known by their number and not by a time: clocks jump.

use std::ops::RangeInclusive;

use super::plan::{Fault, PLATFORM};

/// Reports of each interruption of one factory's delivery, by their numbers in the order in which they were made.
#[derive(Debug, Default)]
pub(super) struct Interruptions {
    over: Vec<RangeInclusive<i64>>,
    /// First report of the one that lasts.
    since: Option<i64>,
}

impl Interruptions {
    /// Begins one, unless one lasts. `first` is the oldest report that is not receipted.
    pub fn begin(&mut self, first: i64) {
        self.since.get_or_insert(first);
    }

    /// Ends the one that lasts: after the report `last` the spool has room again.
    pub fn end(&mut self, last: i64) {
        self.over.extend(self.since.take().map(|first| first..=last));
    }

    /// Lets the newest one go on: a program has ended, of which nobody knew.
    pub fn go_on(&mut self) {
        if self.since.is_none() {
            self.since = self.over.pop().map(|span| *span.start());
        }
    }

    /// True for a report of one of them.
    pub fn has(&self, report: i64) -> bool {
        self.since.is_some_and(|first| first <= report)
            || self.over.iter().any(|span| span.contains(&report))
    }
}

/// True where a factory cannot deliver what it reports, for a moment at least.
pub(super) fn interrupts(fault: Fault, factory: &str) -> bool {
    match fault {
        Fault::KillMachines(_) => false,
        Fault::KillConnector(whose)
        | Fault::ConnectorClock(whose, _)
        | Fault::FullDisk(whose, _)
        | Fault::PauseConnector(whose, _) => whose == factory || whose == PLATFORM,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::frame_order::{HAMBURG, MUNICH};

    #[test]
    fn an_interruption_lasts_until_the_spool_has_room() {
        let mut all = Interruptions::default();
        assert!(!all.has(0));
        all.begin(3);
        all.begin(5);
        assert_eq!([2, 3, 900].map(|report| all.has(report)), [false, true, true]);
        all.end(7);
        all.end(9);
        assert_eq!([2, 3, 7, 8].map(|report| all.has(report)), [false, true, true, false]);
        all.begin(20);
        all.end(21);
        assert_eq!([7, 8, 20, 22].map(|report| all.has(report)), [true, false, true, false]);
        all.go_on();
        assert_eq!([7, 8, 20, 22].map(|report| all.has(report)), [true, false, true, true]);
    }

    #[test]
    fn what_happens_to_machines_or_to_another_factory_interrupts_nothing() {
        let span = Duration::from_secs(1);
        assert!(interrupts(Fault::Outage(span), HAMBURG));
        assert!(interrupts(Fault::KillPlatform, HAMBURG));
        assert!(interrupts(Fault::FullDisk(PLATFORM, span), HAMBURG));
        assert!(interrupts(Fault::PauseConnector(HAMBURG, span), HAMBURG));
        assert!(!interrupts(Fault::PauseConnector(MUNICH, span), HAMBURG));
        assert!(!interrupts(Fault::KillConnector(MUNICH), HAMBURG));
        assert!(!interrupts(Fault::KillMachines(HAMBURG), HAMBURG));
    }
}
