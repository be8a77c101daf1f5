//! Ingest of messages from factories and tools: in batches, each message exactly once.
//!
//! A batch is decoded on the task that received it, a portion at a time, and written by one task. The writer takes all
//! waiting batches, of all addresses, into one transaction: the raw message, deduplication and all
//! effects commit together. Only then are messages settled with the broker and events published to
//! pages. A message that cannot be used becomes a dead letter in the same transaction; one that
//! cannot be stored is released and delivered again.

mod access_arbiter;
mod apply;
mod dead_letter;
mod decode;
mod handle;
mod heartbeats;
mod known_meta_data;
mod lease_arbiter;
mod pace;
mod portion;
mod quota_arbiter;
mod room;
mod service;
mod signature_arbiter;
mod signatures;
mod signs_of_life;
mod unit;
mod used_up;

pub use decode::{Incoming, IncomingReport, decode};
pub use handle::IngestHandle;
pub use portion::Unpacked;
pub use room::RoomConfig;
pub use service::{Ingest, IngestConfig};
