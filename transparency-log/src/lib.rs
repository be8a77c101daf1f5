//! Transparency log: proofs that a log only ever grew, in published formats that others' tools read.
//!
//! - [`merkle`]: the tree of RFC 6962 and RFC 9162, section 2.1, with its proofs.
//! - [`note`]: signed texts, C2SP signed-note 1.0.0.
//! - [`checkpoint`]: size and root of a log, C2SP tlog-checkpoint 1.0.0.
//! - [`witness`]: the rule by which others countersign checkpoints, C2SP tlog-witness 1.0.0.
//!
//! The crate is pure: it holds no log, only what is needed to extend and to check one. A log of any
//! size is extended and proven from a number of hashes that grows with the logarithm of its size.

pub mod checkpoint;
pub mod merkle;
pub mod note;
pub mod witness;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use merkle::{
    Hash, LeafRange, ProofError, consistency_proof, empty_root, inclusion_proof, leaf_hash,
    node_hash, verify_consistency, verify_inclusion,
};
pub use note::{KeyError, KeyKind, NoteError, NoteKey, SignedNote, VerifiedSignature, VerifierKey};
pub use witness::{AddCheckpoint, Refusal, TreeHead};
