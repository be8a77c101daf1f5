//! Messaging between connectors and the platform: one supervised [`Link`] from each to its broker.
//!
//! This crate transports messages and never reads their bodies.
//!
//! - [`address`]: logical addresses; [`profile`]: their names on each kind of broker.
//! - [`definitions`]: generated configuration of external brokers.
//! - [`envelope`]: a message with the headers that every broker can carry.
//! - [`spool`]: the pure decisions about messages that wait to be sent, and the [`SpoolStore`] that
//!   stores them. The SQL is the owner's, in the owner's transaction.
//! - [`inbox`]: the receiving side; it stores a message before the link settles it.
//! - [`link`]: connects, sends from the spool, feeds the inbox, reconnects, and reports its state.
//!
//! Delivery is at least once in both directions. Nothing here relies on a broker's deduplication,
//! on link resumption or on transactions: a receiver discards repeats by message id in the
//! transaction of their effect.

pub mod address;
mod clock;
mod config;
pub mod definitions;
pub mod envelope;
pub mod inbox;
pub mod link;
pub mod profile;
pub mod spool;
#[cfg(any(test, feature = "test-support"))]
pub mod test_support;
mod text_form;
mod transport;

pub use address::{InvalidAddress, LogicalAddress};
pub use config::{
    BrokerUrl, ClientIdentity, HttpProxy, InvalidBrokerUrl, LinkConfig, LinkError, LinkLimits,
    Login, Roots, TlsConfig,
};
pub use envelope::{BodyError, ContentEncoding, Envelope};
pub use inbox::{Delivery, Inbox, Settlement};
pub use link::{Link, LinkHandle, LinkPhase, LinkState};
pub use profile::{BrokerProfile, InvalidTemplate, Terminus};
pub use spool::{
    Backlog, Fetch, Lane, Rejection, RowId, RowOutcome, SendOutcome, SpoolError, SpoolRow,
    SpoolStore,
};
