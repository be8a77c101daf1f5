//! The daemon in each factory.
//!
//! - [`books`]: what the connector knows about networks, decisions and values, in memory, as pure
//!   functions.
//! - [`catalog`]: which variables the local servers have.
//! - [`desk`]: the one task that changes anything: books, one transaction, then the other rooms.
//! - [`outbox`]: the two ends of the link.
//! - [`store`]: the durable file.
//! - [`lease`]: which of several connectors with one credential may speak.
//! - [`ledger_export`], [`ledger_key`]: the ledger as people read it, and the key that signs it.
//! - [`operator`]: what people enter about operations without a machine.
//! - [`mod@print`]: pages to print.
//! - [`values`]: values as stored and as shown.

pub mod api;
pub mod books;
pub mod catalog;
pub mod config;
pub mod desk;
pub mod enrolment;
pub mod lease;
pub mod ledger_export;
pub mod ledger_key;
pub mod operator;
pub mod outbox;
pub mod print;
pub mod service;
pub mod store;
pub mod twin_side;
pub mod values;
