//! Witness of factories' ledgers: the key with which the platform countersigns checkpoints, and the
//! rule by which it does.
//!
//! The key of a log is trusted on first use: it comes with the log's first checkpoint, over the
//! connection that the factory's credential opened, and is pinned for that log. A recipient who was
//! told the key by the factory compares it with the one that is shown here.

use std::path::{Path, PathBuf};

use asi_model::{
    DateTime,
    messages::{LedgerCheckpoint, LedgerCheckpointResult, ledger_log_origin},
};
use ed25519_dalek::{
    SigningKey,
    pkcs8::{DecodePrivateKey as _, EncodePrivateKey as _, spki::der::pem::LineEnding},
};
use transparency_log::{
    AddCheckpoint, KeyKind, NoteKey, Refusal, SignedNote, TreeHead, VerifierKey, witness,
};

use crate::certificates;

/// Name in the platform's cosignatures. Several platforms with this name differ in their keys.
const NAME: &str = "verbund-platform/witness";
/// Name of the key's file in the data directory.
const KEY_FILE: &str = "witness-key.pem";

/// Longest checkpoint, signatures included. One has three lines and a signature; more are for extensions.
const CHECKPOINT_BYTES_MAX: usize = 4 * 1024;

/// The witness's key cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WitnessError {
    /// The file cannot be read.
    #[error("cannot read {}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    /// The file cannot be written.
    #[error("cannot store the witness's key")]
    Write(#[source] certificates::CertificateError),
    /// The file has no Ed25519 key.
    #[error("{} is no Ed25519 key", path.display())]
    Key { path: PathBuf },
}

/// The platform's key as a witness.
#[derive(Debug, Clone)]
pub struct WitnessKey(NoteKey);

/// A log as far as the platform has countersigned it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WitnessedLog {
    /// Number of the log among those that replaced each other, from 1.
    pub epoch: u32,
    /// The key of the log, as it came with the first checkpoint.
    pub verifier_key: VerifierKey,
    /// Size and root of the newest checkpoint.
    pub head: TreeHead,
    /// The newest checkpoint with the signatures of log and platform.
    pub checkpoint: SignedNote,
    pub cosigned_at: DateTime,
    /// Size of the first checkpoint that came: what was before is not witnessed entry by entry.
    pub first_size: u64,
    pub first_seen_at: DateTime,
    /// The last checkpoint that was refused for its contradiction, and the time.
    pub refused: Option<(String, DateTime)>,
}

/// Decision about a checkpoint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Judgement {
    pub result: LedgerCheckpointResult,
    /// The log to store, where it changes.
    pub log: Option<WitnessedLog>,
}

