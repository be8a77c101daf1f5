//! Witness of a log: accepts a checkpoint only where a proof joins it to the last accepted one, C2SP
//! tlog-witness 1.0.0, "add-checkpoint".
//!
//! The caller keeps the accepted head of each log. Comparing with it and storing the new one is one
//! atomic step of the caller, durable before the answer.

mod request;
#[cfg(test)]
mod tests;

pub use request::{AddCheckpoint, RequestError};

use crate::{
    checkpoint::{Checkpoint, CheckpointError},
    merkle::{Hash, ProofError, empty_root, verify_consistency},
    note::{NoteError, VerifierKey},
};

/// Size and root that a witness accepted last for a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TreeHead {
    /// Number of entries.
    pub size: u64,
    pub root: Hash,
}

impl TreeHead {
    /// Returns the head of a log without entries, with which every log begins.
    #[must_use]
    pub fn empty() -> Self {
        Self { size: 0, root: empty_root() }
    }
}

/// Reason to refuse a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The note is not signed with the key of the log (403).
    #[error("the checkpoint is not signed with the key of its log")]
    Signature(#[source] NoteError),
    /// The signed text is no checkpoint (400).
    #[error("the signed text is no checkpoint")]
    Checkpoint(#[source] CheckpointError),
    /// The checkpoint is one of another log (404).
    #[error("the checkpoint is one of another log")]
    Origin,
    /// The proof begins beyond the checkpoint (400).
    #[error("the proof begins beyond the checkpoint")]
    OldSize,
    /// The proof does not begin at the last accepted size (409).
    #[error("the proof does not begin at the last accepted size {size}")]
    Stale {
        /// The last accepted size.
        size: u64,
    },
    /// The log did not grow from what was accepted: it was cut, forked or replaced (422).
    #[error("the checkpoint does not continue the log that was accepted")]
    Inconsistent(#[source] ProofError),
}

/// Decides about a checkpoint of a log, given its key and the head accepted last.
///
/// # Errors
/// [`Refusal`], in the order of the specification.
pub fn accept(
    request: &AddCheckpoint,
    key: &VerifierKey,
    known: &TreeHead,
) -> Result<Checkpoint, Refusal> {
    let checkpoint: Checkpoint = request.checkpoint.text().parse().map_err(Refusal::Checkpoint)?;
    if checkpoint.origin != key.name() {
        return Err(Refusal::Origin);
    }
    request.checkpoint.verify([key]).map_err(Refusal::Signature)?;
    if request.old_size > checkpoint.size {
        return Err(Refusal::OldSize);
    }
    if request.old_size != known.size {
        return Err(Refusal::Stale { size: known.size });
    }
    verify_consistency(
        (known.size, &known.root),
        (checkpoint.size, &checkpoint.root),
        &request.proof,
    )
    .map_err(Refusal::Inconsistent)?;
    Ok(checkpoint)
}
