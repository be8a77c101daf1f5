//! The ledger: everything that left this factory, provable years later.
//!
//! One hash chain per recipient organisation. Entries say what was consented, queued, sent, receipted or withdrawn; a
//! QUEUED entry commits to the values by a root over salted hashes, the values themselves lie in the report's row, which
//! retention may empty without breaking the chain. A daily checkpoint, signed with the connector's own key, states the
//! heads of all chains. This module is pure; the store writes what it yields in the transaction of the effect.

mod chain;
mod checkpoint;
mod entry;
mod values;
mod verification;

pub use chain::{Head, Heads, LinkedEntry, chain_hash};
pub use checkpoint::{Checkpoint, LedgerKey, LedgerKeyError};
pub use entry::{Entry, Event, SequenceRange};
pub use values::{SALT_BYTES, ValuesError, values_root};
pub use verification::{LedgerFault, StoredEntry, Verification, Verifier};

/// A SHA-256 digest.
pub type Hash = [u8; 32];
