//! Adapters of the link: it sends messages of the spool, and delivers messages to the coordinator.

use std::sync::Arc;

use asi_model::{DateTime, FactoryId, MessageId, pubsub::json::NetworkMessageHeader};
use async_trait::async_trait;
use messaging::{
    Backlog, Delivery, Envelope, Inbox, LogicalAddress, RowId, RowOutcome, SendOutcome, Settlement,
    SpoolRow, SpoolStore,
    spool::{Fetch, Lane, SpoolError},
};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use time::OffsetDateTime;

use crate::{
    coordinator::CoordinatorHandle,
    in_flight::InFlight,
    keep_alive_queue::KeepAliveQueue,
    lease::{LeaseAnswers, LeaseGate},
    message_signer::MessageSigner,
    store::{ControlMessage, Message, Readers, ReportMessage},
};

/// Subject of messages of reports and of keep-alives.
const DATA: &str = "ua-data";

/// The spool as the source of the link's messages.
pub struct ConnectorSpool {
    factory_id: FactoryId,
    readers: Readers,
    coordinator: CoordinatorHandle,
    keep_alives: Arc<KeepAliveQueue>,
    in_flight: Arc<InFlight>,
    gate: Arc<LeaseGate>,
    signer: MessageSigner,
}

impl ConnectorSpool {
    /// Reads the tables of the spool.
    #[must_use]
    pub fn new(
        factory_id: FactoryId,
        readers: Readers,
        coordinator: CoordinatorHandle,
        keep_alives: Arc<KeepAliveQueue>,
        in_flight: Arc<InFlight>,
        gate: Arc<LeaseGate>,
        signer: MessageSigner,
    ) -> Self {
        Self { factory_id, readers, coordinator, keep_alives, in_flight, gate, signer }
    }

    fn row(&self, message: Message) -> SpoolRow {
        let address = LogicalAddress::FactoryIngress(self.factory_id.clone());
        match message {
            Message::Control(ControlMessage {
                id,
                message_id,
                subject,
                correlation_id,
                body,
                created_at,
                ttl_ms,
                attempts,
            }) => {
                // Metadata has a time of its own, on the time step of its data set.
                let is_of_data_set = subject.starts_with("ua-");
                let mut envelope = Envelope::new(message_id, subject, body);
                envelope.correlation_id = correlation_id;
                envelope.creation_time = if is_of_data_set {
                    timestamp(&envelope.body)
                } else {
                    Some(created_at.into())
                };
                envelope.ttl = ttl_ms.map(std::time::Duration::from_millis);
                SpoolRow { id: RowId(id), address, envelope, attempts }
            }
            Message::Reports(ReportMessage { id, reports, salts, attempts, .. }) => {
                // The earliest of the times that the reports tell themselves, on their time steps.
                let timestamps = reports.iter().map(|(_, report)| timestamp(report.as_bytes()));
                let creation_time = timestamps.min().flatten();
                let message_id = self.message_id(id, &salts);
                self.in_flight
                    .fetched(message_id.clone(), reports.iter().map(|(report, _)| *report));
                let header = NetworkMessageHeader {
                    message_id: Some(&message_id),
                    publisher_id: Some(self.factory_id.as_str()),
                    ..NetworkMessageHeader::default()
                };
                let body = header.wrap(reports.iter().map(|(_, report)| report));
                let mut envelope = Envelope::new(message_id, DATA, body);
                envelope.creation_time = creation_time;
                SpoolRow { id: RowId(id), address, envelope, attempts }
            }
        }
    }

    /// Derives the id of a message of reports from the random bytes that are stored with them: the
    /// same reports in a message have the same id again, also after a crash, so that the platform
    /// recognises a repetition; and the id says nothing about what is in them.
    fn message_id(&self, id: i64, salts: &[u8]) -> MessageId {
        let mut hasher = Sha256::new();
        hasher.update(b"message id");
        hasher.update(self.factory_id.as_str());
        hasher.update(id.to_be_bytes());
        hasher.update(salts);
        let mut bytes = [0_u8; 16];
        bytes.copy_from_slice(&hasher.finalize()[..16]);
        uuid::Builder::from_custom_bytes(bytes).into_uuid().into()
    }
}

