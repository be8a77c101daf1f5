//! Client of the platform's lease: sends requests, opens and closes the gate, publishes the state.

use std::{sync::Arc, time::Instant};

use asi_model::messages::{FactoryMessage, Lease as LeaseAnswer, LeaseParty, PlatformMessage};
use connector_state::{ConnectorEvent, use_cases::configuration::set_lease_held};
use messaging::{Delivery, Envelope, LinkHandle, LinkState, LogicalAddress};
use tokio::sync::{mpsc, watch};
use tokio_util::sync::CancellationToken;

use super::{
    ConnectorInstance, LeaseAction, LeaseGate, LeaseInput, LeaseMachine, LeaseState, LeaseStatus,
};
use crate::{
    clock::{new_message_id, now},
    coordinator::CoordinatorHandle,
    live_events::LiveEvents,
};

/// Most answers that wait for the client; more than a platform gives in a minute. Further ones are
/// dropped, and the client asks again.
const ANSWERS_MAX: usize = 64;

/// Receiver of the link's messages about the lease.
#[derive(Clone)]
pub struct LeaseAnswers {
    factory_id: asi_model::FactoryId,
    answers: mpsc::Sender<LeaseAnswer>,
}

/// Requests and renews the lease while [`run`](Self::run) is polled.
pub struct LeaseClient {
    lease: LeaseMachine,
    gate: Arc<LeaseGate>,
    link: LinkHandle,
    coordinator: CoordinatorHandle,
    answers: mpsc::Receiver<LeaseAnswer>,
    status: watch::Sender<LeaseStatus>,
    events: LiveEvents,
    addresses: [LogicalAddress; 2],
    ingress: LogicalAddress,
    /// The store says that this connector has the lease.
    is_stored: bool,
}

/// Makes the channel of answers from the link to a [`LeaseClient`].
#[must_use]
pub fn channel(factory_id: asi_model::FactoryId) -> (LeaseAnswers, mpsc::Receiver<LeaseAnswer>) {
    let (sender, answers) = mpsc::channel(ANSWERS_MAX);
    (LeaseAnswers { factory_id, answers: sender }, answers)
}

impl LeaseAnswers {
    fn read(&self, delivery: &Delivery) -> Result<LeaseAnswer, String> {
        let body = delivery.envelope.unpacked(asi_model::messages::MESSAGE_BYTES_MAX);
        let body = body.map_err(|problem| problem.to_string())?;
        match asi_model::validation::parse_platform_message(&body, &self.factory_id) {
            Ok(PlatformMessage::Lease(answer)) => Ok(answer),
            Ok(other) => Err(format!("it is a {}", other.message_type())),
            Err(rejection) => Err(rejection.to_string()),
        }
    }

    /// Passes received answers on to the client. Unreadable ones are dropped, for the client asks
    /// again.
    pub fn take(&self, deliveries: &[Delivery]) {
        for delivery in deliveries {
            match self.read(delivery) {
                Ok(answer) => drop(self.answers.try_send(answer)),
                Err(reason) => tracing::warn!(
                    message.id = delivery.envelope.message_id.as_ref().map(tracing::field::display),
                    reason,
                    "A message at the address of lease answers cannot be read; the connector asks again. If it goes on, \
                     compare the versions of the connector and the platform."
                ),
            }
        }
    }
}

impl LeaseClient {
    /// Makes the client of this running connector, and a watch of its state. `was_held`: the store
    /// says that the lease was granted here before.
    #[must_use]
    pub fn new(
        instance: ConnectorInstance,
        was_held: bool,
        gate: Arc<LeaseGate>,
        link: LinkHandle,
        coordinator: CoordinatorHandle,
        answers: mpsc::Receiver<LeaseAnswer>,
        events: LiveEvents,
    ) -> (Self, watch::Receiver<LeaseStatus>) {
        let factory_id = instance.factory_id.clone();
        let lease = LeaseMachine::new(instance, now());
        let (status, watched) = watch::channel(lease.status().clone());
        let addresses = [
            LogicalAddress::FactoryLeases(factory_id.clone()),
            LogicalAddress::FactoryRequests(factory_id.clone()),
        ];
        let ingress = LogicalAddress::FactoryIngress(factory_id);
        let client = Self {
            lease,
            gate,
            link,
            coordinator,
            answers,
            status,
            events,
            addresses,
            ingress,
            is_stored: was_held,
        };
        (client, watched)
    }

    /// Returns the addresses that a link receives from the start: that of requests only where this
    /// connector had the lease before, for else they may be another one's.
    #[must_use]
    pub fn received_at_start(
        factory_id: &asi_model::FactoryId,
        was_held: bool,
    ) -> Vec<LogicalAddress> {
        let leases = LogicalAddress::FactoryLeases(factory_id.clone());
        let requests = was_held.then(|| LogicalAddress::FactoryRequests(factory_id.clone()));
        std::iter::once(leases).chain(requests).collect()
    }

