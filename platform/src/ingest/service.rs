//! The task that writes what arrives, and the handle that brings it.

use std::{sync::Arc, time::Duration};

use asi_model::pubsub::{PubSubMessage, json::decode};
use async_trait::async_trait;
use daemon::web::shares::count_refusal;
use messaging::{Delivery, LogicalAddress, Settlement};
use parking_lot::RwLock;
use tokio::sync::{mpsc, oneshot};
use tokio_util::sync::CancellationToken;

use super::{
    apply::Applier,
    decode::{Incoming, decode as understand},
    heartbeats::Heartbeats,
    known_meta_data::MetaDataTable,
    pace::{Pace, cost},
    quota_arbiter::QUOTA_EXCEEDED,
    room::{Room, RoomConfig},
    signs_of_life::SignsOfLife,
    unit::Effects,
};
use crate::{
    accesses::AccessRecorder,
    broker_access::BrokerAccess,
    clock::{Clock, new_access_id},
    live::LiveLog,
    progress_notifier::ProgressNotifierHandle,
    signing::SigningState,
    store::{Store, StoreError, StoreReader},
    witness::WitnessKey,
};

/// Batches up to this size are decoded where they are; larger ones would hold up other tasks.
const DECODED_INLINE_BYTES_MAX: usize = 64 * 1024;
/// Batches that wait for the writer.
const BATCHES_WAITING_MAX: usize = 64;
/// Batches written in one transaction.
const BATCHES_PER_WORK_MAX: usize = 32;

/// Rules of the ingest.
#[derive(Debug, Clone)]
pub struct IngestConfig {
    /// Time after which an unanswered part of a network is sent again.
    pub resend_after: Duration,
    /// Time without a sign of a connector after which another one may get its lease.
    pub silence: Duration,
    /// The key that countersigns checkpoints of ledgers.
    pub witness: Arc<WitnessKey>,
    /// Bounds on what is kept of a sender.
    pub room: RoomConfig,
}

/// The service; [`run`](Self::run) it.
pub struct Ingest {
    store: Store,
    live: LiveLog,
    broker_access: BrokerAccess,
    progress: ProgressNotifierHandle,
    accesses: AccessRecorder,
    clock: Clock,
    resend_after: Duration,
    witness: Arc<WitnessKey>,
    heartbeats: Heartbeats,
    meta_data: Arc<RwLock<Arc<MetaDataTable>>>,
    batches: mpsc::Receiver<Batch>,
    signs: SignsOfLife,
    ending: CancellationToken,
}

/// Brings messages to a running [`Ingest`].
#[derive(Clone)]
pub struct IngestHandle {
    store: StoreReader,
    meta_data: Arc<RwLock<Arc<MetaDataTable>>>,
    batches: mpsc::Sender<Batch>,
    pace: Arc<Pace>,
    room: Arc<Room>,
    /// Cancelled when the platform ends.
    ending: CancellationToken,
}

struct Batch {
    address: LogicalAddress,
    messages: Vec<Incoming>,
    /// Answered with true when the batch is committed.
    stored: oneshot::Sender<Vec<bool>>,
}