/// Time of an OPC UA message or of a report in it: what else tells its time must not be more exact.
fn timestamp(json: &[u8]) -> Option<OffsetDateTime> {
    #[derive(Deserialize)]
    struct Timed {
        #[serde(rename = "Timestamp")]
        timestamp: Option<DateTime>,
    }
    serde_json::from_slice::<Timed>(json).ok()?.timestamp.map(OffsetDateTime::from)
}

#[async_trait]
impl SpoolStore for ConnectorSpool {
    /// Closes the gate: nothing leaves on a new connection before the platform has confirmed this
    /// connector's lease.
    fn connected(&self) {
        self.gate.close();
        self.in_flight.begin_connection();
    }

    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, SpoolError> {
        // Without the lease another connector of this factory may be sending.
        let Some(lease) = self.gate.number() else { return Ok(Vec::new()) };
        // While the ledger is in conflict with its witness, or its word is awaited after a start,
        // only control messages leave.
        if fetch.lane != Lane::Control && self.in_flight.is_held() {
            self.in_flight.turn_away();
            return Ok(Vec::new());
        }
        let messages = self.readers.session().await?.spool().fetch(fetch).await?;
        let mut rows: Vec<SpoolRow> =
            messages.into_iter().map(|message| self.row(message)).collect();
        if fetch.lane == Lane::Control {
            rows.extend(self.keep_alives.fetch(fetch).into_iter().map(|message| SpoolRow {
                id: RowId(message.row),
                address: LogicalAddress::FactoryIngress(self.factory_id.clone()),
                envelope: Envelope::new(message.message_id, DATA, message.body.into_bytes()),
                attempts: 0,
            }));
            // Both are numbered by one sequence: a keep-alive must not overtake what was said
            // before it.
            rows.sort_by_key(|row| row.id);
            rows.truncate(fetch.limit);
        }
        // Stamped here and compared again when it is sent: the lease can be lost in between.
        for row in &mut rows {
            row.envelope.lease = Some(lease);
        }
        Ok(rows)
    }

    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), SpoolError> {
        let mut sent = Vec::new();
        for outcome in &outcomes {
            match outcome.outcome {
                SendOutcome::Accepted => sent.extend(self.in_flight.accepted(outcome.id.0)),
                SendOutcome::Rejected(_) | SendOutcome::Parked(_) | SendOutcome::Expired => {
                    self.in_flight.not_sent(outcome.id.0);
                }
            }
        }
        self.coordinator.record_outcomes(outcomes, sent.clone()).await?;
        self.in_flight.recorded(&sent);
        Ok(())
    }

    fn may_leave(&self, row: &SpoolRow) -> bool {
        // A message without a lease asks for one.
        let has_lease = row.envelope.lease.is_none() || row.envelope.lease == self.gate.number();
        let message_id = row.envelope.message_id.as_ref();
        has_lease
            && message_id.is_none_or(|message_id| self.in_flight.may_leave(row.id.0, message_id))
    }

    /// True for reports, and for keep-alives, which are sent once.
    fn is_receipted(&self, row: &SpoolRow) -> bool {
        row.envelope.subject == DATA
    }

    /// Signs all that leaves: reports, control messages, keep-alives and requests for the lease. At
    /// the last moment, so that nothing is signed that does not leave.
    fn sign(&self, envelope: &mut Envelope) {
        self.signer.sign(envelope);
    }

    async fn last_row(&self) -> Result<RowId, SpoolError> {
        Ok(self.readers.session().await?.spool().last_message().await?)
    }

    async fn backlog(&self) -> Result<Backlog, SpoolError> {
        Ok(self.readers.session().await?.spool().backlog().await?)
    }
}

/// Receiver of the link's messages: those about the lease go to the lease client, all others to
/// the coordinator.
pub struct PlatformInbox {
    pub coordinator: CoordinatorHandle,
    pub lease: LeaseAnswers,
}

#[async_trait]
impl Inbox for PlatformInbox {
    async fn receive(
        &self,
        address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Vec<Settlement> {
        if matches!(address, LogicalAddress::FactoryLeases(_)) {
            self.lease.take(&deliveries);
            return vec![Settlement::Accept; deliveries.len()];
        }
        self.coordinator.deliver(deliveries).await
    }
}
