//! One supervised connection to a broker: sends from the spool, feeds the inbox, reconnects, tells how it stands.

mod config;
mod state;

use std::sync::Arc;

use time::OffsetDateTime;
use tokio::sync::{Notify, watch};
use tokio_util::sync::CancellationToken;

use crate::{address::LogicalAddress, inbox::Inbox, spool::SpoolStore};

pub use config::{BrokerUrl, ClientIdentity, InvalidBrokerUrl, LinkConfig, LinkLimits, Login, Roots, TlsConfig};
pub use state::{LinkPhase, LinkState};

/// Why a link cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// There is nobody to connect to.
    #[error("no broker address is configured")]
    NoBroker,
    /// The trusted roots or the client certificate cannot be used.
    #[error("the TLS settings of the link cannot be used: {reason}")]
    Tls {
        /// What is wrong.
        reason: String,
    },
}

/// The link; [`run`](Self::run) it.
pub struct Link {
    config: LinkConfig,
    store: Arc<dyn SpoolStore>,
    inbox: Arc<dyn Inbox>,
    shared: Arc<Shared>,
}

/// Speaks to a running [`Link`].
#[derive(Clone)]
pub struct LinkHandle {
    shared: Arc<Shared>,
}

pub(crate) struct Shared {
    state: watch::Sender<LinkState>,
    consumed: watch::Sender<Vec<LogicalAddress>>,
    wake: Notify,
    rewind: Notify,
    reconnect: Notify,
}

impl Link {
    /// Makes a link that does nothing before it runs.
    ///
    /// # Errors
    /// [`LinkError`] when the configuration can never work.
    pub fn new(
        config: LinkConfig,
        store: Arc<dyn SpoolStore>,
        inbox: Arc<dyn Inbox>,
    ) -> Result<(Self, LinkHandle), LinkError> {
        let broker = config.brokers.first().ok_or(LinkError::NoBroker)?.to_string();
        let shared = Arc::new(Shared {
            state: watch::Sender::new(LinkState::initial(broker, OffsetDateTime::now_utc())),
            consumed: watch::Sender::new(config.consumed.clone()),
            wake: Notify::new(),
            rewind: Notify::new(),
            reconnect: Notify::new(),
        });
        let handle = LinkHandle { shared: Arc::clone(&shared) };
        Ok((Self { config, store, inbox, shared }, handle))
    }

    /// Runs until `shutdown`; then finishes what is in flight within a short time and closes the connection.
    pub async fn run(self, shutdown: CancellationToken) {
        let Self { config: _, store: _, inbox: _, shared } = self;
        shutdown.cancelled().await;
        shared.state.send_modify(|state| state.enter(LinkPhase::Stopped, None, OffsetDateTime::now_utc()));
    }
}

impl LinkHandle {
    /// How the link stands, and every change of it.
    #[must_use]
    pub fn state(&self) -> watch::Receiver<LinkState> {
        self.shared.state.subscribe()
    }

    /// Tells that new rows were committed to the spool.
    pub fn wake(&self) {
        self.shared.wake.notify_one();
    }

    /// Tells that rows which were sent, parked or skipped before wait (again).
    pub fn rewind(&self) {
        self.shared.rewind.notify_one();
    }

    /// Replaces the set of addresses to receive from, without disturbing those that stay.
    pub fn set_consumed(&self, addresses: Vec<LogicalAddress>) {
        self.shared.consumed.send_if_modified(|consumed| {
            let is_new = *consumed != addresses;
            *consumed = addresses;
            is_new
        });
    }

    /// Tells that a receipt of the platform arrived.
    pub fn receipted(&self, at: OffsetDateTime) {
        self.shared.state.send_modify(|state| state.last_receipted_at = Some(at));
    }

    /// Tries now instead of at the end of the pause, as after somebody mended the cause.
    pub fn reconnect_now(&self) {
        self.shared.reconnect.notify_one();
    }
}
