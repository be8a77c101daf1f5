//! When mappings want to be woken.

use std::{cmp::Reverse, collections::BinaryHeap};

use asi_model::DateTime;

/// Wake-up times by place. An entry may be outdated: who is woken looks whether it is really due,
/// and says again when it wants to be woken. So a window that moves with every value leaves one
/// entry, not thousands.
#[derive(Debug, Default)]
pub(super) struct Timers {
    heap: BinaryHeap<Reverse<(DateTime, usize)>>,
}

impl Timers {
    /// Wakes a place at a time, unless it is woken earlier anyway. `scheduled` is the place's own
    /// note of that.
    pub fn schedule(&mut self, scheduled: &mut Option<DateTime>, due: DateTime, place: usize) {
        if scheduled.is_none_or(|earlier| due < earlier) {
            *scheduled = Some(due);
            self.heap.push(Reverse((due, place)));
        }
    }

    pub fn next(&self) -> Option<DateTime> {
        self.heap.peek().map(|Reverse((due, _))| *due)
    }

    /// The next place to wake, with the time it was woken for.
    pub fn pop(&mut self, now: DateTime) -> Option<(usize, DateTime)> {
        let Reverse((due, place)) = *self.heap.peek()?;
        if due > now {
            return None;
        }
        self.heap.pop();
        Some((place, due))
    }
}
