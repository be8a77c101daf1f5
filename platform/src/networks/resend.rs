//! Resends parts that no factory has answered: a reconciler that compares sent parts with
//! acknowledgements.

use std::time::Duration;

use asi_model::messages::{OperationNetworkMessage, PlatformMessage, Withdraw};
use tokio_util::sync::CancellationToken;

use super::parts::outgoing;
use crate::{
    broker_access::BrokerAccess,
    clock::{Clock, new_message_id},
    store::{NetworkPart, Scope, Store, StoreError, Work},
};

/// Looks for overdue parts from time to time.
#[derive(Debug)]
pub struct Resender {
    store: Store,
    broker_access: BrokerAccess,
    clock: Clock,
    resend_after: Duration,
}

/// Bound on one transaction: ingest waits for the writer meanwhile.
const PARTS_PER_ROUND_MAX: u32 = 100;
/// Bound of the doubling: a plant that was off for weeks gets its part within the hour.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

impl Resender {
    /// Makes a reconciler over the store.
    #[must_use]
    pub const fn new(
        store: Store,
        broker_access: BrokerAccess,
        clock: Clock,
        resend_after: Duration,
    ) -> Self {
        Self { store, broker_access, clock, resend_after }
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again in the next round.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut rounds = tokio::time::interval(self.resend_after.min(Duration::from_secs(10)));
        while shutdown.run_until_cancelled(rounds.tick()).await.is_some() {
            match self.round().await {
                Ok(0) => {}
                Ok(count) => tracing::info!(count, "Unanswered parts of networks were sent again."),
                Err(error) => tracing::warn!(%error, "Unanswered parts could not be looked for."),
            }
        }
        Ok(())
    }

    /// Sends what is overdue; how many parts.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn round(&self) -> Result<usize, StoreError> {
        let now = self.clock.now();
        // Asked of a reader first: most rounds find nothing and need not queue for the writer.
        if self.store.reserved_reader().read().await?.parts().overdue(now, 1).await?.is_empty() {
            return Ok(0);
        }
        let mut work = self.store.begin().await?;
        let overdue = work.parts().overdue(now, PARTS_PER_ROUND_MAX).await?;
        let count = overdue.len();
        for part in overdue {
            self.send_again(&mut work, part).await?;
        }
        work.commit().await?;
        metrics::counter!("verbund_parts_resent_total").increment(count as u64);
        // After the commit: the link would find nothing before it.
        self.broker_access.wake_link();
        Ok(count)
    }

    /// The same content under a new message id: the old one may be known to the connector while its
    /// answer was lost.
    async fn send_again(&self, work: &mut Work, mut part: NetworkPart) -> Result<(), StoreError> {
        let Some(row) =
            work.networks().lookup(&Scope::Platform, &part.operation_network_id).await?
        else {
            return Ok(());
        };
        let now = self.clock.now();
        part.message_id = new_message_id();
        part.sent_at = now;
        let wait = self
            .resend_after
            .saturating_mul(2_u32.saturating_pow(part.sent_count))
            .min(LONGEST_WAIT);
        part.sent_count = part.sent_count.saturating_add(1);
        part.resend_at = now.after(wait);
        let message = if part.is_withdrawal {
            PlatformMessage::Withdraw(Withdraw {
                message_id: part.message_id.clone(),
                factory_id: part.factory_id.clone(),
                operation_network_id: part.operation_network_id.clone(),
                revision: part.revision,
            })
        } else {
            let operation_network = serde_json::from_str(&part.document).map_err(|error| {
                StoreError::Corrupt { column: "document", reason: error.to_string() }
            })?;
            PlatformMessage::OperationNetwork(OperationNetworkMessage {
                message_id: part.message_id.clone(),
                factory_id: part.factory_id.clone(),
                collaboration_id: row.collaboration_id,
                revision: part.revision,
                operation_network,
            })
        };
        work.outgoing().add(&outgoing(&part.factory_id, &message, now)).await?;
        work.parts().put(&part).await
    }
}
