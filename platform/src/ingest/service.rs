//! The task that writes what arrives.

use std::{sync::Arc, time::Duration};

use asi_model::pubsub::{PubSubMessage, json::decode};
use messaging::LogicalAddress;
use parking_lot::RwLock;
use tokio::sync::mpsc;
use tokio_util::sync::CancellationToken;

use super::{
    apply::Applier,
    decode::Incoming,
    handle::{Batch, IngestHandle, chain},
    heartbeats::Heartbeats,
    known_meta_data::MetaDataTable,
    room::RoomConfig,
    signs_of_life::SignsOfLife,
    unit::Effects,
    used_up::count_used_up,
};
use crate::{
    accesses::AccessRecorder,
    broker_access::BrokerAccess,
    clock::{Clock, new_access_id},
    live::LiveLog,
    progress_notifier::ProgressNotifierHandle,
    store::{Store, StoreError},
    witness::WitnessKey,
};

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
        let ending = CancellationToken::new();
        let handle =
            IngestHandle::new(&store, Arc::clone(&meta_data), sender, room, ending.clone());
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
            let mut known = self.meta_data.write();
            // A copy: those who decode at the moment hold the table as it was.
            let mut table = (**known).clone();
            for ((factory, writer), meta_data) in effects.meta_data {
                table.put(factory, writer, meta_data);
            }
            *known = Arc::new(table);
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
        for (share, sender) in effects.refusals {
            count_used_up(share, &sender);
        }
        for code in effects.dead_letters {
            metrics::counter!("verbund_dead_letters_total", "code" => code).increment(1);
        }
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
