//! Sending state per address. An address that fails backs off, longer each time, without disturbing
//! the others.

use std::{collections::HashMap, sync::Arc, time::Duration};

use tokio::{sync::mpsc, task::JoinSet, time::Instant};

use super::address_sender::{AddressSender, SenderContext, SenderEvent};
use crate::{
    address::LogicalAddress,
    config::LinkLimits,
    link::context::VOLATILE_MAX,
    profile::BrokerProfile,
    spool::{RowId, SpoolRow, SpoolStore},
    transport::Connection,
};

/// Windows that all addresses share at most.
const WINDOWS_MAX: usize = 4;
/// Longest back-off of an address, as a multiple of the first.
const BACKOFF_FACTOR_MAX: u32 = 64;

/// The addresses that a connection sends to, with their sender tasks and the rows in flight.
pub(super) struct Addresses {
    context: SenderContext,
    profile: BrokerProfile,
    tasks: JoinSet<()>,
    states: HashMap<LogicalAddress, AddressState>,
    in_flight: HashMap<RowId, AddressInFlight>,
    /// Most rows in flight per address.
    window: usize,
    /// First back-off; doubles with each failure in a row.
    backoff: Duration,
}

#[derive(Default)]
struct AddressState {
    sender: Option<AddressSender>,
    in_flight: usize,
    /// Failures since the last accepted message. After one, messages are sent one at a time.
    failures: u32,
    backoff_until: Option<Instant>,
    /// True when rows were skipped, so that the spool must be read again.
    has_skipped: bool,
}

/// A row that was sent and has no outcome yet.
struct AddressInFlight {
    address: LogicalAddress,
    /// Number of earlier rejections.
    attempts: u32,
    is_receipted: bool,
}

/// A row that left the flight.
pub(super) struct Settled {
    pub address: LogicalAddress,
    /// Number of earlier rejections.
    pub attempts: u32,
    /// True where its receiver sends a receipt for it.
    pub is_receipted: bool,
    /// True when there is room again for rows that were skipped.
    pub needs_rewind: bool,
}

/// An address that works again after failures.
pub(super) struct Recovery {
    /// True when rows were skipped meanwhile.
    pub needs_rewind: bool,
}

impl Addresses {
    /// Returns the addresses, none yet, with the events of their sender tasks.
    pub(super) fn new(
        connection: Arc<dyn Connection>,
        store: Arc<dyn SpoolStore>,
        profile: BrokerProfile,
        limits: &LinkLimits,
    ) -> (Self, mpsc::Receiver<SenderEvent>) {
        let window = limits.window.max(1);
        let (events, arrived) = mpsc::channel(window * WINDOWS_MAX);
        let addresses = Self {
            context: SenderContext { connection, store, events, queue_max: window + VOLATILE_MAX },
            profile,
            tasks: JoinSet::new(),
            states: HashMap::new(),
            in_flight: HashMap::new(),
            window,
            backoff: limits.address_backoff,
        };
        (addresses, arrived)
    }

    /// Most rows in flight to all addresses together.
    pub(super) fn window(&self) -> usize {
        self.window * self.states.len().clamp(1, WINDOWS_MAX)
    }

    /// Rows in flight to all addresses together.
    pub(super) fn in_flight(&self) -> usize {
        self.in_flight.len()
    }

    pub(super) fn is_backing_off(&self, address: &LogicalAddress) -> bool {
        self.states.get(address).is_some_and(|state| state.backoff_until.is_some())
    }

