//! Lease on the factory's identity: of all running connectors with its credential only the one to
//! which the platform has granted the lease may send.
//!
//! [`LeaseMachine`] does no I/O; [`LeaseClient`] runs its actions; the [`LeaseGate`]
//! permits or forbids the spool's messages to leave. Values are mapped, disclosed, numbered and
//! spooled in either state of the gate.

mod client;
mod gate;

use std::{
    collections::VecDeque,
    mem,
    time::{Duration, Instant},
};

use asi_model::{
    DateTime, FactoryId, InstanceId, MessageId, PlaceId,
    messages::{Lease as LeaseAnswer, LeaseParty, LeaseRequest, LeaseResult},
};
pub use client::{LeaseAnswers, LeaseClient, channel};
pub use gate::LeaseGate;
use serde::Serialize;
use utoipa::ToSchema;

/// Time to wait for the first answer of a connection before the next request; doubles with each
/// request.
const PATIENCE_MIN: Duration = Duration::from_secs(2);
const PATIENCE_MAX: Duration = Duration::from_secs(60);
/// Time before the next request after an answer to another connector came here.
const OVERHEARD_PAUSE: Duration = Duration::from_secs(1);
/// Bounds of the time that the platform sets for the next request: a wrong value must neither make
/// the connector flood the platform nor silence it for a day.
const ASK_AGAIN_MIN: Duration = Duration::from_millis(50);
const ASK_AGAIN_MAX: Duration = Duration::from_secs(600);
/// Most requests whose answers are accepted. Answers to older ones say what held before newer
/// requests were sent.
const ASKED_MAX: usize = 16;
/// Requests of a connection in a row without an answer after which the platform counts as silent: more than one that
/// restarts leaves behind.
const UNANSWERED_MAX: u32 = 3;

/// Identity of this running connector, which the platform distinguishes from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectorInstance {
    pub factory_id: FactoryId,
    /// Random, drawn at each start.
    pub instance_id: InstanceId,
    /// Identifies the machine and folder of the store.
    pub place: PlaceId,
    /// Machine and folder as text for people.
    pub host: String,
    pub started_at: DateTime,
}

/// State of the lease, as pages show it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeaseStatus {
    pub state: LeaseState,
    pub since: DateTime,
    /// Machine and folder, as the platform knows it.
    pub host: String,
    /// Number of the lease that it has; `None` unless granted.
    pub lease_number: Option<u64>,
    /// The connector that has the lease instead of this one.
    pub holder: Option<LeaseParty>,
    /// A second connector with this one's credential, which was refused or has the lease.
    pub contender: Option<LeaseParty>,
}

/// Right to send, as the platform last answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum LeaseState {
    /// The platform has not answered since the start.
    Asking,
    /// The platform granted the lease to this connector.
    Held,
    /// Another connector has the lease; nothing leaves here.
    Refused,
    /// The link is up, and the platform has not answered since: it is down, or the access was revoked there. What may
    /// leave is as before.
    Unanswered,
}

/// Event that may change the lease.
#[derive(Debug)]
pub enum LeaseInput {
    /// The link is up, after it was not.
    Connected,
    /// The link is down.
    Disconnected,
    /// The platform answered this connector or another one.
    Answered(Box<LeaseAnswer>),
    /// The time of [`LeaseMachine::wake_at`] has come.
    Tick,
}

/// Step that the [`LeaseClient`] takes.
#[derive(Debug, PartialEq, Eq)]
pub enum LeaseAction {
    /// Send a request to the platform.
    Ask(LeaseRequest),
    /// Permit messages to leave, under the lease with this number.
    Open(u64),
    /// Forbid messages to leave.
    Close,
    /// Receive the factory's requests (true), or leave them to the other connector (false).
    Receive(bool),
    /// Disconnect from the broker for this long, for the other connector's sake.
    BackOff(Duration),
}

/// State machine of the lease.
#[derive(Debug)]
pub struct LeaseMachine {
    instance: ConnectorInstance,
    status: LeaseStatus,
    is_connected: bool,
    /// The platform has granted the lease since the link is up.
    is_confirmed: bool,
    asked: VecDeque<MessageId>,
    patience: Duration,
    ask_at: Option<Instant>,
    /// State by the platform's last answer, and its time.
    answered: (LeaseState, DateTime),
    /// Requests since the last answer or the begin of the connection, and the time of the first of them.
    unanswered: (u32, DateTime),
    /// State that the log has, and the one that it lacks.
    logged: LeaseState,
    unlogged: Option<LeaseState>,
}

