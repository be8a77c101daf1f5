//! The lease on the factory's identity: of all running connectors with its credential only the one
//! that the platform has granted the lease may speak.
//!
//! [`Lease`] decides and does nothing else; [`LeaseKeeper`] carries its decisions out; the
//! [`LeaseGate`] lets what waits in the spool leave, or not. Values go on being mapped, disclosed,
//! numbered and spooled whatever the gate does.

mod gate;
mod keeper;

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use asi_model::{
    DateTime, FactoryId, InstanceId, MessageId, PlaceId,
    messages::{Lease as LeaseAnswer, LeaseParty, LeaseRequest, LeaseResult},
};
use serde::Serialize;

pub use gate::LeaseGate;
pub use keeper::{LeaseAnswers, LeaseKeeper, channel};

/// How long the first answer of a connection is waited for before it is asked for again; doubles
/// with each time.
const PATIENCE_MIN: Duration = Duration::from_secs(2);
const PATIENCE_MAX: Duration = Duration::from_secs(60);
/// How long to wait before asking again after an answer to another connector came here.
const OVERHEARD_PAUSE: Duration = Duration::from_secs(1);
/// Bounds of what the platform says about when to ask again.
const ASK_AGAIN_MIN: Duration = Duration::from_millis(50);
const ASK_AGAIN_MAX: Duration = Duration::from_secs(600);
/// Requests whose answers are still taken.
const ASKED_MAX: usize = 16;

/// This running connector, as the platform tells it from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instance {
    /// Whose connector it is.
    pub factory_id: FactoryId,
    /// Drawn at this start.
    pub instance_id: InstanceId,
    /// Where its store is in use.
    pub place: PlaceId,
    /// Machine and folder, for people.
    pub host: String,
    /// When it started.
    pub started_at: DateTime,
}

/// How the lease stands, for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct LeaseStatus {
    /// The state.
    pub state: LeaseState,
    /// Since when.
    pub since: DateTime,
    /// This connector's machine and folder, as the platform knows it.
    pub host: String,
    /// The number of the lease that it holds.
    pub lease_number: Option<u64>,
    /// The connector that holds the lease in its stead.
    pub holder: Option<LeaseParty>,
    /// A second connector with this one's credential, which was refused or has the lease.
    pub contender: Option<LeaseParty>,
}

/// The state of a lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum LeaseState {
    /// The platform has not answered yet.
    Asking,
    /// This is the factory's connector.
    Held,
    /// Another one is; nothing leaves here.
    Refused,
}

/// What happens.
#[derive(Debug)]
pub enum Input {
    /// The link is up, after it was not.
    Connected,
    /// The link is down.
    Disconnected,
    /// The platform answered somebody.
    Answered(Box<LeaseAnswer>),
    /// Time passed.
    Tick,
}

/// What is to be done.
#[derive(Debug, PartialEq, Eq)]
pub enum Action {
    /// Ask the platform.
    Ask(LeaseRequest),
    /// What waits may leave under this lease.
    Open(u64),
    /// Nothing may leave.
    Close,
    /// Receive requests, or leave them to the other connector.
    Receive(bool),
    /// Leave the broker to the other connector for a while.
    Rest(Duration),
}

/// Decides what follows from the platform's answers.
#[derive(Debug)]
pub struct Lease {
    instance: Instance,
    status: LeaseStatus,
    is_connected: bool,
    /// The platform has granted the lease since the link is up.
    is_confirmed: bool,
    asked: VecDeque<MessageId>,
    patience: Duration,
    ask_at: Option<Instant>,
}

impl Lease {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(instance: Instance, now: DateTime) -> Self {
        let status = LeaseStatus {
            state: LeaseState::Asking,
            since: now,
            host: instance.host.clone(),
            lease_number: None,
            holder: None,
            contender: None,
        };
        Self {
            instance,
            status,
            is_connected: false,
            is_confirmed: false,
            asked: VecDeque::new(),
            patience: PATIENCE_MIN,
            ask_at: None,
        }
    }

    /// How it stands.
    #[must_use]
    pub const fn status(&self) -> &LeaseStatus {
        &self.status
    }

    /// When [`Input::Tick`] is due.
    #[must_use]
    pub const fn wake_at(&self) -> Option<Instant> {
        self.ask_at
    }

