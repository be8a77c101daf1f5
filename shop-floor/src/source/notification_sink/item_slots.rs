//! Monitored items of a session by their client handles, with the last value of each.

use std::{
    collections::{HashMap, HashSet, VecDeque},
    time::{Duration, Instant},
};

use asi_model::values::DataValue;

use super::gap_hold::{FilledGap, GapHold};
use crate::{InputKey, source::events::EventReduction};

/// Time before a released client handle is used again: notifications that the server has queued
/// for the deleted item must not reach a new one.
const HANDLE_QUARANTINE: Duration = Duration::from_secs(60);

pub(super) struct ItemSlots {
    /// Index is the client handle; handle 0 is never used.
    slots: Vec<Option<ItemSlot>>,
    /// Released handles with the time of their release, oldest first.
    released: VecDeque<(Instant, u32)>,
}

pub(super) struct ItemSlot {
    pub(super) input: InputKey,
    pub(super) last: Option<DataValue>,
    pub(super) last_at: Instant,
    /// The last value is a structure of unknown type and was not sent to the consumer.
    pub(super) awaits_type: bool,
    /// Number of times that the server said that its queue overflowed.
    pub(super) overflows: u64,
    /// State of an input that takes events; `None` for a variable.
    pub(super) events: Option<Box<EventReduction>>,
    /// Values that wait for those of the gap before them.
    pub(super) hold: Option<Box<GapHold>>,
    /// Gap before the values of this session, where it was filled.
    filled: Option<Box<FilledGap>>,
}

/// Last value that was notified for an item.
pub(in crate::source) struct LastNotified {
    pub(in crate::source) handle: u32,
    pub(in crate::source) input: InputKey,
    pub(in crate::source) value: DataValue,
    pub(in crate::source) at: Instant,
}

impl ItemSlot {
    /// Takes a value of now; returns the values that are to be sent, in their order.
    pub(super) fn in_order(&mut self, value: DataValue) -> Vec<DataValue> {
        match &mut self.hold {
            Some(hold) => hold.wait(value),
            None => return vec![value],
        }
        self.release()
    }

    /// Sets the values of the gap; returns the values that are to be sent, in their order.
    pub(super) fn fill(&mut self, past: Vec<DataValue>, is_complete: bool) -> Vec<DataValue> {
        if let Some(hold) = &mut self.hold {
            hold.fill(past, is_complete);
        }
        self.release()
    }

    fn release(&mut self) -> Vec<DataValue> {
        let Some(hold) = self.hold.take_if(|hold| hold.is_over()) else { return Vec::new() };
        let (values, filled) = hold.release();
        self.filled = filled.map(Box::new);
        values
    }
}

impl ItemSlots {
    pub(super) fn new() -> Self {
        Self { slots: vec![None], released: VecDeque::new() }
    }

    /// Returns a client handle for a new item of an input.
    pub(super) fn reserve(&mut self, input: InputKey, events: Option<EventReduction>) -> u32 {
        let now = Instant::now();
        let slot = Some(ItemSlot {
            input,
            last: None,
            last_at: now,
            awaits_type: false,
            overflows: 0,
            events: events.map(Box::new),
            hold: None,
            filled: None,
        });
        let is_usable = |(at, _): &(Instant, u32)| now.duration_since(*at) > HANDLE_QUARANTINE;
        if self.released.front().is_some_and(is_usable) {
            let (_, handle) = self.released.pop_front().expect("the front was just seen");
            self.slots[handle as usize] = slot;
            handle
        } else {
            self.slots.push(slot);
            u32::try_from(self.slots.len() - 1).expect("inputs are limited far below 2^32")
        }
    }

    /// Releases the handle of a deleted item. Returns its slot, `None` for an unknown handle.
    pub(super) fn release(&mut self, handle: u32) -> Option<ItemSlot> {
        let slot = self.slots.get_mut(handle as usize)?.take()?;
        self.released.push_back((Instant::now(), handle));
        Some(slot)
    }

    pub(super) fn clear(&mut self) {
        self.slots.clear();
    }

    pub(super) fn get(&self, handle: u32) -> Option<&ItemSlot> {
        self.slots.get(handle as usize)?.as_ref()
    }

    pub(super) fn get_mut(&mut self, handle: u32) -> Option<&mut ItemSlot> {
        self.slots.get_mut(handle as usize)?.as_mut()
    }

    /// Returns the inputs of which a gap was filled.
    pub(super) fn filled(&self) -> HashMap<InputKey, FilledGap> {
        let slots = self.slots.iter().flatten();
        slots.filter_map(|slot| Some((slot.input, **slot.filled.as_ref()?))).collect()
    }

    /// Returns the handles of the items whose value follows from conditions.
    pub(super) fn of_conditions(&self) -> Vec<u32> {
        let is_of_conditions =
            |slot: &ItemSlot| slot.events.as_ref().is_some_and(|events| events.is_of_conditions());
        let slots = (0_u32..).zip(&self.slots);
        let found = slots.filter(|(_, slot)| slot.as_ref().is_some_and(is_of_conditions));
        found.map(|(handle, _)| handle).collect()
    }

    /// Returns the inputs that have had a value.
    pub(super) fn live_inputs(&self) -> HashSet<InputKey> {
        let live = self.slots.iter().flatten().filter(|slot| slot.last.is_some());
        live.map(|slot| slot.input).collect()
    }

    pub(super) fn overflows(&self) -> HashMap<InputKey, u64> {
        let overflown = self.slots.iter().flatten().filter(|slot| slot.overflows > 0);
        overflown.map(|slot| (slot.input, slot.overflows)).collect()
    }

    /// Returns handles and inputs whose values await a data type; they no longer do.
    pub(super) fn take_awaiting_type(&mut self) -> Vec<(u32, InputKey)> {
        let mut awaiting = Vec::new();
        for (handle, slot) in (0_u32..).zip(self.slots.iter_mut()) {
            if let Some(slot) = slot.as_mut().filter(|slot| slot.awaits_type) {
                slot.awaits_type = false;
                awaiting.push((handle, slot.input));
            }
        }
        awaiting
    }

    /// Returns up to `count` last values that were notified before `older_than`, in the order of
    /// their handles from `start` on, and the handle to continue with.
    pub(super) fn last_notified(
        &self,
        start: usize,
        count: usize,
        older_than: Instant,
    ) -> (Vec<LastNotified>, usize) {
        let total = self.slots.len();
        let mut found = Vec::new();
        let mut position = if start < total { start } else { 0 };
        for _ in 0..total {
            if found.len() >= count {
                break;
            }
            if let Some(slot) = &self.slots[position]
                && let Some(value) = &slot.last
                && slot.last_at < older_than
                && !slot.awaits_type
            {
                found.push(LastNotified {
                    handle: u32::try_from(position).unwrap_or(0),
                    input: slot.input,
                    value: value.clone(),
                    at: slot.last_at,
                });
            }
            position = (position + 1) % total;
        }
        (found, position)
    }
}
