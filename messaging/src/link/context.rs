//! State shared by the link's tasks and its handles.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use parking_lot::Mutex;
use time::OffsetDateTime;
use tokio::sync::{Notify, watch};

use super::state::{LinkPhase, LinkState};
use crate::{address::LogicalAddress, clock, config::Login, envelope::Envelope, spool::Backlog};

/// Most volatile messages that wait; beyond, the oldest are dropped.
pub(crate) const VOLATILE_MAX: usize = 4;

/// Signals to the link's tasks, and the state they report.
pub(crate) struct LinkContext {
    pub state: watch::Sender<LinkState>,
    /// Addresses to receive from.
    pub consumed: watch::Sender<Vec<LogicalAddress>>,
    /// Login of the next connection.
    pub login: watch::Sender<Login>,
    /// Rows were added to the spool.
    pub wake: Notify,
    /// Rows of the spool wait again.
    pub rewind: Notify,
    /// The pause before the next attempt to connect ends now.
    pub reconnect: Notify,
    /// The spool is to be read from its beginning.
    pub restart: Notify,
    /// Volatile messages wait to be sent.
    pub has_volatile: Notify,
    volatile: Mutex<VecDeque<(LogicalAddress, Envelope)>>,
    backoff: BackoffRequest,
    /// Activities that fail though the link is up, each with the reason.
    obstacles: Mutex<BTreeMap<String, String>>,
    has_data_flowed: AtomicBool,
}

/// A requested back-off of the whole link.
#[derive(Default)]
struct BackoffRequest {
    notify: Notify,
    /// Its reason and length.
    requested: Mutex<Option<(String, Duration)>>,
}

impl LinkContext {
    pub(crate) fn new(broker: String, consumed: Vec<LogicalAddress>, login: Login) -> Self {
        Self {
            state: watch::Sender::new(LinkState::initial(broker, clock::now())),
            consumed: watch::Sender::new(consumed),
            login: watch::Sender::new(login),
            wake: Notify::new(),
            rewind: Notify::new(),
            reconnect: Notify::new(),
            restart: Notify::new(),
            has_volatile: Notify::new(),
            volatile: Mutex::default(),
            backoff: BackoffRequest::default(),
            obstacles: Mutex::default(),
            has_data_flowed: AtomicBool::new(false),
        }
    }

    pub(crate) fn enter(&self, phase: LinkPhase, broker: &str, reason: Option<String>) {
        metrics::gauge!("link_up").set(if phase == LinkPhase::Up { 1.0 } else { 0.0 });
        if phase == LinkPhase::Up {
            metrics::counter!("link_connects_total").increment(1);
            // They belonged to the connection before.
            self.obstacles.lock().clear();
            self.has_data_flowed.store(false, Ordering::Relaxed);
        }
        // Some brokers close the connection over a request that they refuse. Without the obstacle
        // the reason would not say which.
        let obstacle = if matches!(phase, LinkPhase::Down { .. }) {
            summary(&self.obstacles.lock())
        } else {
            None
        };
        let reason = match (reason, obstacle) {
            (Some(reason), Some(obstacle)) => Some(format!("{reason}; before that, {obstacle}")),
            (reason, obstacle) => reason.or(obstacle),
        };
        self.state.send_modify(|state| {
            if phase == LinkPhase::Up {
                state.connects += 1;
            }
            broker.clone_into(&mut state.broker);
            state.enter(phase, reason, clock::now());
        });
    }

    pub(crate) fn accepted(&self, at: OffsetDateTime) {
        self.has_data_flowed.store(true, Ordering::Relaxed);
        self.state.send_modify(|state| state.last_accepted_at = Some(at));
    }

    pub(crate) fn received(&self, at: OffsetDateTime) {
        self.has_data_flowed.store(true, Ordering::Relaxed);
        self.state.send_modify(|state| state.last_received_at = Some(at));
    }

    /// Queues a volatile message for the present connection, or for the next one.
    pub(crate) fn send_volatile(&self, address: LogicalAddress, envelope: Envelope) {
        self.put_back_volatile(address, envelope);
        self.has_volatile.notify_one();
    }

    /// Queues a volatile message that cannot be sent at the moment, without a signal.
    pub(crate) fn put_back_volatile(&self, address: LogicalAddress, envelope: Envelope) {
        let mut volatile = self.volatile.lock();
        volatile.push_back((address, envelope));
        while volatile.len() > VOLATILE_MAX {
            volatile.pop_front();
        }
    }

    /// Takes the volatile messages that wait, oldest first.
    pub(crate) fn take_volatile(&self) -> VecDeque<(LogicalAddress, Envelope)> {
        std::mem::take(&mut self.volatile.lock())
    }

    /// Requests a back-off of the whole link.
    pub(crate) fn back_off(&self, reason: String, pause: Duration) {
        *self.backoff.requested.lock() = Some((reason, pause));
        self.backoff.notify.notify_one();
    }

    /// Waits until a back-off is requested.
    pub(crate) async fn backoff_requested(&self) {
        loop {
            self.backoff.notify.notified().await;
            if self.backoff.requested.lock().is_some() {
                return;
            }
        }
    }

    /// Takes the requested back-off.
    pub(crate) fn take_backoff(&self) -> Option<(String, Duration)> {
        self.backoff.requested.lock().take()
    }

    /// Returns whether a message was accepted or received since the connection is up.
    pub(crate) fn has_data_flowed(&self) -> bool {
        self.has_data_flowed.load(Ordering::Relaxed)
    }

    pub(crate) fn set_backlog(&self, backlog: Backlog) {
        #[allow(clippy::cast_precision_loss)]
        metrics::gauge!("link_backlog").set(backlog.waiting as f64);
        self.state.send_if_modified(|state| {
            let is_new = state.backlog != backlog;
            state.backlog = backlog;
            is_new
        });
    }

    /// Notes that an activity of the link fails though the link is up.
    pub(crate) fn report_obstacle(&self, activity: &str, reason: String) {
        let reason = {
            let mut obstacles = self.obstacles.lock();
            obstacles.insert(activity.to_owned(), reason);
            summary(&obstacles)
        };
        self.set_reason(reason);
    }

    /// Notes that an activity works again.
    pub(crate) fn clear_obstacle(&self, activity: &str) {
        let reason = {
            let mut obstacles = self.obstacles.lock();
            obstacles.remove(activity);
            summary(&obstacles)
        };
        self.set_reason(reason);
    }

    /// Sets the reason that is shown while the link is up.
    fn set_reason(&self, reason: Option<String>) {
        self.state.send_if_modified(|state| {
            let is_new = state.is_up() && state.reason != reason;
            if is_new {
                state.reason = reason;
            }
            is_new
        });
    }
}

/// Describes one obstacle, with the number of others.
fn summary(obstacles: &BTreeMap<String, String>) -> Option<String> {
    obstacles.iter().next().map(|(activity, reason)| match obstacles.len() {
        1 => format!("{activity}: {reason}"),
        n => format!("{activity}: {reason} (and {} more)", n - 1),
    })
}