    /// Decides. `id` names a request, should there be one.
    pub fn on(
        &mut self,
        input: Input,
        id: MessageId,
        instant: Instant,
        now: DateTime,
    ) -> Vec<Action> {
        match input {
            Input::Connected => {
                (self.is_connected, self.is_confirmed) = (true, false);
                self.asked.clear();
                self.patience = PATIENCE_MIN;
                vec![self.ask(id, instant)]
            }
            Input::Disconnected => {
                (self.is_connected, self.is_confirmed) = (false, false);
                self.ask_at = None;
                // Not sooner: a receiver that leaves an address while it is connected may take the
                // place of both away.
                if self.status.state == LeaseState::Refused {
                    vec![Action::Receive(false)]
                } else {
                    Vec::new()
                }
            }
            Input::Tick => {
                let is_due = self.is_connected && self.ask_at.is_some_and(|at| at <= instant);
                if is_due { vec![self.ask(id, instant)] } else { Vec::new() }
            }
            Input::Answered(answer) if answer.instance_id == self.instance.instance_id => {
                self.answered(*answer, instant, now)
            }
            Input::Answered(answer) => {
                self.overheard(*answer, instant, now);
                Vec::new()
            }
        }
    }

    fn ask(&mut self, message_id: MessageId, instant: Instant) -> Action {
        self.asked.push_back(message_id.clone());
        if self.asked.len() > ASKED_MAX {
            self.asked.pop_front();
        }
        self.ask_at = Some(instant + self.patience);
        self.patience = (self.patience * 2).min(PATIENCE_MAX);
        let Instance { factory_id, instance_id, place, host, started_at } = self.instance.clone();
        Action::Ask(LeaseRequest { message_id, factory_id, instance_id, place, host, started_at })
    }

    /// An answer to this connector. One to a request of an earlier connection says nothing about
    /// this one.
    fn answered(&mut self, answer: LeaseAnswer, instant: Instant, now: DateTime) -> Vec<Action> {
        if !self.is_connected || !self.asked.contains(&answer.correlation_id) {
            return Vec::new();
        }
        let pause = Duration::from_millis(answer.ask_again_ms).clamp(ASK_AGAIN_MIN, ASK_AGAIN_MAX);
        self.patience = PATIENCE_MIN;
        match answer.result {
            LeaseResult::Granted => {
                self.ask_at = Some(instant + pause);
                let is_open =
                    self.is_confirmed && self.status.lease_number == Some(answer.lease_number);
                self.is_confirmed = true;
                self.enter(LeaseState::Held, now);
                self.status.lease_number = Some(answer.lease_number);
                self.status.holder = None;
                self.status.contender = answer.contender;
                if is_open {
                    Vec::new()
                } else {
                    vec![Action::Receive(true), Action::Open(answer.lease_number)]
                }
            }
            LeaseResult::Refused => {
                self.ask_at = None;
                self.is_confirmed = false;
                // It may come twice, and is to be followed once.
                self.asked.clear();
                self.enter(LeaseState::Refused, now);
                self.status.lease_number = None;
                self.status.contender = None;
                self.status.holder = answer.holder;
                vec![Action::Close, Action::Rest(pause)]
            }
        }
    }

    /// An answer to somebody else. From this place it was to a predecessor of this connector, which
    /// is gone; from elsewhere it shows that there are two.
    fn overheard(&mut self, answer: LeaseAnswer, instant: Instant, now: DateTime) {
        if answer.place == self.instance.place {
            return;
        }
        let other = LeaseParty {
            instance_id: answer.instance_id,
            host: answer.host,
            since: now,
            last_heard_at: now,
        };
        self.status.contender = Some(other);
        // Its answer came here, so ours may have gone there: the platform is there and takes its
        // time for nobody. Not at once, lest both chase each other's answers.
        self.patience = PATIENCE_MIN;
        self.ask_at = self.ask_at.map(|at| at.min(instant + OVERHEARD_PAUSE));
    }

    fn enter(&mut self, state: LeaseState, now: DateTime) {
        if self.status.state != state {
            self.status.state = state;
            self.status.since = now;
        }
    }
}

#[cfg(test)]
mod tests;
