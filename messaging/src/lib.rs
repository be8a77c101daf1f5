//! How the two sides talk: one supervised [`Link`] from a connector or the platform to its broker.
//!
//! This crate knows how a message travels, never what it means.
//!
//! - [`address`]: logical addresses; [`profile`]: what they are called on each kind of broker.
//! - [`definitions`]: what an external broker must be told beforehand, generated.
//! - [`envelope`]: a message with the headers that every broker can carry.
//! - [`spool`]: the pure decisions about messages that wait to be sent, and the [`SpoolStore`] that
//!   holds them. The SQL lives with the owner, in the owner's transaction.
//! - [`inbox`]: what receives; a message is stored there before it is settled.
//! - [`link`]: connects, sends from the spool, feeds the inbox, reconnects, and says truthfully how
//!   it stands.
//!
//! Delivery is at least once in both directions. Nothing here relies on a broker's deduplication,
//! on link resumption or on transactions: a receiver discards repeats by message id in the
//! transaction of their effect.

pub mod address;
mod config;
pub mod definitions;
pub mod envelope;
pub mod inbox;
pub mod link;
pub mod profile;
pub mod spool;
#[cfg(any(test, feature = "test-support"))]
pub mod test_support;
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
    Backlog, Fetch, Lane, Rejection, RowId, RowOutcome, SendOutcome, SpoolRow, SpoolStore,
    StoreError,
};
