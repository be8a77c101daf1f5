//! Shared context below the handle, the service and every source's task.

use std::sync::Arc;

use opcua_stack::opcua::client::transport::IncomingBudget;
use tokio::{
    sync::{mpsc, watch},
    task::{self, JoinError},
};

use crate::{Config, InputChange, certificates::PkiDirectory, change_queue::ChangeQueue};

/// Configuration, certificates, what all connections share, and the versions of all statuses and of what is trusted.
pub(crate) struct SourceContext {
    pub(crate) config: Config,
    /// Sending side of the channel to the consumer.
    pub(crate) changes: ChangeQueue,
    /// Room for incoming messages that all connections share.
    pub(crate) incoming: Arc<IncomingBudget>,
    certificates: Arc<PkiDirectory>,
    status_version: watch::Sender<u64>,
    trust_version: watch::Sender<u64>,
}

impl SourceContext {
    /// Returns the context and the receiving side of its queue of changes.
    pub(crate) fn new(config: Config) -> (Arc<Self>, mpsc::Receiver<Vec<InputChange>>) {
        let (changes, receiver) = ChangeQueue::new(config.waiting_batches_max);
        let context = Self {
            certificates: Arc::new(PkiDirectory::new(&config)),
            incoming: Arc::new(IncomingBudget::new(config.incoming_bytes_max)),
            config,
            changes,
            status_version: watch::Sender::new(0),
            trust_version: watch::Sender::new(0),
        };
        (Arc::new(context), receiver)
    }

    /// Notifies all watchers that the status of some source has changed.
    pub(crate) fn notify_status_changed(&self) {
        self.status_version.send_modify(|version| *version = version.wrapping_add(1));
    }

    pub(crate) fn watch_status(&self) -> watch::Receiver<u64> {
        self.status_version.subscribe()
    }

    /// Notifies all sessions that other certificates are trusted than before.
    pub(crate) fn notify_trust_changed(&self) {
        self.trust_version.send_modify(|version| *version = version.wrapping_add(1));
    }

    pub(crate) fn watch_trust(&self) -> watch::Receiver<u64> {
        self.trust_version.subscribe()
    }

    pub(crate) fn certificates(&self) -> &PkiDirectory {
        &self.certificates
    }

    /// Runs work on the certificates off the async threads: it reads and writes files.
    pub(crate) async fn with_certificates<T: Send + 'static>(
        &self,
        work: impl FnOnce(&PkiDirectory) -> T + Send + 'static,
    ) -> Result<T, JoinError> {
        let certificates = Arc::clone(&self.certificates);
        task::spawn_blocking(move || work(&certificates)).await
    }
}