impl WitnessKey {
    /// Reads the key from its file in the data directory, making it where there is none.
    ///
    /// # Errors
    /// [`WitnessError`].
    pub fn open(data_directory: &Path) -> Result<Self, WitnessError> {
        let path = data_directory.join(KEY_FILE);
        let no_key = || WitnessError::Key { path: path.clone() };
        let key = match std::fs::read_to_string(&path) {
            Ok(pem) => SigningKey::from_pkcs8_pem(&pem).map_err(|_| no_key())?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let key = SigningKey::from_bytes(&rand::random());
                let pem = key.to_pkcs8_pem(LineEnding::LF).map_err(|_| no_key())?;
                certificates::write(&path, pem.as_bytes(), 0o600).map_err(WitnessError::Write)?;
                key
            }
            Err(source) => return Err(WitnessError::File { path, source }),
        };
        Self::new(key).ok_or_else(no_key)
    }

    fn new(key: SigningKey) -> Option<Self> {
        NoteKey::new(NAME, KeyKind::CosignatureV1, key).ok().map(Self)
    }

    /// Returns the public half, with the name.
    #[must_use]
    pub const fn verifier(&self) -> &VerifierKey {
        self.0.verifier()
    }

    /// Judges a checkpoint of a factory. `newest` is the log of the recipient with the highest epoch;
    /// the judgement holds as long as it does.
    ///
    /// # Errors
    /// The reason for which the message says nothing, as a sentence.
    pub fn judge(
        &self,
        message: &LedgerCheckpoint,
        newest: Option<&WitnessedLog>,
        now: DateTime,
    ) -> Result<Judgement, String> {
        if newest.is_some_and(|newest| newest.epoch > message.epoch) {
            return Ok(Judgement { result: LedgerCheckpointResult::Stale, log: None });
        }
        let known = newest.filter(|newest| newest.epoch == message.epoch);
        let request: AddCheckpoint =
            message.add_checkpoint.parse().map_err(|error| format!("{error}."))?;
        let bytes = request.checkpoint.to_string().len();
        if bytes > CHECKPOINT_BYTES_MAX {
            return Err(format!(
                "The checkpoint has {bytes} bytes; {CHECKPOINT_BYTES_MAX} are allowed."
            ));
        }
        let key = log_key(message)?;
        if let Some(known) = known.filter(|known| known.verifier_key != key) {
            let log = Some(known.refusing(&request, now));
            return Ok(Judgement { result: LedgerCheckpointResult::OtherKey, log });
        }
        let head = known.map_or_else(TreeHead::empty, |known| known.head);
        let (result, log) = match witness::accept(&request, &key, &head) {
            Ok(checkpoint) => {
                let head = TreeHead { size: checkpoint.size, root: checkpoint.root };
                let log = self.cosigned(message.epoch, key, request, head, known, now)?;
                (LedgerCheckpointResult::Cosigned, Some(log))
            }
            Err(Refusal::Stale { .. }) => (LedgerCheckpointResult::Stale, None),
            Err(Refusal::Inconsistent(_)) => {
                let log = known.map(|known| known.refusing(&request, now));
                (LedgerCheckpointResult::Inconsistent, log)
            }
            Err(refusal) => return Err(format!("{refusal}.")),
        };
        Ok(Judgement { result, log })
    }

    fn cosigned(
        &self,
        epoch: u32,
        verifier_key: VerifierKey,
        request: AddCheckpoint,
        head: TreeHead,
        known: Option<&WitnessedLog>,
        now: DateTime,
    ) -> Result<WitnessedLog, String> {
        let mut checkpoint = request.checkpoint;
        // Lines of others are not ours to spread.
        checkpoint.keep_signatures_of(verifier_key.name());
        let seconds = u64::try_from(now.unix_micros() / 1_000_000).unwrap_or_default();
        checkpoint.cosign(&self.0, seconds).map_err(|error| format!("{error}."))?;
        let (first_size, first_seen_at) =
            known.map_or((head.size, now), |known| (known.first_size, known.first_seen_at));
        Ok(WitnessedLog {
            epoch,
            verifier_key,
            head,
            checkpoint,
            cosigned_at: now,
            first_size,
            first_seen_at,
            refused: known.and_then(|known| known.refused.clone()),
        })
    }
}

impl WitnessedLog {
    fn refusing(&self, request: &AddCheckpoint, now: DateTime) -> Self {
        Self { refused: Some((request.checkpoint.to_string(), now)), ..self.clone() }
    }
}

/// Reads the key of a log, which names the log.
fn log_key(message: &LedgerCheckpoint) -> Result<VerifierKey, String> {
    let origin = ledger_log_origin(&message.factory_id, &message.recipient_id, message.epoch);
    let key: VerifierKey = message.verifier_key.parse().map_err(|error| format!("{error}."))?;
    if key.name() != origin || key.kind() != KeyKind::Ed25519 {
        return Err(format!("The key is not one of the log {origin}."));
    }
    Ok(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_is_made_once_and_private() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let made = WitnessKey::open(folder.path()).expect("made");
        let again = WitnessKey::open(folder.path()).expect("read");
        assert_eq!(made.verifier(), again.verifier());
        let path = folder.path().join(KEY_FILE);
        let mode = std::fs::metadata(&path).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        std::fs::write(&path, "rubbish").expect("written");
        assert!(matches!(WitnessKey::open(folder.path()), Err(WitnessError::Key { .. })));
    }
}
