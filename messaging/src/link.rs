//! One supervised connection to a broker: sends from the spool, feeds the inbox, reconnects, tells
//! how it stands.

mod backoff;
mod cursor;
mod incoming;
mod outgoing;
mod shared;
mod state;
mod supervisor;

use std::{sync::Arc, time::Duration};

use time::OffsetDateTime;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::{
    address::LogicalAddress,
    config::{LinkConfig, LinkError},
    envelope::Envelope,
    inbox::Inbox,
    spool::SpoolStore,
    transport,
};
use shared::Shared;
use supervisor::Supervisor;

pub use state::{LinkPhase, LinkState};

/// The link; [`run`](Self::run) it.
pub struct Link {
    supervisor: Supervisor,
}

/// Speaks to a running [`Link`].
#[derive(Clone)]
pub struct LinkHandle {
    shared: Arc<Shared>,
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
        let transport = transport::new(&config)?;
        let shared = Arc::new(Shared::new(broker, config.consumed.clone()));
        let handle = LinkHandle { shared: Arc::clone(&shared) };
        Ok((Self { supervisor: Supervisor { config, transport, store, inbox, shared } }, handle))
    }

    /// Runs until `shutdown`; then finishes what is in flight within a short time and closes the
    /// connection.
    pub async fn run(self, shutdown: CancellationToken) {
        self.supervisor.run(shutdown).await;
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

    /// Tells that the store shows rows that it hid before. They are looked for as after an outage:
    /// the newest first.
    pub fn begin_anew(&self) {
        self.shared.anew.notify_one();
    }

    /// Sends a message that is not kept, ahead of what waits. It is lost with the connection, or
    /// where the broker rejects it: whoever posts it repeats it until it is answered.
    pub fn post(&self, address: LogicalAddress, envelope: Envelope) {
        self.shared.post(address, envelope);
    }

    /// Ends the connection for a while, as when another one is to have the broker for itself.
    pub fn rest(&self, reason: impl Into<String>, pause: Duration) {
        self.shared.rest(reason.into(), pause);
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