impl Ingest {
    /// A service over the store; knows the metadata that was received before.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn new(
        config: IngestConfig,
        store: Store,
        live: LiveLog,
        broker_access: BrokerAccess,
        progress: ProgressNotifierHandle,
        accesses: AccessRecorder,
        clock: Clock,
    ) -> Result<(Self, IngestHandle), StoreError> {
        // Writers send metadata once, and reports that arrive after a restart need it.
        let mut table = MetaDataTable::default();
        for (factory, body) in store.read().await?.meta_data().list().await? {
            if let Ok(PubSubMessage::MetaData(message)) =
                decode(body.as_bytes()).map(|decoded| decoded.message)
            {
                table.put(factory, message.data_set_writer_id, message.meta_data);
            }
        }
        let meta_data = Arc::new(RwLock::new(Arc::new(table)));
        let (sender, batches) = mpsc::channel(BATCHES_WAITING_MAX);
        let IngestConfig { resend_after, silence, witness, room } = config;
        let (ending, may_wait) = (CancellationToken::new(), room.may_wait);
        let handle = IngestHandle {
            ending: ending.clone(),
            room: Arc::new(Room::new(room, store.reserved_reader())),
            store: store.reserved_reader(),
            meta_data: Arc::clone(&meta_data),
            batches: sender,
            pace: Arc::new(Pace::new(may_wait)),
        };
        let (signs, heartbeats) = (SignsOfLife::default(), Heartbeats::new(silence));
        Ok((
            Self {
                store,
                live,
                broker_access,
                progress,
                accesses,
                clock,
                resend_after,
                witness,
                heartbeats,
                meta_data,
                batches,
                signs,
                ending,
            },
            handle,
        ))
    }

    /// Returns the token to cancel when the platform ends: senders without room are waited for no longer.
    #[must_use]
    pub fn ending(&self) -> CancellationToken {
        self.ending.clone()
    }

    /// Runs until shutdown; what was taken by then is written.
    ///
    /// # Errors
    /// Never; the deliveries of a failing store are released, and the senders bring them again.
    pub async fn run(mut self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut waiting = Vec::with_capacity(BATCHES_PER_WORK_MAX);
        while let Some(count) = shutdown
            .run_until_cancelled(self.batches.recv_many(&mut waiting, BATCHES_PER_WORK_MAX))
            .await
        {
            if count == 0 {
                return Ok(());
            }
            let batches = std::mem::take(&mut waiting);
            self.write(batches).await;
        }
        // What waits now was not settled with the broker and comes again.
        Ok(())
    }

    /// Writes batches in one transaction. Where that fails, each message is tried on its own, so
    /// that one that the database refuses holds nobody else up. After one that cannot be stored at
    /// the moment all others wait, too, for none may overtake it.
    async fn write(&self, batches: Vec<Batch>) {
        let started = std::time::Instant::now();
        let all: Vec<(&LogicalAddress, &[Incoming])> =
            batches.iter().map(|batch| (&batch.address, &batch.messages[..])).collect();
        match self.write_once(&all).await {
            Ok(()) => {
                for batch in batches {
                    let answer = vec![true; batch.messages.len()];
                    drop(batch.stored.send(answer));
                }
            }
            Err(error) => {
                tracing::warn!(cause = %chain(&error), "A batch could not be stored; its messages are tried singly.");
                let mut is_stored = true;
                for batch in batches {
                    let mut answer = Vec::with_capacity(batch.messages.len());
                    for message in &batch.messages {
                        is_stored = is_stored && self.write_single(&batch.address, message).await;
                        answer.push(is_stored);
                    }
                    drop(batch.stored.send(answer));
                }
            }
        }
        metrics::histogram!("verbund_ingest_work_seconds").record(started.elapsed());
    }

    async fn write_single(&self, address: &LogicalAddress, message: &Incoming) -> bool {
        let error = match self.write_once(&[(address, std::slice::from_ref(message))]).await {
            Ok(()) => return true,
            Err(error) => error,
        };
        if !is_refused(&error) {
            return false;
        }
        // The database will always refuse it: a dead letter instead, so that the queue goes on.
        let reason = format!("It cannot be stored: {}.", chain(&error));
        let dead = message.set_aside(address, "NOT_STORABLE", reason);
        self.write_once(&[(address, std::slice::from_ref(&dead))]).await.is_ok()
    }

    async fn write_once(
        &self,
        batches: &[(&LogicalAddress, &[Incoming])],
    ) -> Result<(), StoreError> {
        let mut work = self.store.begin().await?;
        let now = self.clock.now();
        let mut applier =
            Applier::new(&mut work, now, self.resend_after, &self.heartbeats, &self.witness);
        for (address, messages) in batches {
            applier.batch(address, messages).await?;
        }
        let mut effects = applier.finish().await?;
        // What tools are sent is on record with the messages that bring it.
        let (entries, counted) = self.accesses.divide(std::mem::take(&mut effects.forwarded));
        work.accesses().append(&entries, self.clock.now(), new_access_id).await?;
        work.commit().await?;
        self.accesses.written(&entries, counted);
        // After the commit: pages and tools hear of nothing that may still be rolled back.
        self.publish(effects).await;
        Ok(())
    }

    /// Publishes the effects of a committed batch: to pages, link, decoder and metrics.
    async fn publish(&self, effects: Effects) {
        if effects.has_outgoing {
            self.broker_access.wake_link();
        }
        if !effects.meta_data.is_empty() {
            // A copy: those who decode at the moment hold the table as it was.
            let mut table = (**self.meta_data.read()).clone();
            for ((factory, writer), meta_data) in effects.meta_data {
                table.put(factory, writer, meta_data);
            }
            *self.meta_data.write() = Arc::new(table);
        }
        self.live.publish(effects.notifications);
        self.progress.changed(effects.networks);
        for (factory, heard) in effects.heard {
            match self.signs.events(&self.store, factory, heard).await {
                Ok(events) => self.live.publish(events),
                Err(error) => {
                    tracing::warn!(%error, "Pages could not be notified that a factory was heard.");
                }
            }
        }
        metrics::counter!("verbund_reports_stored_total").increment(effects.reports);
        metrics::counter!("verbund_duplicates_discarded_total").increment(effects.duplicates);
        for (share, who) in effects.refusals {
            count_refusal(share, &who);
        }
        for code in effects.dead_letters {
            metrics::counter!("verbund_dead_letters_total", "code" => code).increment(1);
        }
    }
}

