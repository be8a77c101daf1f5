//! Gaps in the values of items, filled from the server's history.

use std::{collections::HashMap, sync::atomic::Ordering};

use asi_model::values::{DataValue, DateTime};

use super::{FilledGap, NotificationSink, gap_hold::GapHold};
use crate::{InputChange, InputKey};

impl NotificationSink {
    /// Lets the values of an item wait for those since a time.
    pub(in crate::source) fn hold(&self, handle: u32, since: DateTime) {
        if let Some(slot) = self.slots.lock().get_mut(handle) {
            slot.hold = Some(Box::new(GapHold::new(since)));
        }
    }

    /// Sets the values of a gap, oldest first, unless it has some; none where the server has none.
    pub(in crate::source) fn fill(&self, handle: u32, past: Vec<DataValue>, is_complete: bool) {
        let mut slots = self.slots.lock();
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        let Some(slot) = slots.get_mut(handle) else { return };
        let input = slot.input;
        let values = slot.fill(past, is_complete).into_iter();
        let changes: Vec<_> = values.map(|value| InputChange { input, value }).collect();
        if !changes.is_empty() {
            self.activity.record(changes.len() as u64);
            self.changes.push(changes);
        }
    }

    /// Returns the inputs of which a gap was filled in this session.
    pub(in crate::source) fn filled(&self) -> HashMap<InputKey, FilledGap> {
        self.slots.lock().filled()
    }
}
