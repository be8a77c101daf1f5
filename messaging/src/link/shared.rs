//! What the link's tasks and its handles share.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use parking_lot::Mutex;
use time::OffsetDateTime;
use tokio::sync::{Notify, watch};

use super::state::{LinkPhase, LinkState};
use crate::{address::LogicalAddress, envelope::Envelope, spool::Backlog};

/// Most messages that wait without being kept; beyond, the oldest go.
pub(crate) const POSTED_MAX: usize = 4;

pub(crate) struct Shared {
    pub state: watch::Sender<LinkState>,
    pub consumed: watch::Sender<Vec<LogicalAddress>>,
    pub wake: Notify,
    pub rewind: Notify,
    pub reconnect: Notify,
    pub anew: Notify,
    /// Something was posted.
    pub post: Notify,
    /// The link is to rest.
    pub rest: Notify,
    posted: Mutex<VecDeque<(LogicalAddress, Envelope)>>,
    resting: Mutex<Option<(String, Duration)>>,
    hindrances: Mutex<BTreeMap<String, String>>,
    has_data_flowed: AtomicBool,
}

impl Shared {
    pub(crate) fn new(broker: String, consumed: Vec<LogicalAddress>) -> Self {
        Self {
            state: watch::Sender::new(LinkState::initial(broker, OffsetDateTime::now_utc())),
            consumed: watch::Sender::new(consumed),
            wake: Notify::new(),
            rewind: Notify::new(),
            reconnect: Notify::new(),
            anew: Notify::new(),
            post: Notify::new(),
            rest: Notify::new(),
            posted: Mutex::default(),
            resting: Mutex::default(),
            hindrances: Mutex::default(),
            has_data_flowed: AtomicBool::new(false),
        }
    }

    pub(crate) fn enter(&self, phase: LinkPhase, broker: &str, reason: Option<String>) {
        metrics::gauge!("link_up").set(if phase == LinkPhase::Up { 1.0 } else { 0.0 });
        if phase == LinkPhase::Up {
            metrics::counter!("link_connects_total").increment(1);
            self.hindrances.lock().clear();
            self.has_data_flowed.store(false, Ordering::Relaxed);
        }
        // Some brokers close the connection over what they refuse: what was refused is the reason
        // to be told.
        let hindrance = if matches!(phase, LinkPhase::Down { .. }) {
            told(&self.hindrances.lock())
        } else {
            None
        };
        let reason = match (reason, hindrance) {
            (Some(reason), Some(hindrance)) => Some(format!("{reason}; before that, {hindrance}")),
            (reason, hindrance) => reason.or(hindrance),
        };
        self.state.send_modify(|state| {
            if phase == LinkPhase::Up {
                state.connects += 1;
            }
            broker.clone_into(&mut state.broker);
            state.enter(phase, reason, OffsetDateTime::now_utc());
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

    /// Lets a message go with the present connection, or with the next one.
    pub(crate) fn post(&self, address: LogicalAddress, envelope: Envelope) {
        self.put_back(address, envelope);
        self.post.notify_one();
    }

    /// Keeps a posted message that cannot go yet.
    pub(crate) fn put_back(&self, address: LogicalAddress, envelope: Envelope) {
        let mut posted = self.posted.lock();
        posted.push_back((address, envelope));
        while posted.len() > POSTED_MAX {
            posted.pop_front();
        }
    }

    /// What was posted and has not been sent.
    pub(crate) fn take_posted(&self) -> VecDeque<(LogicalAddress, Envelope)> {
        std::mem::take(&mut self.posted.lock())
    }

    /// Asks for a rest.
    pub(crate) fn rest(&self, reason: String, pause: Duration) {
        *self.resting.lock() = Some((reason, pause));
        self.rest.notify_one();
    }

    /// Waits until a rest is asked for.
    pub(crate) async fn rest_wanted(&self) {
        loop {
            self.rest.notified().await;
            if self.resting.lock().is_some() {
                return;
            }
        }
    }

    /// The rest that was asked for, once.
    pub(crate) fn take_rest(&self) -> Option<(String, Duration)> {
        self.resting.lock().take()
    }

    /// Whether anything was sent or received since the connection is up.
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

    /// Notes what hinders the link though it is up, or that it does so no more.
    pub(crate) fn hinder(&self, what: &str, reason: Option<String>) {
        let told = {
            let mut hindrances = self.hindrances.lock();
            match reason {
                Some(reason) => hindrances.insert(what.to_owned(), reason),
                None => hindrances.remove(what),
            };
            told(&hindrances)
        };
        self.state.send_if_modified(|state| {
            let is_new = state.is_up() && state.reason != told;
            if is_new {
                state.reason = told;
            }
            is_new
        });
    }
}

/// One hindrance in words, and how many there are besides.
fn told(hindrances: &BTreeMap<String, String>) -> Option<String> {
    hindrances.iter().next().map(|(what, reason)| match hindrances.len() {
        1 => format!("{what}: {reason}"),
        n => format!("{what}: {reason} (and {} more)", n - 1),
    })
}
