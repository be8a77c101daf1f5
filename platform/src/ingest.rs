//! Ingest: what factories and tools send becomes rows, in batches, each message once.
//!
//! A batch is decoded by whoever brought it, then handed to the one task that writes. That task
//! takes all batches that wait, of whatever address, into one transaction: the raw message, the
//! discarding of repeats and every effect commit together, and only then is anything settled with
//! the broker or told to pages. What cannot be used becomes a dead letter in the same transaction;
//! what cannot be stored is released and comes again.

mod apply;
mod decode;
mod leases;
mod sequences;
mod service;

pub use decode::{Incoming, IncomingReport, decode};
pub use sequences::SequenceSet;
pub use service::{Ingest, IngestHandle};
