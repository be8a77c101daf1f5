//! The handle that brings messages to the writer: paced, decoded a portion at a time.

use std::sync::Arc;

use asi_model::{
    FactoryId,
    messages::{FactoryMessage, MESSAGE_BYTES_MAX},
};
use async_trait::async_trait;
use messaging::{Delivery, LogicalAddress, Settlement};
use parking_lot::RwLock;
use tokio::sync::{Semaphore, SemaphorePermit, mpsc, oneshot};
use tokio_util::sync::CancellationToken;

use super::{
    decode::{Content, Incoming, decode as understand},
    known_meta_data::MetaDataTable,
    pace::{Excess, Pace, cost},
    portion::{self, BatchPortion, PORTION_BYTES_MAX},
    quota_arbiter::QUOTA_EXCEEDED,
    room::{Room, RoomConfig},
};
use crate::{
    signing::SigningState,
    store::{Store, StoreError, StoreReader},
};

/// Portions up to this size are decoded where they are; larger ones would hold up other tasks.
const DECODED_INLINE_BYTES_MAX: usize = 64 * 1024;
/// Unpacked bytes of all senders' messages that are decoded at a time, until they are written.
const DECODED_BYTES_MAX: usize = 8 * 1024 * 1024;
/// Unpacked bytes of the largest portion: one that is full but for a byte takes one message more.
const PORTION_HELD_MAX: u32 = 1280 * 1024;
const _: () = assert!(PORTION_HELD_MAX as usize == PORTION_BYTES_MAX + MESSAGE_BYTES_MAX);

/// Brings messages to a running [`Ingest`](super::Ingest).
#[derive(Clone)]
pub struct IngestHandle {
    store: StoreReader,
    meta_data: Arc<RwLock<Arc<MetaDataTable>>>,
    batches: mpsc::Sender<Batch>,
    pace: Arc<Pace>,
    room: Arc<Room>,
    /// Unpacked bytes that may be decoded beside those that are.
    decoded: Arc<Semaphore>,
    /// Cancelled when the platform ends.
    ending: CancellationToken,
}

/// Reasons for which a sender may add nothing.
struct Lacking {
    /// Excess over its share.
    share: Option<String>,
    /// Want of room, beside what is kept of it.
    no_room: Option<String>,
}

/// Returns false for what is answered and kept nowhere, and needs no room: a factory whose request for its lease were set
/// aside would fall silent, and send nothing when there is room again.
fn is_kept(message: &Incoming) -> bool {
    let Content::Factory(message) = &message.content else { return true };
    !matches!(**message, FactoryMessage::LeaseRequest(_))
}

/// Messages of one sender for the writer.
pub(super) struct Batch {
    pub(super) address: LogicalAddress,
    pub(super) messages: Vec<Incoming>,
    /// Answered with true when the batch is committed.
    pub(super) stored: oneshot::Sender<Vec<bool>>,
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
            Ok(no_room) => Lacking { share: beyond, no_room },
            Err(error) => {
                tracing::warn!(cause = %chain(&error), "The room of a sender cannot be read; its messages wait.");
                return Vec::new();
            }
        };
        let mut settlements = Vec::with_capacity(deliveries.len());
        let mut batch = deliveries.into_iter();
        while batch.len() > 0 {
            // Before it is unpacked: what waits for room here is as small as it came.
            let Ok(mut held) = self.decoded.acquire_many(PORTION_HELD_MAX).await else { break };
            let portion = portion::next(&mut batch);
            let count = portion.messages.len();
            let bytes = u32::try_from(portion.bytes).unwrap_or(PORTION_HELD_MAX);
            // What it does not take is there for others.
            drop(held.split(PORTION_HELD_MAX.saturating_sub(bytes.max(1)) as usize));
            let stored = self.take_in(address, portion, &lacking, held).await;
            let is_whole = stored.len() == count && !stored.contains(&false);
            settlements.extend(stored.into_iter().map(|is_stored| match is_stored {
                true => Settlement::Accept,
                false => Settlement::Release,
            }));
            // None may overtake one that comes again.
            if !is_whole {
                break;
            }
        }
        settlements
    }
}

