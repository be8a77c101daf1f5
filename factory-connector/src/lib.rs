//! The daemon in each factory. Start reading at [`service::start`].
//!
//! - [`coordinator`]: the one task that changes anything: use cases on the state of the crate
//!   `connector-state`, one transaction, then its effects.
//! - [`store`]: the durable file.
//! - [`link_adapter`], [`twin_adapter`]: the coordinator as link and twin see it.
//! - [`in_flight`], [`keep_alive_queue`]: what coordinator and link share.
//! - [`catalog`]: variables of the local servers.
//! - [`clock`]: clock and random numbers of the machine.
//! - [`lease`]: the right to send, of one among several connectors with one credential.
//! - [`live_events`]: events for open pages.
//! - [`ledger_export`], [`ledger_key`]: the ledger as people read it, and the key that signs it.
//! - [`message_signer`]: signatures of the messages to the platform.
//! - [`passwords`]: sealing of the passwords in the store.
//! - [`mod@print`]: pages to print.

pub mod api;
pub mod catalog;
pub mod clock;
pub mod config;
pub mod coordinator;
pub mod enrolment;
pub mod in_flight;
pub mod keep_alive_queue;
pub mod lease;
pub mod ledger_export;
pub mod ledger_key;
pub mod link_adapter;
pub mod live_events;
pub mod message_signer;
pub mod passwords;
pub mod print;
pub mod service;
pub mod store;
pub mod twin_adapter;
