//! The two ends of the link: what it sends comes from the spool, what it receives goes to the desk.

mod departures;

use std::{collections::BTreeMap, sync::Arc};

use asi_model::{FactoryId, MessageId, pubsub::json::NetworkMessageHeader};
use async_trait::async_trait;
use messaging::{
    Backlog, Delivery, Envelope, Inbox, LogicalAddress, RowId, RowOutcome, SendOutcome, Settlement,
    SpoolRow, SpoolStore,
    spool::{Fetch, Lane, StoreError},
};
use parking_lot::Mutex;
use sha2::{Digest, Sha256};

pub use departures::{Departure, Departures};

use crate::{
    desk::DeskHandle,
    lease::{LeaseAnswers, LeaseGate},
    store::{ControlMessage, Message, Readers, ReportMessage},
};

/// Messages that are made when they are sent and never kept: keep-alives.
#[derive(Default)]
pub struct Ephemerals(Mutex<BTreeMap<i64, (MessageId, Vec<u8>)>>);

/// Most of them that wait; beyond, the oldest go.
const EPHEMERALS_MAX: usize = 65_536;

impl Ephemerals {
    /// Lets one wait to be sent.
    pub fn put(&self, id: i64, message_id: MessageId, body: Vec<u8>) {
        let mut waiting = self.0.lock();
        waiting.insert(id, (message_id, body));
        while waiting.len() > EPHEMERALS_MAX {
            waiting.pop_first();
        }
    }

    /// One was sent, or never will be.
    pub fn remove(&self, id: i64) {
        self.0.lock().remove(&id);
    }

    fn after(&self, fetch: Fetch) -> Vec<(i64, MessageId, Vec<u8>)> {
        let through = fetch.through.map_or(i64::MAX, |id| id.0);
        let waiting = self.0.lock();
        waiting
            .range((std::ops::Bound::Excluded(fetch.after.0), std::ops::Bound::Included(through)))
            .take(fetch.limit)
            .map(|(id, (message_id, body))| (*id, message_id.clone(), body.clone()))
            .collect()
    }
}

/// The spool as the link sees it.
pub struct Outbox {
    factory_id: FactoryId,
    readers: Readers,
    desk: DeskHandle,
    ephemerals: Arc<Ephemerals>,
    departures: Arc<Departures>,
    gate: Arc<LeaseGate>,
}

impl Outbox {
    /// Over the spool's tables.
    #[must_use]
    pub const fn new(
        factory_id: FactoryId,
        readers: Readers,
        desk: DeskHandle,
        ephemerals: Arc<Ephemerals>,
        departures: Arc<Departures>,
        gate: Arc<LeaseGate>,
    ) -> Self {
        Self { factory_id, readers, desk, ephemerals, departures, gate }
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
                let mut envelope = Envelope::new(message_id, subject, body);
                envelope.correlation_id = correlation_id;
                envelope.creation_time = Some(created_at.into());
                envelope.ttl = ttl_ms.map(std::time::Duration::from_millis);
                SpoolRow { id: RowId(id), address, envelope, attempts }
            }
            Message::Reports(ReportMessage { id, reports, created_at, attempts }) => {
                let message_id = self.message_id(id, &reports);
                self.departures
                    .fetched(message_id.clone(), reports.iter().map(|(report, _)| *report));
                let header = NetworkMessageHeader {
                    message_id: Some(&message_id),
                    publisher_id: Some(self.factory_id.as_str()),
                    ..NetworkMessageHeader::default()
                };
                let body = header.wrap(reports.iter().map(|(_, report)| report));
                let mut envelope = Envelope::new(message_id, "ua-data", body);
                envelope.creation_time = Some(created_at.into());
                SpoolRow { id: RowId(id), address, envelope, attempts }
            }
        }
    }

    /// The id of a message of reports: the same whenever the same reports travel together again.
    fn message_id(&self, id: i64, reports: &[(i64, String)]) -> MessageId {
        let mut hasher = Sha256::new();
        hasher.update(self.factory_id.as_str());
        hasher.update(id.to_be_bytes());
        for (_, report) in reports {
            hasher.update(report.as_bytes());
        }
        let mut bytes = [0_u8; 16];
        bytes.copy_from_slice(&hasher.finalize()[..16]);
        uuid::Builder::from_custom_bytes(bytes).into_uuid().into()
    }
}

#[async_trait]
impl SpoolStore for Outbox {
    /// Nothing leaves on a new connection before the platform has confirmed that this connector is
    /// the one to speak.
    fn connected(&self) {
        self.gate.close();
    }

    async fn fetch(&self, fetch: Fetch) -> Result<Vec<SpoolRow>, StoreError> {
        let Some(lease) = self.gate.number() else { return Ok(Vec::new()) };
        let messages = self.readers.session().await?.spool().fetch(fetch).await?;
        let mut rows: Vec<SpoolRow> =
            messages.into_iter().map(|message| self.row(message)).collect();
        if fetch.lane == Lane::Control {
            rows.extend(self.ephemerals.after(fetch).into_iter().map(|(id, message_id, body)| {
                SpoolRow {
                    id: RowId(id),
                    address: LogicalAddress::FactoryIngress(self.factory_id.clone()),
                    envelope: Envelope::new(message_id, "ua-data", body),
                    attempts: 0,
                }
            }));
            rows.sort_by_key(|row| row.id);
            rows.truncate(fetch.limit);
        }
        for row in &mut rows {
            row.envelope.lease = Some(lease);
        }
        Ok(rows)
    }

    async fn record(&self, outcomes: Vec<RowOutcome>) -> Result<(), StoreError> {
        let mut departures = Vec::new();
        for outcome in &outcomes {
            match outcome.outcome {
                SendOutcome::Accepted => departures.extend(self.departures.accepted(outcome.id.0)),
                SendOutcome::Rejected(_) | SendOutcome::Parked(_) | SendOutcome::Expired => {
                    self.departures.not_sent(outcome.id.0);
                }
            }
        }
        Ok(self.desk.outcomes(outcomes, departures).await?)
    }

    fn may_leave(&self, row: &SpoolRow) -> bool {
        // What carries no lease asks for one.
        let has_lease = row.envelope.lease.is_none() || row.envelope.lease == self.gate.number();
        let message_id = row.envelope.message_id.as_ref();
        has_lease
            && message_id.is_none_or(|message_id| self.departures.may_leave(row.id.0, message_id))
    }

    async fn last_row(&self) -> Result<RowId, StoreError> {
        Ok(self.readers.session().await?.spool().last_message().await?)
    }

    async fn backlog(&self) -> Result<Backlog, StoreError> {
        Ok(self.readers.session().await?.spool().backlog().await?)
    }
}

/// What the link receives: about the lease for its keeper, all else for the desk.
pub struct PlatformInbox {
    /// Takes messages of the platform.
    pub desk: DeskHandle,
    /// Takes what is said about the lease.
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
        self.desk.deliver(deliveries).await
    }
}
