//! Receipts: they name the reports that are stored, so that connectors may drop them. At most one
//! per interval and factory, while there are new reports.

use std::{collections::BTreeMap, time::Duration};

use asi_model::{
    FactoryId,
    messages::{PlatformMessage, Receipt},
};
use messaging::LogicalAddress;
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
/// Messages that wait for a factory beyond which it gets no receipts.
const MESSAGES_WAITING_MAX: u64 = 10_000;
/// Most writers of one round, of each factory in turn; the others follow in the next.
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
        if !self.store.reserved_reader().read().await?.writers().is_receipt_due().await? {
            return Ok(0);
        }
        let now = self.clock.now();
        let mut work = self.store.begin().await?;
        let rows = work.writers().unreceipted(WRITERS_PER_ROUND_MAX).await?;
        let mut factories: BTreeMap<FactoryId, Vec<WriterRow>> = BTreeMap::new();
        for row in rows {
            factories.entry(row.key.factory_id.clone()).or_default().push(row);
        }
        let mut count = 0;
        for (factory, rows) in factories {
            let address = LogicalAddress::FactoryRequests(factory.clone());
            // One that reads none has enough to read: what it lacks it gets once it has.
            if work.outgoing().waiting(&address).await? >= MESSAGES_WAITING_MAX {
                continue;
            }
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
                    let message = outgoing(&factory, &PlatformMessage::Receipt(receipt), now);
                    work.outgoing().add(&message).await?;
                }
                for row in rows {
                    // In the transaction of the receipt, so that it is neither forgotten nor sent
                    // for ever.
                    work.writers().receipted(&row.key, now).await?;
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicI64, Ordering};

    use asi_model::DateTime;

    use super::*;
    use crate::store::{Organisation, WriterKey};

    fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
        text.parse().expect("valid")
    }

    async fn store_with_factories(folder: &tempfile::TempDir) -> Store {
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
        let mut work = store.begin().await.expect("begun");
        let at = DateTime::from_ticks(0);
        let a = Organisation { organisation_id: id("a"), name: "a".into(), created_at: at };
        work.organisations().add(&a).await.expect("stored");
        for factory in ["A", "B"] {
            work.factories().add(&id(factory), &id("a"), factory, at).await.expect("stored");
        }
        work.commit().await.expect("committed");
        store
    }

    /// Lets writers of a factory need a receipt.
    async fn are_due(store: &Store, factory: &str, epochs: std::ops::Range<u32>) {
        let mut work = store.begin().await.expect("begun");
        for epoch in epochs {
            let key = WriterKey { factory_id: id(factory), data_set_writer_id: 1, epoch };
            let mut row = WriterRow::new(key);
            row.take(0);
            work.writers().put(&row).await.expect("stored");
        }
        work.commit().await.expect("committed");
    }

    async fn due(store: &Store) -> Vec<WriterKey> {
        let mut work = store.read().await.expect("begun");
        let rows = work.writers().unreceipted(10_000).await.expect("read");
        rows.into_iter().map(|row| row.key).collect()
    }

    #[tokio::test]
    async fn a_factory_that_reads_nothing_gets_no_more_receipts_until_it_does() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = store_with_factories(&folder).await;
        let address = LogicalAddress::FactoryRequests(id("A"));
        let mut work = store.begin().await.expect("begun");
        for _ in 0..MESSAGES_WAITING_MAX {
            let receipt = Receipt {
                message_id: new_message_id(),
                factory_id: id("A"),
                receipt_list: Vec::new(),
            };
            let message =
                outgoing(&id("A"), &PlatformMessage::Receipt(receipt), DateTime::from_ticks(1));
            work.outgoing().add(&message).await.expect("stored");
        }
        work.commit().await.expect("committed");
        for factory in ["A", "B"] {
            are_due(&store, factory, 1..2).await;
        }
        let receipter = Receipter::new(
            store.clone(),
            BrokerAccess::new(Vec::new()),
            Clock::from_fn(|| DateTime::from_ticks(1)),
            Duration::from_secs(1),
        );
        assert_eq!(receipter.round().await.expect("written"), 1, "the other's");
        let mut work = store.begin().await.expect("begun");
        assert_eq!(work.outgoing().waiting(&address).await.expect("read"), MESSAGES_WAITING_MAX);
        work.outgoing().record(&sent(MESSAGES_WAITING_MAX)).await.expect("sent");
        work.commit().await.expect("committed");
        assert_eq!(receipter.round().await.expect("written"), 1, "it was not forgotten");
    }

    /// Outcomes of so many messages that were sent, the oldest.
    fn sent(count: u64) -> Vec<messaging::RowOutcome> {
        let outcome = |row: u64| messaging::RowOutcome {
            id: messaging::RowId(i64::try_from(row).expect("few")),
            outcome: messaging::SendOutcome::Accepted,
            at: std::time::SystemTime::UNIX_EPOCH.into(),
        };
        (1..=count).map(outcome).collect()
    }

    #[tokio::test]
    async fn a_factory_with_many_writers_leaves_room_for_the_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = store_with_factories(&folder).await;
        let round = WRITERS_PER_ROUND_MAX;
        are_due(&store, "A", 0..round + 10).await;
        are_due(&store, "B", 0..1).await;
        let now = AtomicI64::new(1);
        let clock =
            Clock::from_fn(move || DateTime::from_ticks(now.fetch_add(1, Ordering::Relaxed)));
        let access = BrokerAccess::new(Vec::new());
        let receipter = Receipter::new(store.clone(), access, clock, Duration::from_secs(1));
        receipter.round().await.expect("a round");
        let waiting = due(&store).await;
        assert!(waiting.iter().all(|key| key.factory_id == id("A")), "B has its receipt");
        assert_eq!(waiting.len(), 11);

        // Its own that wait come before those that are due once more.
        are_due(&store, "A", 0..round - 1).await;
        receipter.round().await.expect("a round");
        let again = due(&store).await;
        assert_eq!(again.len(), 10);
        assert!(again.iter().all(|key| !waiting.contains(key)), "{again:?}");
    }
}