    /// Hands a row to the sender task of its address, which is started when there is none. Returns
    /// false when the row cannot be sent at the moment; a row of the spool then counts as skipped.
    pub(super) fn send(&mut self, row: SpoolRow, is_volatile: bool) -> bool {
        let state = self.states.entry(row.address.clone()).or_default();
        // After a failure one at a time, so that the message that the broker refuses shows.
        let room = if state.failures > 0 { 1 } else { self.window };
        // Skipped rows go first, so no row behind them may overtake. Volatile messages have no
        // position among the rows.
        let is_full = state.has_skipped || state.in_flight >= room;
        let (id, address, attempts) = (row.id, row.address.clone(), row.attempts);
        let is_receipted = self.context.store.is_receipted(&row);
        let is_sent = state.backoff_until.is_none() && (is_volatile || !is_full) && {
            let sender = state.sender.get_or_insert_with(|| {
                let terminus = self.profile.produce(&address);
                AddressSender::start(&mut self.tasks, &self.context, address.clone(), terminus)
            });
            // Fails while the task is ending; another one is started once its end is known.
            sender.send(row)
        };
        if is_sent {
            state.in_flight += 1;
            self.in_flight.insert(id, AddressInFlight { address, attempts, is_receipted });
        } else {
            state.has_skipped |= !is_volatile;
        }
        is_sent
    }

    /// Calls the task of an address on to send again, after a row was recalled.
    pub(super) fn send_on(&mut self, address: &LogicalAddress) {
        if let Some(sender) = self.states.get_mut(address).and_then(|state| state.sender.as_mut()) {
            sender.send_on();
        }
    }

    /// Takes a row out of flight; none when it was not in flight.
    pub(super) fn settle(&mut self, id: RowId) -> Option<Settled> {
        let AddressInFlight { address, attempts, is_receipted } = self.in_flight.remove(&id)?;
        let mut needs_rewind = false;
        if let Some(state) = self.states.get_mut(&address) {
            state.in_flight = state.in_flight.saturating_sub(1);
            if state.has_skipped
                && state.backoff_until.is_none()
                // Not before half of the window is free: each row that settles would else read the
                // spool again.
                && state.in_flight * 2 <= self.window
            {
                state.has_skipped = false;
                needs_rewind = true;
            }
        }
        Some(Settled { address, attempts, is_receipted, needs_rewind })
    }

    /// Takes rows out of flight without room for others, as when the link stops.
    pub(super) fn forget(&mut self, is_forgotten: impl Fn(&RowId) -> bool) {
        self.in_flight.retain(|id, _| !is_forgotten(id));
    }

    /// Notes that the broker accepted a message; none when the address had not failed before.
    pub(super) fn on_accepted(&mut self, address: &LogicalAddress) -> Option<Recovery> {
        let state = self.states.get_mut(address).filter(|state| state.failures > 0)?;
        state.failures = 0;
        Some(Recovery { needs_rewind: std::mem::take(&mut state.has_skipped) })
    }

    /// Notes that the sender task of an address has ended, `in_order` when nothing was wrong.
    pub(super) fn on_sender_ended(&mut self, address: &LogicalAddress, in_order: bool) {
        if let Some(state) = self.states.get_mut(address) {
            state.sender = None;
            state.has_skipped &= !in_order;
        }
    }

    /// Lets an address back off. Returns the pause; none when it backs off already.
    pub(super) fn back_off(&mut self, address: &LogicalAddress, now: Instant) -> Option<Duration> {
        let state = self.states.get_mut(address)?;
        state.has_skipped = true;
        if state.backoff_until.is_some() {
            return None;
        }
        let factor = 1_u32.checked_shl(state.failures).unwrap_or(BACKOFF_FACTOR_MAX);
        let pause = self.backoff * factor.min(BACKOFF_FACTOR_MAX);
        state.failures = state.failures.saturating_add(1);
        state.backoff_until = Some(now + pause);
        Some(pause)
    }

    /// Ends the back-offs that are over. The caller reads the skipped rows again.
    pub(super) fn end_backoffs(&mut self, now: Instant) {
        for state in self.states.values_mut() {
            if state.backoff_until.is_some_and(|until| until <= now) {
                state.backoff_until = None;
                state.has_skipped = false;
            }
        }
    }

    /// Returns whether a sender task has panicked since the last call: its rows got no outcome.
    pub(super) fn has_task_panicked(&mut self) -> bool {
        let mut has_panicked = false;
        while let Some(ended) = self.tasks.try_join_next() {
            has_panicked |= ended.is_err();
        }
        has_panicked
    }

    /// Drops the sender tasks.
    pub(super) async fn shutdown(&mut self) {
        self.tasks.shutdown().await;
    }
}
