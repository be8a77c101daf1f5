//! Sink for the notifications of one session: data changes and events.
//!
//! The stack calls it on the session's event loop: it converts values, remembers the last one of
//! each item and sends changes to the consumer's queue. It never waits.

mod events;
mod gap_hold;
mod gaps;
mod item_slots;

use std::{
    collections::{HashMap, HashSet},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use asi_model::values::DataValue;
use opcua_stack::{
    notifications::DataChanges,
    opcua::{
        client::{MonitoredItemMap, OnSubscriptionNotificationCore},
        types::{
            EventNotificationList, NotificationMessage, StatusChangeNotification,
            match_extension_object_owned,
        },
    },
};
use parking_lot::Mutex;
use tokio::sync::Notify;

use super::{
    activity::ActivityCounters, connection::Connection, events::EventReduction,
    services::is_undecoded,
};
use crate::{InputChange, InputKey, MonitorRequest, SourceId, change_queue::ChangeQueue};

pub(super) use gap_hold::FilledGap;
pub(super) use item_slots::LastNotified;

use item_slots::ItemSlots;

/// Info bits of a status that say that the item's queue overflowed (OPC 10000-4 §7.39.1: InfoType
/// DataValue, Overflow).
const OVERFLOW_BITS: u32 = 0x0000_0480;

pub(super) struct NotificationSink {
    source: SourceId,
    activity: Arc<ActivityCounters>,
    changes: ChangeQueue,
    connection: Connection,
    slots: Mutex<ItemSlots>,
    live: AtomicUsize,
    is_closed: AtomicBool,
    /// Subscriptions by listener index.
    listeners: Mutex<Vec<Listener>>,
    /// Woken when a structure arrived that needs the server's data types.
    pub(super) types_needed: Notify,
    /// Woken when the server ended a subscription.
    pub(super) subscription_ended: Notify,
    /// Woken when the server is to be asked for all conditions.
    pub(super) refresh_needed: Notify,
}

/// Subscription as far as its messages are concerned.
#[derive(Debug, Default)]
struct Listener {
    /// Time of its last message; `None` while it has no items and the server owes no message.
    last_message: Option<Instant>,
    silence_limit: Duration,
}

impl NotificationSink {
    pub(super) fn new(
        source: SourceId,
        activity: Arc<ActivityCounters>,
        changes: ChangeQueue,
        connection: Connection,
    ) -> Self {
        Self {
            source,
            activity,
            changes,
            connection,
            slots: Mutex::new(ItemSlots::new()),
            live: AtomicUsize::new(0),
            is_closed: AtomicBool::new(false),
            listeners: Mutex::default(),
            types_needed: Notify::new(),
            subscription_ended: Notify::new(),
            refresh_needed: Notify::new(),
        }
    }

    /// Returns the number of inputs that have had a value in this session.
    pub(super) fn live(&self) -> usize {
        self.live.load(Ordering::Relaxed)
    }

    /// Returns the inputs of which the server's queue overflowed, with the number of times.
    pub(super) fn overflows(&self) -> HashMap<InputKey, u64> {
        self.slots.lock().overflows()
    }

    pub(super) fn live_inputs(&self) -> HashSet<InputKey> {
        self.slots.lock().live_inputs()
    }

    /// Returns the listener index of a new subscription.
    pub(super) fn add_listener(&self) -> usize {
        let mut listeners = self.listeners.lock();
        listeners.push(Listener::default());
        listeners.len() - 1
    }

    /// Sets the silence after which a subscription is given up.
    pub(super) fn set_silence_limit(&self, listener: usize, limit: Duration) {
        self.listeners.lock()[listener].silence_limit = limit;
    }

    /// Returns the longest silence after which a subscription is given up; zero while there is none.
    pub(super) fn silence_limit_max(&self) -> Duration {
        let listeners = self.listeners.lock();
        listeners.iter().map(|listener| listener.silence_limit).max().unwrap_or_default()
    }

    /// Starts to measure the silence of a subscription.
    pub(super) fn expect_messages(&self, listener: usize) {
        self.listeners.lock()[listener].last_message.get_or_insert_with(Instant::now);
    }

    /// Returns true while a server owes messages: a subscription has items.
    pub(super) fn expects_messages(&self) -> bool {
        self.listeners.lock().iter().any(|listener| listener.last_message.is_some())
    }

    /// Returns the silence of a subscription that has been silent for longer than its limit.
    pub(super) fn exceeded_silence(&self) -> Option<Duration> {
        let listeners = self.listeners.lock();
        let silences = listeners.iter().filter_map(|listener| {
            let silence = listener.last_message?.elapsed();
            (silence > listener.silence_limit).then_some(silence)
        });
        silences.max()
    }

    /// Measures the silence of all subscriptions from now on.
    pub(super) fn reset_silence(&self) {
        let mut listeners = self.listeners.lock();
        let waited_for = listeners.iter_mut().filter_map(|one| one.last_message.as_mut());
        waited_for.for_each(|at| *at = Instant::now());
    }

    /// Returns a client handle for a new item of an input.
    pub(super) fn reserve(&self, request: &Arc<MonitorRequest>) -> u32 {
        let events = EventReduction::new(request);
        self.slots.lock().reserve(request.input, events)
    }

    /// Releases the client handle of an item that does not exist.
    pub(super) fn release(&self, handle: u32) {
        let released = self.slots.lock().release(handle);
        if released.is_some_and(|slot| slot.last.is_some()) {
            self.live.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Drops all later notifications.
    pub(super) fn close(&self) {
        self.is_closed.store(true, Ordering::SeqCst);
        // A callback that runs now finishes first: it holds this lock.
        self.slots.lock().clear();
        self.live.store(0, Ordering::Relaxed);
    }

    /// Returns handles and inputs whose values await a data type; they no longer do.
    pub(super) fn take_awaiting_type(&self) -> Vec<(u32, InputKey)> {
        self.slots.lock().take_awaiting_type()
    }

    /// Returns up to `count` last values that were notified before `older_than`, in the order of
    /// their handles from `start` on, and the handle to continue with.
    pub(super) fn last_notified(
        &self,
        start: usize,
        count: usize,
        older_than: Instant,
    ) -> (Vec<LastNotified>, usize) {
        self.slots.lock().last_notified(start, count, older_than)
    }

    /// Returns the time of an item's last notification.
    pub(super) fn last_notified_at(&self, handle: u32) -> Option<Instant> {
        self.slots.lock().get(handle).map(|slot| slot.last_at)
    }

    /// Returns the last value of an item that was sent.
    pub(super) fn last_value(&self, handle: u32) -> Option<DataValue> {
        let slots = self.slots.lock();
        slots.get(handle).filter(|slot| slot.hold.is_none())?.last.clone()
    }

    /// Accepts values by client handle, notified or read.
    pub(super) fn accept(&self, values: Vec<(u32, DataValue)>) {
        let mut slots = self.slots.lock();
        if !self.is_closed.load(Ordering::SeqCst) {
            self.take(&mut slots, values);
        }
    }

    /// Takes values while their slots are locked, so that nothing is sent after `close`.
    fn take(&self, slots: &mut ItemSlots, values: Vec<(u32, DataValue)>) {
        let at = Instant::now();
        let types_settled = self.connection.are_types_settled();
        let mut changes = Vec::with_capacity(values.len());
        let (mut needs_types, mut overflows) = (false, 0_u64);
        for (handle, value) in values {
            // A handle may be released while its last notification is on the way.
            let Some(slot) = slots.get_mut(handle) else { continue };
            if slot.last.is_none() {
                self.live.fetch_add(1, Ordering::Relaxed);
            }
            slot.last_at = at;
            // The audit compares this copy with what the server returns on read. Texts and byte
            // strings are shared; only arrays and structures are copied.
            slot.last = Some(value.clone());
            // An event cannot be read again once the type is known.
            let is_unknown = !types_settled && is_undecoded(&value);
            needs_types |= is_unknown;
            slot.awaits_type = slot.events.is_none() && is_unknown;
            let has_overflown = u64::from(value.status.0 & OVERFLOW_BITS == OVERFLOW_BITS);
            slot.overflows += has_overflown;
            overflows += has_overflown;
            let input = slot.input;
            if slot.awaits_type {
                // Read again once its type is known.
            } else if slot.hold.is_some() {
                let values = slot.in_order(value).into_iter();
                changes.extend(values.map(|value| InputChange { input, value }));
            } else {
                changes.push(InputChange { input, value });
            }
        }
        self.activity.record(changes.len() as u64);
        self.changes.push(changes);
        if needs_types {
            self.types_needed.notify_one();
        }
        count_overflows(overflows);
    }
}

fn count_overflows(overflows: u64) {
    if overflows > 0 {
        metrics::counter!("shop_floor_queue_overflows_total").increment(overflows);
    }
}

/// Callback of one subscription.
pub(super) struct SubscriptionListener {
    sink: Arc<NotificationSink>,
    index: usize,
}

impl SubscriptionListener {
    pub(super) const fn new(sink: Arc<NotificationSink>, index: usize) -> Self {
        Self { sink, index }
    }
}

impl OnSubscriptionNotificationCore for SubscriptionListener {
    fn on_subscription_notification(
        &mut self,
        message: NotificationMessage,
        _items: MonitoredItemMap<'_>,
    ) {
        let sink = &self.sink;
        // Any publish response is a sign of life, with or without data.
        sink.listeners.lock()[self.index].last_message = Some(Instant::now());
        sink.activity.record(0);
        for notification in message.notification_data.into_iter().flatten() {
            let notification = match DataChanges::take(notification) {
                Ok(changes) => {
                    sink.accept(changes.into_values(&sink.connection.namespaces()));
                    continue;
                }
                Err(other) => other,
            };
            match_extension_object_owned!(notification,
                list: EventNotificationList => {
                    sink.accept_events(list.events.into_iter().flatten());
                },
                status: StatusChangeNotification => {
                    tracing::info!(source.id = %sink.source, status = %status.status,
                        "The server ended a subscription.");
                    sink.subscription_ended.notify_one();
                },
                _ => {}
            );
        }
    }
}
