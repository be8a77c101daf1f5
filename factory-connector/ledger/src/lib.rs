//! Ledger: a tamper-evident record of all values that left this factory.
//!
//! One hash chain per recipient organisation. Entries record consents, and reports that were queued,
//! sent, receipted or withdrawn. A QUEUED entry commits to the values by a root over salted hashes;
//! the values themselves are in the report's row, which retention may empty without breaking the
//! chain; an entry states what it emptied. The head of each chain is signed with the connector's key whenever it grows; so are a
//! daily checkpoint over all chains, receipts of ended consents, and anchors in place of entries
//! that retention removed. Each chain is a transparency log, too: a Merkle tree over its entries,
//! whose checkpoints are signed in a published format and prove them when kept elsewhere. This
//! crate is pure; the store writes the entries in the transaction of their effect.

mod anchor;
mod answer;
pub mod audit;
mod basis;
mod chain;
mod checkpoint;
mod entry;
mod head;
mod header;
mod history;
mod key;
mod log;
mod past;
mod preview;
mod retention;
mod revocation;
mod seal;
mod sequence_range;
mod values;
mod verification;
mod witnessing;

pub use anchor::Anchor;
pub use answer::{Answered, HeldCheckpoint, InvalidAnswer};
pub use basis::basis_for_recipients;
pub use chain::{Head, Heads, LinkedEntry, chain_hash};
pub use checkpoint::{CheckpointHead, HeadsCheckpoint};
pub use entry::{Event, EventKind, LedgerEntry};
pub use head::SignedHead;
pub use key::{InvalidKey, LedgerKey};
pub use log::{Log, LogStart, Logs, Predecessor, log_verifier};
pub use past::past_root;
pub use preview::preview_hash;
pub use retention::{RetentionRule, RetentionStatement};
pub use revocation::{ReceiptError, RevocationReceipt, RevokedField, RevokedWriter, Sequences};
pub use seal::CheckpointSeal;
pub use sequence_range::SequenceRange;
pub use values::{SALT_BYTES, ValuesError, values_root};
pub use verification::{
    CheckedEntry, LedgerFault, ReportDigest, StoredConsent, StoredEntry, StoredHead, StoredLog,
    StoredReport, StoredSeal, StoredStatement, Surroundings, Verification, Verifier,
};
pub use witnessing::{ConflictKind, CosignedCheckpoint, LogConflict, Witnessing};

pub use transparency_log::Hash;
