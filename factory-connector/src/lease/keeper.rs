//! Keeps the lease: asks, renews, opens and closes the gate, and says how it stands.

use std::{sync::Arc, time::Instant};

use asi_model::messages::{FactoryMessage, Lease as LeaseAnswer, PlatformMessage};
use connector_state::{ConnectorEvent, use_cases::configuration::set_lease_held};
use daemon::web::events::EventLog;
use messaging::{Delivery, Envelope, LinkHandle, LinkState, LogicalAddress};
use tokio::sync::{mpsc, watch};
use tokio_util::sync::CancellationToken;

use super::{Action, Input, Instance, Lease, LeaseGate, LeaseState, LeaseStatus};
use crate::coordinator::{CoordinatorHandle, new_message_id, now};

/// Answers on their way to the keeper; more than a platform gives in a minute. What is beyond is
/// asked for again.
const ANSWERS_MAX: usize = 64;

/// Where the link puts what it receives about the lease.
#[derive(Clone)]
pub struct LeaseAnswers {
    factory_id: asi_model::FactoryId,
    keeper: mpsc::Sender<LeaseAnswer>,
}

/// The keeper; [`run`](Self::run) it.
pub struct LeaseKeeper {
    lease: Lease,
    gate: Arc<LeaseGate>,
    link: LinkHandle,
    coordinator: CoordinatorHandle,
    answers: mpsc::Receiver<LeaseAnswer>,
    status: watch::Sender<LeaseStatus>,
    events: EventLog<ConnectorEvent>,
    addresses: [LogicalAddress; 2],
    ingress: LogicalAddress,
    /// Whether the store says that this connector has the lease.
    is_stored: bool,
}

/// Opens the way to a keeper that is yet to be made.
#[must_use]
pub fn channel(factory_id: asi_model::FactoryId) -> (LeaseAnswers, mpsc::Receiver<LeaseAnswer>) {
    let (keeper, answers) = mpsc::channel(ANSWERS_MAX);
    (LeaseAnswers { factory_id, keeper }, answers)
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

    /// Takes what was received; what is of no use is gone, for it is asked for again.
    pub fn take(&self, deliveries: &[Delivery]) {
        for delivery in deliveries {
            match self.read(delivery) {
                Ok(answer) => drop(self.keeper.try_send(answer)),
                Err(reason) => tracing::warn!(
                    message.id = delivery.envelope.message_id.as_ref().map(tracing::field::display),
                    reason,
                    "What came where answers about the lease come cannot be read; it is asked again. If it goes on, compare \
                     the versions of the connector and the platform."
                ),
            }
        }
    }
}

