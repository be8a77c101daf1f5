//! Notifies pages of the progress of operations: reads a changed network again, at most a few times
//! a second, and publishes to each recipient what its own fields show.

use std::{
    collections::{BTreeSet, HashMap, HashSet},
    sync::Arc,
    time::Duration,
};

use asi_model::{OperationId, OperationNetworkId, OrganisationId};
use parking_lot::Mutex;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;

use crate::{
    accesses::Withheld,
    live::{LiveLog, Notification},
    progress::{OperationProgress, of_operation},
    store::{Scope, Store, StoreError},
};

/// Time between two reads of changed networks.
const INTERVAL: Duration = Duration::from_millis(200);
/// Most operations whose published progress is remembered; beyond, all are forgotten and published
/// once more.
const REMEMBERED_MAX: usize = 50_000;

/// Service that publishes progress while [`run`](Self::run) is polled.
pub struct ProgressNotifier {
    store: Store,
    live: LiveLog,
    changed: Arc<ChangedNetworks>,
    published:
        HashMap<(OrganisationId, OperationNetworkId, OperationId), Withheld<OperationProgress>>,
}

/// Announces networks that may have changed.
#[derive(Clone)]
pub struct ProgressNotifierHandle(Arc<ChangedNetworks>);

#[derive(Default)]
struct ChangedNetworks {
    networks: Mutex<HashSet<OperationNetworkId>>,
    wake: Notify,
}

impl ProgressNotifierHandle {
    /// Reports about these networks arrived.
    pub fn changed(&self, networks: HashSet<OperationNetworkId>) {
        if !networks.is_empty() {
            self.0.networks.lock().extend(networks);
            self.0.wake.notify_one();
        }
    }
}

impl ProgressNotifier {
    /// Makes the service, which has published nothing yet, and its handle.
    #[must_use]
    pub fn new(store: Store, live: LiveLog) -> (Self, ProgressNotifierHandle) {
        let changed = Arc::new(ChangedNetworks::default());
        let handle = ProgressNotifierHandle(Arc::clone(&changed));
        (Self { store, live, changed, published: HashMap::new() }, handle)
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again with the next notifications.
    pub async fn run(mut self, shutdown: CancellationToken) -> Result<(), StoreError> {
        while shutdown.run_until_cancelled(self.changed.wake.notified()).await.is_some() {
            // Taken before they are read: a change that comes meanwhile counts for the next round.
            let networks = std::mem::take(&mut *self.changed.networks.lock());
            for network in networks {
                if let Err(error) = self.publish_progress(&network).await {
                    tracing::warn!(operation_network.id = %network, %error, "Progress could not be read.");
                }
            }
            // Changes gather meanwhile: a network is read once for many reports.
            if shutdown.run_until_cancelled(tokio::time::sleep(INTERVAL)).await.is_none() {
                return Ok(());
            }
        }
        Ok(())
    }

    async fn publish_progress(&mut self, id: &OperationNetworkId) -> Result<(), StoreError> {
        // One network at a time, by a reader that no page waits for.
        let mut work = self.store.reserved_reader().read().await?;
        let Some(row) = work.networks().lookup(&Scope::Platform, id).await? else { return Ok(()) };
        let recipients: BTreeSet<&OrganisationId> =
            row.network.requests().flat_map(|(_, _, request)| &request.recipient_list).collect();
        if self.published.len() > REMEMBERED_MAX {
            // Forgetting costs one event too many per operation, and no page notices.
            self.published.clear();
        }
        for recipient in recipients {
            let fields = work.fields().list(&Scope::Organisation(recipient.clone()), id).await?;
            let mut fields = fields.divide(|field| field.key.request.operation_id.clone());
            for operation in &row.network.operation_list {
                let own = fields.remove(&operation.operation_id);
                let Some(own) = own.filter(|own| !own.contents().is_empty()) else { continue };
                let progress =
                    own.map_with(operation, |operation, fields| of_operation(operation, &fields));
                let key = (recipient.clone(), id.clone(), operation.operation_id.clone());
                if self.published.insert(key, progress.clone()).as_ref() != Some(&progress) {
                    let audience = vec![recipient.clone()];
                    self.live.publish([Notification::progress(id.clone(), progress, audience)]);
                }
            }
        }
        Ok(())
    }
}