    /// Requests and renews the lease until shutdown.
    pub async fn run(mut self, shutdown: CancellationToken) {
        let mut states = self.link.state();
        let mut connects = None;
        while !shutdown.is_cancelled() {
            let found = connection(&states.borrow_and_update());
            if found != connects {
                // A connection that was replaced since the last turn counts as ended and begun.
                if connects.is_some() {
                    self.on(LeaseInput::Disconnected).await;
                }
                if found.is_some() {
                    self.on(LeaseInput::Connected).await;
                }
                connects = found;
            }
            let wake_at = self.lease.wake_at().map(tokio::time::Instant::from_std);
            tokio::select! {
                () = shutdown.cancelled() => {}
                changed = states.changed() => if changed.is_err() { return },
                Some(answer) = self.answers.recv() => self.on(LeaseInput::Answered(Box::new(answer))).await,
                () = tokio::time::sleep_until(wake_at.unwrap_or_else(tokio::time::Instant::now)), if wake_at.is_some() =>
                    self.on(LeaseInput::Tick).await,
            }
        }
    }

    async fn on(&mut self, input: LeaseInput) {
        let before = self.lease.status().clone();
        for action in self.lease.on(input, new_message_id(), Instant::now(), now()) {
            self.act(action).await;
        }
        let unlogged = self.lease.to_log();
        let after = self.lease.status();
        if let Some(state) = unlogged {
            log_state(state, after);
        }
        if *after != before {
            log_contender(&before, after);
            self.status.send_replace(after.clone());
            self.events.publish(vec![ConnectorEvent::Status]);
        }
    }

    async fn act(&mut self, action: LeaseAction) {
        match action {
            LeaseAction::Ask(request) => {
                let message_id = request.message_id.clone();
                let message = FactoryMessage::LeaseRequest(request);
                let body = serde_json::to_string(&message)
                    .expect("messages have text keys and finite numbers");
                // Not through the spool, from which nothing leaves before the answer.
                self.link.send_volatile(
                    self.ingress.clone(),
                    Envelope::new(message_id, message.message_type(), body),
                );
            }
            LeaseAction::Open(number) => {
                self.gate.open(number);
                // While the gate was closed each fetch found nothing, so the spool is read again.
                self.link.restart_reading();
                self.store(true).await;
            }
            LeaseAction::Close => {
                // Before it is stored: nothing leaves from here on, whatever the disk does.
                self.gate.close();
                self.store(false).await;
            }
            LeaseAction::Receive(is_receiving) => {
                let count = if is_receiving { self.addresses.len() } else { 1 };
                self.link.set_consumed(self.addresses[..count].to_vec());
            }
            LeaseAction::BackOff(pause) => {
                let holder = self.lease.status().holder.as_ref();
                let holder = holder.map_or("another machine", |holder| &holder.host);
                let reason = format!(
                    "another connector speaks for this factory: {holder}. Stop one of the two; if that one is gone for \
                     good, an administrator of the platform can hand the lease over to this one"
                );
                self.link.back_off(reason, pause);
            }
        }
    }

    /// Stores, for the next start, that requests are this connector's or another one's.
    async fn store(&mut self, is_held: bool) {
        if self.is_stored == is_held {
            return;
        }
        // A full disk is no reason to stop: the next change of the lease tries again.
        if self.coordinator.execute(move |_, _| set_lease_held(is_held)).await.is_ok() {
            self.is_stored = is_held;
        }
    }
}

/// Returns the number of the connection in use; `None` while the link is down.
fn connection(state: &LinkState) -> Option<u64> {
    state.is_up().then_some(state.connects)
}

/// Logs a state that people have to know.
fn log_state(state: LeaseState, status: &LeaseStatus) {
    match state {
        LeaseState::Asking => {}
        LeaseState::Held => {
            tracing::info!(
                lease.number = status.lease_number,
                "This connector speaks for its factory."
            )
        }
        LeaseState::Unanswered => tracing::warn!(
            since = %status.since,
            "The link is up, and the platform answers nothing: it is down, or this connector's access was revoked \
             there. What leaves may not count; reports stay stored here until they are receipted."
        ),
        LeaseState::Refused => tracing::error!(
            holder = host(&status.holder),
            "Another connector speaks for this factory; nothing leaves from here. Stop one of the two; if that one \
             is gone for good, an administrator of the platform can hand the lease over to this one."
        ),
    }
}

/// Logs that a second connector was met, once for each.
fn log_contender(before: &LeaseStatus, after: &LeaseStatus) {
    let other = host(&after.contender);
    if !other.is_empty() && host(&before.contender) != other {
        tracing::error!(
            other,
            "A second connector with this connector's credential is running. Find it and stop it."
        );
    }
}

fn host(party: &Option<LeaseParty>) -> &str {
    party.as_ref().map_or("", |party| party.host.as_str())
}
