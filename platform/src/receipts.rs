//! Receipts: they name the reports that are stored, so that connectors may drop them. At most one
//! per interval and factory, while there are new reports.

use std::{collections::BTreeMap, time::Duration};

use asi_model::{
    FactoryId,
    messages::{PlatformMessage, Receipt},
};
use tokio_util::sync::CancellationToken;

use crate::{
    broker_access::BrokerAccess,
    clock::{Clock, new_message_id},
    networks::outgoing,
    store::{Store, StoreError, WriterRow},
};

/// Service that sends receipts while [`run`](Self::run) is polled.
#[derive(Debug)]
pub struct Receipter {
    store: Store,
    broker_access: BrokerAccess,
    clock: Clock,
    interval: Duration,
}

/// Most writers in one receipt; each takes at most some 12 KB, so that a receipt stays under the
/// limit of a message.
const WRITERS_PER_RECEIPT_MAX: usize = 50;
/// Most writers of one round; the others follow in the next.
const WRITERS_PER_ROUND_MAX: u32 = 5_000;

impl Receipter {
    /// Makes a receipter over the store.
    #[must_use]
    pub const fn new(
        store: Store,
        broker_access: BrokerAccess,
        clock: Clock,
        interval: Duration,
    ) -> Self {
        Self { store, broker_access, clock, interval }
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again in the next round.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut rounds = tokio::time::interval(self.interval);
        rounds.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        while shutdown.run_until_cancelled(rounds.tick()).await.is_some() {
            if let Err(error) = self.round().await {
                tracing::warn!(%error, "Receipts could not be written.");
            }
        }
        Ok(())
    }

    /// Writes the receipts that are due; how many.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn round(&self) -> Result<usize, StoreError> {
        // A reader first: most rounds find nothing, and there is only one writer.
        if self.store.read().await?.writers().unreceipted(1).await?.is_empty() {
            return Ok(0);
        }
        let mut work = self.store.begin().await?;
        let rows = work.writers().unreceipted(WRITERS_PER_ROUND_MAX).await?;
        let mut factories: BTreeMap<FactoryId, Vec<WriterRow>> = BTreeMap::new();
        for row in rows {
            factories.entry(row.key.factory_id.clone()).or_default().push(row);
        }
        let mut count = 0;
        for (factory, rows) in factories {
            for rows in rows.chunks(WRITERS_PER_RECEIPT_MAX) {
                let receipt_list: Vec<_> = rows
                    .iter()
                    .filter_map(|row| {
                        row.sequences.receipt(row.key.data_set_writer_id, row.key.epoch)
                    })
                    .collect();
                if !receipt_list.is_empty() {
                    let receipt = Receipt {
                        message_id: new_message_id(),
                        factory_id: factory.clone(),
                        receipt_list,
                    };
                    let message =
                        outgoing(&factory, &PlatformMessage::Receipt(receipt), self.clock.now());
                    work.outgoing().add(&message).await?;
                }
                for row in rows {
                    // In the transaction of the receipt, so that it is neither forgotten nor sent
                    // for ever.
                    work.writers().receipted(&row.key).await?;
                }
                count += 1;
            }
        }
        work.commit().await?;
        metrics::counter!("verbund_receipts_total").increment(count as u64);
        self.broker_access.wake_link();
        Ok(count)
    }
}