#[async_trait]
impl messaging::Inbox for IngestHandle {
    async fn receive(
        &self,
        address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Vec<Settlement> {
        let beyond = self.pace.keep(address, deliveries.len()).await;
        let lacking = match self.room.of(address, self.ending.cancelled()).await {
            // Not stored any more: the platform ends.
            Ok(Some(_)) if self.room.may_wait() => return Vec::new(),
            Ok(lacking) => beyond.or(lacking),
            Err(error) => {
                tracing::warn!(cause = %chain(&error), "The room of a sender cannot be read; its messages wait.");
                return Vec::new();
            }
        };
        let Some(mut messages) = self.understand(address, deliveries).await else {
            return Vec::new();
        };
        // What they count as beyond their number shows once they are unpacked.
        let more = messages.iter().map(cost).sum::<usize>() - messages.len();
        let beyond = if more > 0 { self.pace.keep(address, more).await } else { None };
        let lacking = lacking.or(beyond);
        for (message, reason) in messages.iter_mut().zip(lacking.iter().cycle()) {
            *message = message.set_aside(address, QUOTA_EXCEEDED, reason.clone());
        }
        let stored = self.write(address, messages).await;
        stored
            .into_iter()
            .map(|is_stored| if is_stored { Settlement::Accept } else { Settlement::Release })
            .collect()
    }
}

impl IngestHandle {
    /// Takes a message once more that was set aside, whatever the lease under which it came. Returns
    /// whether it is written now.
    pub async fn replay(&self, address: &LogicalAddress, delivery: Delivery) -> bool {
        let Some(mut messages) = self.understand(address, vec![delivery]).await else {
            return false;
        };
        for message in &mut messages {
            message.envelope.lease = None;
        }
        self.write(address, messages).await == [true]
    }

    /// Verifies and decodes; none where that cannot be done at the moment, so that all comes again.
    async fn understand(
        &self,
        address: &LogicalAddress,
        deliveries: Vec<Delivery>,
    ) -> Option<Vec<Incoming>> {
        let signing = match self.signing(address).await {
            Ok(signing) => signing,
            Err(error) => {
                tracing::warn!(cause = %chain(&error), "The keys of a factory cannot be read; its messages wait.");
                return None;
            }
        };
        let table = Arc::clone(&self.meta_data.read());
        let bytes: usize = deliveries.iter().map(|delivery| delivery.envelope.body.len()).sum();
        let decoded_address = address.clone();
        let decode_all = move || -> Vec<Incoming> {
            let known = table.of(decoded_address.factory_id());
            deliveries
                .iter()
                .map(|delivery| understand(&decoded_address, delivery, &known, &signing))
                .collect()
        };
        if bytes <= DECODED_INLINE_BYTES_MAX {
            Some(decode_all())
        } else {
            tokio::task::spawn_blocking(decode_all).await.ok()
        }
    }

    /// Reads the keys of a factory, for each batch: what an administrator changed counts at once.
    async fn signing(&self, address: &LogicalAddress) -> Result<SigningState, StoreError> {
        let LogicalAddress::FactoryIngress(factory) = address else {
            return Ok(SigningState::default());
        };
        self.store.read().await?.signing_keys().of_factory(factory).await
    }

    /// Hands messages to the writer. Returns for each whether it is written; nothing where the writer
    /// has ended, and what is missing counts as released.
    async fn write(&self, address: &LogicalAddress, messages: Vec<Incoming>) -> Vec<bool> {
        let (stored, answer) = oneshot::channel();
        let batch = Batch { address: address.clone(), messages, stored };
        if self.batches.send(batch).await.is_err() {
            return Vec::new();
        }
        answer.await.unwrap_or_default()
    }
}

/// Returns true if the database rejected the data itself, so that a retry would fail again.
fn is_refused(error: &StoreError) -> bool {
    match error {
        StoreError::Statement { source: sqlx::Error::Database(error), .. } => {
            error.is_foreign_key_violation()
                || error.is_check_violation()
                || error.is_unique_violation()
        }
        StoreError::Corrupt { .. } => true,
        _ => false,
    }
}

fn chain(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}: {}", chain(cause)),
        None => error.to_string(),
    }
}