impl LeaseMachine {
    /// Begins in [`LeaseState::Asking`], without a connection.
    #[must_use]
    pub fn new(instance: ConnectorInstance, now: DateTime) -> Self {
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
            answered: (LeaseState::Asking, now),
            unanswered: (0, now),
            logged: LeaseState::Asking,
            unlogged: None,
        }
    }

    /// Returns the state to show.
    #[must_use]
    pub const fn status(&self) -> &LeaseStatus {
        &self.status
    }

    /// Returns the time at which [`LeaseInput::Tick`] is due.
    #[must_use]
    pub const fn wake_at(&self) -> Option<Instant> {
        self.ask_at
    }

    /// Returns a state that the log lacks: one that the platform's answer says, or its silence. What is shown again when a
    /// silence ends otherwise, as with the link, nobody has said.
    pub fn to_log(&mut self) -> Option<LeaseState> {
        let state = self.unlogged.take()?;
        (mem::replace(&mut self.logged, state) != state).then_some(state)
    }

    /// Returns the actions that follow from an event, in order. `id` becomes the message id of a
    /// request among them.
    pub fn on(
        &mut self,
        input: LeaseInput,
        id: MessageId,
        instant: Instant,
        now: DateTime,
    ) -> Vec<LeaseAction> {
        match input {
            LeaseInput::Connected => {
                (self.is_connected, self.is_confirmed) = (true, false);
                self.asked.clear();
                self.patience = PATIENCE_MIN;
                vec![self.ask(id, instant, now)]
            }
            LeaseInput::Disconnected => {
                (self.is_connected, self.is_confirmed) = (false, false);
                self.ask_at = None;
                // Without a link nothing can be answered.
                self.end_silence();
                // Not before the link is down: a receiver that leaves an address while it is
                // connected may end the subscription of both connectors.
                if self.status.state == LeaseState::Refused {
                    vec![LeaseAction::Receive(false)]
                } else {
                    Vec::new()
                }
            }
            LeaseInput::Tick => {
                let is_due = self.is_connected && self.ask_at.is_some_and(|at| at <= instant);
                if is_due { vec![self.ask(id, instant, now)] } else { Vec::new() }
            }
            LeaseInput::Answered(answer) if answer.instance_id == self.instance.instance_id => {
                self.answered(*answer, instant, now)
            }
            LeaseInput::Answered(answer) => {
                self.overheard(*answer, instant, now);
                Vec::new()
            }
        }
    }

    fn ask(&mut self, message_id: MessageId, instant: Instant, now: DateTime) -> LeaseAction {
        let (count, since) = self.unanswered;
        if count >= UNANSWERED_MAX {
            (self.status.state, self.status.since) = (LeaseState::Unanswered, since);
            self.unlogged = Some(LeaseState::Unanswered);
        }
        self.unanswered = (count.saturating_add(1), if count == 0 { now } else { since });
        self.asked.push_back(message_id.clone());
        if self.asked.len() > ASKED_MAX {
            self.asked.pop_front();
        }
        self.ask_at = Some(instant + self.patience);
        self.patience = (self.patience * 2).min(PATIENCE_MAX);
        let ConnectorInstance { factory_id, instance_id, place, host, started_at } =
            self.instance.clone();
        LeaseAction::Ask(LeaseRequest {
            message_id,
            factory_id,
            instance_id,
            place,
            host,
            started_at,
        })
    }

    /// Handles an answer to this connector. An answer to a request of an earlier connection says
    /// nothing about this one.
    fn answered(
        &mut self,
        answer: LeaseAnswer,
        instant: Instant,
        now: DateTime,
    ) -> Vec<LeaseAction> {
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
                    vec![LeaseAction::Receive(true), LeaseAction::Open(answer.lease_number)]
                }
            }
            LeaseResult::Refused => {
                self.ask_at = None;
                self.is_confirmed = false;
                // A refusal may be delivered twice, and is handled once.
                self.asked.clear();
                self.enter(LeaseState::Refused, now);
                self.status.lease_number = None;
                self.status.contender = None;
                self.status.holder = answer.holder;
                vec![LeaseAction::Close, LeaseAction::BackOff(pause)]
            }
        }
    }

    /// Handles an answer to another connector. One with the same place went to a predecessor of
    /// this connector, which is gone; one with another place shows that two connectors run.
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
        self.end_silence();
        // Its answer came here, so ours may have gone there: ask again soon, though not at once,
        // lest the two connectors receive each other's answers over and over.
        self.patience = PATIENCE_MIN;
        self.ask_at = self.ask_at.map(|at| at.min(instant + OVERHEARD_PAUSE));
    }

    fn enter(&mut self, state: LeaseState, now: DateTime) {
        if self.answered.0 != state {
            self.answered = (state, now);
        }
        self.unlogged = Some(state);
        self.end_silence();
    }

    /// Shows again what the platform answered last.
    fn end_silence(&mut self) {
        self.unanswered.0 = 0;
        (self.status.state, self.status.since) = self.answered;
    }
}

#[cfg(test)]
mod tests;
