//! Receivers of effects.

use std::sync::Arc;

use connector_state::EngineCommand;
use messaging::LinkHandle;
use tokio::sync::mpsc;

use crate::{in_flight::InFlight, keep_alive_queue::KeepAliveQueue, live_events::LiveEvents};

/// Receivers of the effects of committed transactions.
pub struct Outputs {
    pub twin: twin::TwinHandle,
    /// Commands for the mapping engine, in the order of the decisions.
    pub mappings: mpsc::Sender<Vec<EngineCommand>>,
    /// Sends the messages of the spool; none before enrolment.
    pub link: Option<LinkHandle>,
    pub keep_alives: Arc<KeepAliveQueue>,
    /// Messages that the link composed.
    pub in_flight: Arc<InFlight>,
    pub events: LiveEvents,
}
