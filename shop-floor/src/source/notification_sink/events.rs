//! Events on their way to the inputs that take them.

use std::sync::atomic::Ordering;

use asi_model::values::{DataValue, StatusCode, Variant};
use opcua_stack::{opcua::types::EventFieldList, values::variant_from_stack};

use super::{NotificationSink, count_overflows};
use crate::{InputChange, clock, source::events::Reaction};

impl NotificationSink {
    /// Accepts notified events.
    pub(super) fn accept_events(&self, events: impl Iterator<Item = EventFieldList>) {
        let namespaces = self.connection.namespaces();
        let (mut values, mut overflows, mut unreadable) = (Vec::new(), 0_u64, 0_u64);
        let mut is_refresh_needed = false;
        let mut slots = self.slots.lock();
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        for event in events {
            let Some(slot) = slots.get_mut(event.client_handle) else { continue };
            let Some(reduction) = &mut slot.events else { continue };
            let fields = event.event_fields.into_iter().flatten();
            let fields =
                fields.map(|field| variant_from_stack(field, &namespaces).unwrap_or(Variant::Null));
            match reduction.take(fields.collect()) {
                Reaction::Value(value) => values.push((event.client_handle, value)),
                Reaction::Nothing => {}
                Reaction::RefreshNeeded => is_refresh_needed = true,
                Reaction::Overflow => {
                    is_refresh_needed |= reduction.is_of_conditions();
                    slot.overflows += 1;
                    overflows += 1;
                }
                Reaction::Unreadable => unreadable += 1,
            }
        }
        self.take(&mut slots, values);
        drop(slots);
        if is_refresh_needed {
            self.refresh_needed.notify_one();
        }
        count_overflows(overflows);
        if unreadable > 0 {
            metrics::counter!("shop_floor_events_unreadable_total").increment(unreadable);
        }
    }

    /// Says that an input has no value yet although the server monitors it: its first event is still to come. Where the value
    /// follows from conditions, the server is asked for them.
    pub(in crate::source) fn await_first_event(&self, handle: u32) {
        let slots = self.slots.lock();
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        let Some(slot) = slots.get(handle).filter(|slot| slot.last.is_none()) else { return };
        if slot.events.as_ref().is_some_and(|events| events.is_of_conditions()) {
            self.refresh_needed.notify_one();
            return;
        }
        // Without a time: the first event may be older than this by the server's clock.
        let value = DataValue::status_only(StatusCode::BAD_WAITING_FOR_INITIAL_DATA, None);
        self.changes.push(vec![InputChange { input: slot.input, value }]);
    }

    /// Continues with the last event of the session before; those between were lost.
    pub(in crate::source) fn resume_with(&self, handle: u32, last: &DataValue) {
        let mut slots = self.slots.lock();
        let is_first = slots.get(handle).is_some_and(|slot| slot.last.is_none());
        if is_first && !self.is_closed.load(Ordering::SeqCst) {
            let status = StatusCode::UNCERTAIN_LAST_USABLE_VALUE;
            self.take(&mut slots, vec![(handle, DataValue { status, ..last.clone() })]);
        }
    }

    /// Goes on without the conditions that were active before, which the server does not name.
    pub(in crate::source) fn give_up_refresh(&self) {
        let now = clock::now();
        let mut slots = self.slots.lock();
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        let mut values = Vec::new();
        for handle in slots.of_conditions() {
            let events = slots.get_mut(handle).and_then(|slot| slot.events.as_mut());
            if let Some(value) = events.and_then(|events| events.give_up_refresh(now)) {
                values.push((handle, value));
            }
        }
        self.take(&mut slots, values);
    }

    /// Returns true while an input waits for the conditions that the server is to name.
    pub(in crate::source) fn awaits_conditions(&self) -> bool {
        let slots = self.slots.lock();
        slots.of_conditions().into_iter().any(|handle| {
            let events = slots.get(handle).and_then(|slot| slot.events.as_ref());
            events.is_some_and(|events| events.awaits_conditions())
        })
    }
}