impl LeaseKeeper {
    /// A keeper for this running connector. `was_held`: the store says that it was granted the
    /// lease here before.
    #[must_use]
    pub fn new(
        instance: Instance,
        was_held: bool,
        gate: Arc<LeaseGate>,
        link: LinkHandle,
        coordinator: CoordinatorHandle,
        answers: mpsc::Receiver<LeaseAnswer>,
        events: EventLog<ConnectorEvent>,
    ) -> (Self, watch::Receiver<LeaseStatus>) {
        let factory_id = instance.factory_id.clone();
        let lease = Lease::new(instance, now());
        let (status, watched) = watch::channel(lease.status().clone());
        let addresses = [
            LogicalAddress::FactoryLeases(factory_id.clone()),
            LogicalAddress::FactoryRequests(factory_id.clone()),
        ];
        let ingress = LogicalAddress::FactoryIngress(factory_id);
        let keeper = Self {
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
        (keeper, watched)
    }

    /// What a link receives from the start: requests only where this connector had the lease
    /// before, for else they may be another one's.
    #[must_use]
    pub fn received_at_start(
        factory_id: &asi_model::FactoryId,
        was_held: bool,
    ) -> Vec<LogicalAddress> {
        let leases = LogicalAddress::FactoryLeases(factory_id.clone());
        let requests = was_held.then(|| LogicalAddress::FactoryRequests(factory_id.clone()));
        std::iter::once(leases).chain(requests).collect()
    }

    /// Runs until shutdown.
    pub async fn run(mut self, shutdown: CancellationToken) {
        let mut states = self.link.state();
        let mut connects = None;
        while !shutdown.is_cancelled() {
            let found = connection(&states.borrow_and_update());
            if found != connects {
                // One that ended and was replaced between two looks counts as both.
                if connects.is_some() {
                    self.on(Input::Disconnected).await;
                }
                if found.is_some() {
                    self.on(Input::Connected).await;
                }
                connects = found;
            }
            let wake_at = self.lease.wake_at().map(tokio::time::Instant::from_std);
            tokio::select! {
                () = shutdown.cancelled() => {}
                changed = states.changed() => if changed.is_err() { return },
                Some(answer) = self.answers.recv() => self.on(Input::Answered(Box::new(answer))).await,
                () = tokio::time::sleep_until(wake_at.unwrap_or_else(tokio::time::Instant::now)), if wake_at.is_some() =>
                    self.on(Input::Tick).await,
            }
        }
    }

    async fn on(&mut self, input: Input) {
        let before = self.lease.status().clone();
        for action in self.lease.on(input, new_message_id(), Instant::now(), now()) {
            self.act(action).await;
        }
        let after = self.lease.status();
        if *after != before {
            tell(&before, after);
            self.status.send_replace(after.clone());
            self.events.publish([ConnectorEvent::Status]);
        }
    }

    async fn act(&mut self, action: Action) {
        match action {
            Action::Ask(request) => {
                let message_id = request.message_id.clone();
                let message = FactoryMessage::LeaseRequest(request);
                let body = serde_json::to_string(&message)
                    .expect("messages have text keys and finite numbers");
                self.link.send_volatile(
                    self.ingress.clone(),
                    Envelope::new(message_id, message.message_type(), body),
                );
            }
            Action::Open(number) => {
                self.gate.open(number);
                self.link.restart_reading();
                self.store(true).await;
            }
            Action::Close => {
                self.gate.close();
                self.store(false).await;
            }
            Action::Receive(is_receiving) => {
                let count = if is_receiving { self.addresses.len() } else { 1 };
                self.link.set_consumed(self.addresses[..count].to_vec());
            }
            Action::Rest(pause) => {
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

    /// Remembers over a restart whether requests are this connector's.
    async fn store(&mut self, is_held: bool) {
        if self.is_stored == is_held {
            return;
        }
        // A disk that is full now is no reason to stop: it is written with the next change.
        if self.coordinator.execute(move |_, _| set_lease_held(is_held)).await.is_ok() {
            self.is_stored = is_held;
        }
    }
}

/// Which connection it is; none where there is none.
fn connection(state: &LinkState) -> Option<u64> {
    state.is_up().then_some(state.connects)
}

/// Says once what people have to know.
fn tell(before: &LeaseStatus, after: &LeaseStatus) {
    let host = |party: &Option<asi_model::messages::LeaseParty>| {
        party.as_ref().map_or_else(String::new, |party| party.host.clone())
    };
    if before.state != after.state {
        match after.state {
            LeaseState::Asking => {}
            LeaseState::Held => {
                tracing::info!(
                    lease.number = after.lease_number,
                    "This connector speaks for its factory."
                )
            }
            LeaseState::Refused => tracing::error!(
                holder = host(&after.holder),
                "Another connector speaks for this factory; nothing leaves from here. Stop one of the two; if that one \
                 is gone for good, an administrator of the platform can hand the lease over to this one."
            ),
        }
    }
    let other = host(&after.contender);
    if !other.is_empty() && host(&before.contender) != other {
        tracing::error!(
            other,
            "A second connector with this connector's credential is running. Find it and stop it."
        );
    }
}
