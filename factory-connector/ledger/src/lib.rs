//! The ledger: everything that left this factory, provable years later.
//!
//! One hash chain per recipient organisation. Entries say what was consented, queued, sent,
//! receipted or withdrawn; a QUEUED entry commits to the values by a root over salted hashes, the
//! values themselves lie in the report's row, which retention may empty without breaking the chain.
//! The end of each chain is signed with the connector's own key whenever it grows; so are a daily
//! checkpoint over all chains, receipts of ended consents, and anchors in the place of what
//! retention removed. This module is pure; the store writes what it yields in the transaction of
//! the effect.

mod anchor;
mod chain;
mod checkpoint;
mod entry;
mod head;
mod key;
mod revocation;
mod values;
mod verification;

pub use anchor::Anchor;
pub use chain::{Head, Heads, LinkedEntry, chain_hash};
pub use checkpoint::{Checkpoint, CheckpointHead};
pub use entry::{Entry, Event, EventKind, SequenceRange};
pub use head::SignedHead;
pub use key::{InvalidKey, LedgerKey};
pub use revocation::{RevocationReceipt, RevokedField, RevokedWriter, Sequences};
pub use values::{SALT_BYTES, ValuesError, values_root};
pub use verification::{
    CheckedEntry, LedgerFault, ReportDigest, StoredConsent, StoredEntry, StoredHead, StoredReport,
    StoredStatement, Surroundings, Verification, Verifier,
};

/// A SHA-256 digest.
pub type Hash = [u8; 32];