impl IngestHandle {
    /// Brings messages to the writer behind `batches`, within the room that senders have in the store.
    pub(super) fn new(
        store: &Store,
        meta_data: Arc<RwLock<Arc<MetaDataTable>>>,
        batches: mpsc::Sender<Batch>,
        room: RoomConfig,
        ending: CancellationToken,
    ) -> Self {
        Self {
            pace: Arc::new(Pace::new(room.may_wait)),
            room: Arc::new(Room::new(room, store.reserved_reader())),
            store: store.reserved_reader(),
            meta_data,
            batches,
            decoded: Arc::new(Semaphore::new(DECODED_BYTES_MAX)),
            ending,
        }
    }

    /// Forgets the metadata of a factory that has left.
    pub fn forget(&self, factory: &FactoryId) {
        let mut known = self.meta_data.write();
        let mut table = (**known).clone();
        table.forget(factory);
        *known = Arc::new(table);
    }

    /// Takes a message once more that was set aside, whatever the lease under which it came. Returns
    /// whether it is written now.
    pub async fn replay(&self, address: &LogicalAddress, delivery: Delivery) -> bool {
        let portion = portion::next(&mut vec![delivery].into_iter());
        let Some(mut messages) = self.understand(address, portion).await else {
            return false;
        };
        for message in &mut messages {
            message.envelope.lease = None;
        }
        self.write(address, messages).await == [true]
    }

    /// Decodes and writes a portion; `lacking` says why its sender may add nothing. Returns for each message whether
    /// it is written, and for none what cannot be done at the moment. `held` is its room among what is decoded.
    async fn take_in(
        &self,
        address: &LogicalAddress,
        portion: BatchPortion,
        lacking: &Lacking,
        held: SemaphorePermit<'_>,
    ) -> Vec<bool> {
        let Some(mut messages) = self.understand(address, portion).await else {
            return Vec::new();
        };
        // What they count as beyond their number shows once they are unpacked.
        let more = messages.iter().map(cost).sum::<usize>() - messages.len();
        let Excess { wait, reason } = match more {
            0 => Excess::default(),
            more => self.pace.charge(address, more),
        };
        let share = lacking.share.as_ref().or(reason.as_ref());
        for message in &mut messages {
            let no_room = lacking.no_room.as_ref().filter(|_| is_kept(message));
            if let Some(reason) = share.or(no_room) {
                *message = message.set_aside(address, QUOTA_EXCEEDED, reason.clone());
            }
        }
        let stored = self.write(address, messages).await;
        drop(held);
        // With nothing that others need: what was decoded is gone.
        tokio::time::sleep(wait).await;
        stored
    }

    /// Verifies and decodes; none where that cannot be done at the moment, so that all comes again.
    async fn understand(
        &self,
        address: &LogicalAddress,
        portion: BatchPortion,
    ) -> Option<Vec<Incoming>> {
        let signing = match self.signing(address).await {
            Ok(signing) => signing,
            Err(error) => {
                tracing::warn!(cause = %chain(&error), "The keys of a factory cannot be read; its messages wait.");
                return None;
            }
        };
        let table = Arc::clone(&self.meta_data.read());
        let BatchPortion { messages, bytes } = portion;
        let address = address.clone();
        let decode_all = move || -> Vec<Incoming> {
            let known = table.of(address.factory_id());
            let decoded =
                messages.iter().map(|message| understand(&address, message, &known, &signing));
            decoded.collect()
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

/// Returns an error with its causes.
pub(super) fn chain(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(cause) => format!("{error}: {}", chain(cause)),
        None => error.to_string(),
    }
}

#[cfg(test)]
mod tests;
