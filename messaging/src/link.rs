//! One supervised connection to a broker: sends from the spool, feeds the inbox, reconnects, and
//! reports its state.

mod backoff;
mod consumers;
mod context;
mod cursor;
mod sender;
mod state;
mod supervisor;
mod volatile;

use std::{sync::Arc, time::Duration};

use time::OffsetDateTime;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use crate::{
    address::LogicalAddress,
    config::{LinkConfig, LinkError, Login},
    envelope::Envelope,
    inbox::Inbox,
    spool::SpoolStore,
    transport,
};
use context::LinkContext;
use supervisor::Supervisor;

pub use state::{LinkPhase, LinkState};

/// A link that does nothing until it [runs](Self::run).
pub struct Link {
    supervisor: Supervisor,
}

/// Handle of a running [`Link`].
#[derive(Clone)]
pub struct LinkHandle {
    context: Arc<LinkContext>,
}

impl Link {
    /// Creates a link and its handle.
    ///
    /// # Errors
    /// [`LinkError`] when the configuration can never work.
    pub fn new(
        config: LinkConfig,
        store: Arc<dyn SpoolStore>,
        inbox: Arc<dyn Inbox>,
    ) -> Result<(Self, LinkHandle), LinkError> {
        let broker = config.brokers.first().ok_or(LinkError::NoBroker)?.to_string();
        let context = LinkContext::new(broker, config.consumed.clone(), config.login.clone());
        let transport = transport::new(&config, context.login.subscribe())?;
        let context = Arc::new(context);
        let handle = LinkHandle { context: Arc::clone(&context) };
        Ok((Self { supervisor: Supervisor { config, transport, store, inbox, context } }, handle))
    }

    /// Runs until `shutdown`; then finishes what is in flight within a short time and closes the
    /// connection.
    pub async fn run(self, shutdown: CancellationToken) {
        self.supervisor.run(shutdown).await;
    }
}

impl LinkHandle {
    /// Returns the state of the link, and every change of it.
    #[must_use]
    pub fn state(&self) -> watch::Receiver<LinkState> {
        self.context.state.subscribe()
    }

    /// Signals that new rows were committed to the spool.
    pub fn wake(&self) {
        self.context.wake.notify_one();
    }

    /// Signals that rows which were sent, parked or skipped before wait (again).
    pub fn rewind(&self) {
        self.context.rewind.notify_one();
    }

    /// Reads the spool from its beginning, as after an outage: the newest rows first. For a store
    /// that returns rows which it hid before.
    pub fn restart_reading(&self) {
        self.context.restart.notify_one();
    }

    /// Sends a message that is not in the spool, ahead of those that are. It is lost with the
    /// connection, or when the broker rejects it: the sender repeats it until it is answered.
    pub fn send_volatile(&self, address: LogicalAddress, envelope: Envelope) {
        self.context.send_volatile(address, envelope);
    }

    /// Ends the connection and stays away for a while, as when another process is to have the
    /// broker for itself.
    pub fn back_off(&self, reason: impl Into<String>, pause: Duration) {
        self.context.back_off(reason.into(), pause);
    }

    /// Replaces the set of addresses to receive from, without disturbing those that stay.
    pub fn set_consumed(&self, addresses: Vec<LogicalAddress>) {
        self.context.consumed.send_if_modified(|consumed| {
            let is_new = *consumed != addresses;
            *consumed = addresses;
            is_new
        });
    }

    /// Notes that a receipt of the platform arrived.
    pub fn receipted(&self, at: OffsetDateTime) {
        self.context.state.send_modify(|state| state.last_receipted_at = Some(at));
    }

    /// Replaces the login from the next connection on, and ends a pause after a refusal. A connection that
    /// is up stays: the broker decides how long a former password holds.
    pub fn set_login(&self, login: Login) {
        self.context.login.send_replace(login);
        self.reconnect_now();
    }

    /// Connects now instead of at the end of the pause, as after a person removed the cause.
    pub fn reconnect_now(&self) {
        self.context.reconnect.notify_one();
    }
}
