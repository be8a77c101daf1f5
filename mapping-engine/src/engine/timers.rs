//! Timers of mappings.

use std::{cmp::Reverse, collections::BinaryHeap};

use asi_model::DateTime;

/// Timers by slot. A timer may be outdated: the mapping checks whether it is due, and schedules
/// itself again. So a window that moves with every value leaves one timer, not thousands.
#[derive(Debug, Default)]
pub(super) struct Timers {
    heap: BinaryHeap<Reverse<(DateTime, usize)>>,
}

impl Timers {
    /// Schedules a slot at a time, unless it is scheduled earlier anyway. `scheduled` is the
    /// mapping's record of that.
    pub fn schedule(&mut self, scheduled: &mut Option<DateTime>, due: DateTime, slot: usize) {
        if scheduled.is_none_or(|earlier| due < earlier) {
            *scheduled = Some(due);
            self.heap.push(Reverse((due, slot)));
        }
    }

    /// Returns the earliest timer.
    pub fn next(&self) -> Option<DateTime> {
        self.heap.peek().map(|Reverse((due, _))| *due)
    }

    /// Takes the next slot that is due, with the time it was scheduled for.
    pub fn pop(&mut self, now: DateTime) -> Option<(usize, DateTime)> {
        let Reverse((due, slot)) = *self.heap.peek()?;
        if due > now {
            return None;
        }
        self.heap.pop();
        Some((slot, due))
    }
}
