//! Body of the request by which a log submits a checkpoint.

use std::{fmt, str::FromStr};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use crate::{
    checkpoint::parse_size,
    merkle::Hash,
    note::{NOTE_BYTES_MAX, NoteError, SignedNote},
};

/// Most hashes of a proof in a request.
pub const PROOF_HASHES_MAX: usize = 63;
/// Longest request that is read: proof, old size and note.
const REQUEST_BYTES_MAX: usize = NOTE_BYTES_MAX + 4096;

/// Fault of a request's text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// The request is not `old <size>`, hashes, a blank line, a note.
    #[error("the request is not an old size, a proof and a signed checkpoint")]
    Form,
    /// The note cannot be read.
    #[error("the checkpoint cannot be read")]
    Note(#[from] NoteError),
}

/// A checkpoint with the proof that it continues the one of a former size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AddCheckpoint {
    /// Size at which the proof begins.
    pub old_size: u64,
    /// Consistency proof of RFC 6962, section 2.1.2.
    pub proof: Vec<Hash>,
    pub checkpoint: SignedNote,
}

impl fmt::Display for AddCheckpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "old {}", self.old_size)?;
        self.proof.iter().try_for_each(|hash| writeln!(f, "{}", STANDARD.encode(hash)))?;
        write!(f, "\n{}", self.checkpoint)
    }
}

impl FromStr for AddCheckpoint {
    type Err = RequestError;

    fn from_str(text: &str) -> Result<Self, RequestError> {
        if text.len() > REQUEST_BYTES_MAX {
            return Err(RequestError::Form);
        }
        let (head, note) = text.split_once("\n\n").ok_or(RequestError::Form)?;
        let mut lines = head.split('\n');
        let old_size = lines.next().and_then(|line| parse_size(line.strip_prefix("old ")?));
        let proof: Option<Vec<Hash>> =
            lines.map(|line| STANDARD.decode(line).ok()?.try_into().ok()).collect();
        let proof = proof.filter(|proof| proof.len() <= PROOF_HASHES_MAX);
        Ok(Self {
            old_size: old_size.ok_or(RequestError::Form)?,
            proof: proof.ok_or(RequestError::Form)?,
            checkpoint: SignedNote::parse(note)?,
        })
    }
}
