//! Notifications of one session on their way to the outbox.
//!
//! The callbacks run on the session's event loop: they convert, note and hand over, and never wait.

use std::{
    collections::{HashSet, VecDeque},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use asi_model::values::{DataValue, ExtensionBody, Namespace, Scalar, StatusCode, Variant};
use opcua_stack::{
    notifications::DataChanges,
    opcua::{
        client::{MonitoredItemMap, OnSubscriptionNotificationCore},
        types::{NotificationMessage, StatusChangeNotification, match_extension_object_owned},
    },
};
use parking_lot::Mutex;
use tokio::sync::Notify;

use super::{Connection, entry::Entry};
use crate::{InputChange, InputKey, outbox::Outbox};

/// The info bits that say that a queue overflowed (OPC 10000-4 §7.39.1: InfoType DataValue,
/// Overflow).
const OVERFLOW_BITS: u32 = 0x0000_0480;

/// How long a freed client handle rests.
const HANDLE_REST: Duration = Duration::from_secs(60);

pub(crate) struct Feed {
    entry: Arc<Entry>,
    outbox: Outbox,
    connection: Connection,
    slots: Mutex<Slots>,
    live: AtomicUsize,
    is_closed: AtomicBool,
    /// When each subscription was last heard of; `None` while it has no items and nothing is to be
    /// heard.
    heard: Mutex<Vec<Option<Instant>>>,
    /// Woken when a structure arrived that needs the server's data types.
    pub(super) types_needed: Notify,
    /// Woken when the server ended a subscription.
    pub(super) subscription_ended: Notify,
}

#[derive(Default)]
struct Slots {
    /// By client handle; handle 0 is never used.
    slots: Vec<Option<Slot>>,
    /// Handles that are free again, and since when: what was queued for the old item must not reach
    /// a new one.
    free: VecDeque<(Instant, u32)>,
}

struct Slot {
    input: InputKey,
    last: Option<DataValue>,
    last_at: Instant,
    /// A structure that waits for its data type.
    is_held: bool,
}

/// What the audit compares.
pub(super) struct LastSeen {
    pub(super) handle: u32,
    pub(super) input: InputKey,
    pub(super) value: DataValue,
    pub(super) at: Instant,
}

impl Feed {
    pub(super) fn new(entry: Arc<Entry>, outbox: Outbox, connection: Connection) -> Self {
        Self {
            entry,
            outbox,
            connection,
            slots: Mutex::new(Slots { slots: vec![None], free: VecDeque::new() }),
            live: AtomicUsize::new(0),
            is_closed: AtomicBool::new(false),
            heard: Mutex::default(),
            types_needed: Notify::new(),
            subscription_ended: Notify::new(),
        }
    }

    /// How many inputs have had a value in this session.
    pub(super) fn live(&self) -> usize {
        self.live.load(Ordering::Relaxed)
    }

    pub(super) fn live_inputs(&self) -> HashSet<InputKey> {
        let slots = self.slots.lock();
        slots
            .slots
            .iter()
            .flatten()
            .filter(|slot| slot.last.is_some())
            .map(|slot| slot.input)
            .collect()
    }

    /// A new subscription's place among those that are listened to.
    pub(super) fn add_subscription(&self) -> usize {
        let mut heard = self.heard.lock();
        heard.push(None);
        heard.len() - 1
    }

    /// From now on a subscription is to be heard of.
    pub(super) fn expect(&self, subscription: usize) {
        self.heard.lock()[subscription].get_or_insert_with(Instant::now);
    }

    /// The longest time that any subscription with items has been silent; `None` while there is
    /// none.
    pub(super) fn silence(&self) -> Option<Duration> {
        self.heard.lock().iter().flatten().map(Instant::elapsed).max()
    }

    /// All subscriptions count as heard of just now.
    pub(super) fn excuse_silence(&self) {
        self.heard.lock().iter_mut().flatten().for_each(|heard| *heard = Instant::now());
    }

    /// A client handle for an input.
    pub(super) fn reserve(&self, input: InputKey) -> u32 {
        let mut slots = self.slots.lock();
        let slot = Some(Slot { input, last: None, last_at: Instant::now(), is_held: false });
        if slots.free.front().is_some_and(|(freed_at, _)| freed_at.elapsed() > HANDLE_REST) {
            let (_, handle) = slots.free.pop_front().expect("it was just seen");
            slots.slots[handle as usize] = slot;
            handle
        } else {
            slots.slots.push(slot);
            u32::try_from(slots.slots.len() - 1).expect("inputs are limited far below 2^32")
        }
    }

    /// Frees a handle whose monitored item does not exist (any more).
    pub(super) fn release(&self, handle: u32) {
        let mut slots = self.slots.lock();
        if let Some(slot) = slots.slots.get_mut(handle as usize).and_then(Option::take) {
            if slot.last.is_some() {
                self.live.fetch_sub(1, Ordering::Relaxed);
            }
            slots.free.push_back((Instant::now(), handle));
        }
    }

    /// Nothing passes any more.
    pub(super) fn close(&self) {
        self.is_closed.store(true, Ordering::SeqCst);
        // Whoever is inside a callback finishes before this lock is got.
        self.slots.lock().slots.clear();
        self.live.store(0, Ordering::Relaxed);
    }

    /// Inputs whose structures wait for data types; they no longer wait.
    pub(super) fn take_held(&self) -> Vec<(u32, InputKey)> {
        let mut slots = self.slots.lock();
        let mut held = Vec::new();
        for (handle, slot) in (0_u32..).zip(slots.slots.iter_mut()) {
            if let Some(slot) = slot.as_mut().filter(|slot| slot.is_held) {
                slot.is_held = false;
                held.push((handle, slot.input));
            }
        }
        held
    }

    /// Values that were read instead of notified, by handle.
    pub(super) fn deliver(&self, values: Vec<(u32, DataValue)>) {
        self.accept(values);
    }

    /// The last notified values of up to `count` inputs, from `start` on, that are older than
    /// `age`.
    pub(super) fn last_seen(
        &self,
        start: usize,
        count: usize,
        older_than: Instant,
    ) -> (Vec<LastSeen>, usize) {
        let slots = self.slots.lock();
        let total = slots.slots.len();
        let mut seen = Vec::new();
        let mut position = if start < total { start } else { 0 };
        for _ in 0..total {
            if seen.len() >= count {
                break;
            }
            if let Some(slot) = &slots.slots[position]
                && let Some(value) =
                    slot.last.as_ref().filter(|_| slot.last_at < older_than && !slot.is_held)
            {
                seen.push(LastSeen {
                    handle: u32::try_from(position).unwrap_or(0),
                    input: slot.input,
                    value: value.clone(),
                    at: slot.last_at,
                });
            }
            position = (position + 1) % total;
        }
        (seen, position)
    }

    /// When an input was last notified.
    pub(super) fn last_at(&self, handle: u32) -> Option<Instant> {
        self.slots.lock().slots.get(handle as usize)?.as_ref().map(|slot| slot.last_at)
    }

    fn accept(&self, values: Vec<(u32, DataValue)>) {
        let at = Instant::now();
        let types_settled = self.connection.are_types_settled();
        let mut changes = Vec::with_capacity(values.len());
        let (mut held, mut overflows) = (false, 0_u64);
        let mut slots = self.slots.lock();
        if self.is_closed.load(Ordering::SeqCst) {
            return;
        }
        for (handle, value) in values {
            // A handle may be freed while its last notification is on the way.
            let Some(slot) = slots.slots.get_mut(handle as usize).and_then(Option::as_mut) else {
                continue;
            };
            if slot.last.is_none() {
                self.live.fetch_add(1, Ordering::Relaxed);
            }
            slot.last_at = at;
            slot.last = Some(value.clone());
            slot.is_held = !types_settled && is_undecoded(&value);
            overflows += u64::from(value.status.0 & OVERFLOW_BITS == OVERFLOW_BITS);
            if slot.is_held {
                held = true;
            } else {
                changes.push(InputChange { input: slot.input, value });
            }
        }
        self.entry.meter.sign_of_life(changes.len() as u64);
        // Still under the lock, so that nothing passes after `close`.
        self.outbox.push(changes);
        drop(slots);
        if held {
            self.types_needed.notify_one();
        }
        if overflows > 0 {
            metrics::counter!("shop_floor_queue_overflows_total").increment(overflows);
        }
    }
}

/// What one subscription is told.
pub(super) struct Listener {
    feed: Arc<Feed>,
    subscription: usize,
}

impl Listener {
    pub(super) const fn new(feed: Arc<Feed>, subscription: usize) -> Self {
        Self { feed, subscription }
    }
}

impl OnSubscriptionNotificationCore for Listener {
    fn on_subscription_notification(
        &mut self,
        message: NotificationMessage,
        _items: MonitoredItemMap<'_>,
    ) {
        // Any publish response is a sign of life, with or without data.
        self.feed.heard.lock()[self.subscription] = Some(Instant::now());
        self.feed.entry.meter.sign_of_life(0);
        for notification in message.notification_data.into_iter().flatten() {
            let notification = match DataChanges::take(notification) {
                Ok(changes) => {
                    self.feed.accept(changes.into_values(&self.feed.connection.namespaces()));
                    continue;
                }
                Err(other) => other,
            };
            match_extension_object_owned!(notification,
                status: StatusChangeNotification => {
                    tracing::info!(source.id = %self.feed.entry.id, status = %status.status,
                        "The server ended a subscription.");
                    self.feed.subscription_ended.notify_one();
                },
                _ => {}
            );
        }
    }
}

/// True for a structure of the server's own whose fields are not known.
pub(super) fn is_undecoded(value: &DataValue) -> bool {
    let is_raw = |scalar: &Scalar| match scalar {
        Scalar::ExtensionObject(object) => {
            matches!(object.body, ExtensionBody::Binary(_))
                && object.type_id.node_id.namespace != Namespace::Ua
        }
        _ => false,
    };
    value.status != StatusCode::BAD_DECODING_ERROR
        && match &value.value {
            Variant::Scalar(scalar) => is_raw(scalar),
            Variant::Array(array) => array.elements.first().is_some_and(is_raw),
            Variant::Null => false,
        }
}
