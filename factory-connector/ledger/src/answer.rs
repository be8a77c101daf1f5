//! Answers of the platform to checkpoints of a log.

use asi_model::{
    DateTime,
    messages::{LedgerCheckpointResult, LedgerCosignature},
};
use transparency_log::{Checkpoint, KeyKind, LeafRange, SignedNote, TreeHead, VerifierKey};

use super::{ConflictKind, CosignedCheckpoint, LedgerKey, Log, LogConflict, witnessing::head_of};

/// Answer that proves nothing: it is logged and has no effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum InvalidAnswer {
    #[error("the key of the witness cannot be read")]
    WitnessKey,
    #[error("the checkpoint cannot be read")]
    Checkpoint,
    #[error("the checkpoint is not signed by this log and countersigned by the witness")]
    Signature,
}

/// A checkpoint of the log that the platform holds, with verified signatures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeldCheckpoint {
    head: TreeHead,
    cosigned: CosignedCheckpoint,
}

/// Effect of an answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answered {
    /// The checkpoint is countersigned.
    Cosigned {
        /// The witness has another key than before.
        is_other_witness: bool,
    },
    /// The platform holds a checkpoint of another size: the entries have to be read up to there for
    /// [`Log::compare`].
    OtherSize(HeldCheckpoint),
    /// The platform holds nothing of the log any more, of which it had countersigned `former_size`
    /// leaves; the next checkpoint is its first again.
    Forgotten { former_size: u64 },
    /// The platform holds another history.
    Conflict,
    /// The answer is about what has passed.
    Outdated,
}

impl HeldCheckpoint {
    /// Returns the number of leaves.
    #[must_use]
    pub const fn size(&self) -> u64 {
        self.head.size
    }

    fn read(note: &str, log_key: &VerifierKey, witness_key: &str) -> Result<Self, InvalidAnswer> {
        let witness: VerifierKey = witness_key.parse().map_err(|_| InvalidAnswer::WitnessKey)?;
        if witness.kind() != KeyKind::CosignatureV1 {
            return Err(InvalidAnswer::WitnessKey);
        }
        let parsed = SignedNote::parse(note).map_err(|_| InvalidAnswer::Checkpoint)?;
        let checkpoint: Checkpoint =
            parsed.text().parse().map_err(|_| InvalidAnswer::Checkpoint)?;
        parsed.verify([log_key]).map_err(|_| InvalidAnswer::Signature)?;
        let cosigned_at = parsed.verify([&witness]).ok();
        let cosigned_at = cosigned_at.and_then(|found| found.first()?.cosigned_at);
        let seconds = cosigned_at.and_then(|at| i64::try_from(at).ok());
        let micros = seconds.and_then(|seconds| seconds.checked_mul(1_000_000));
        if checkpoint.origin != log_key.name() {
            return Err(InvalidAnswer::Checkpoint);
        }
        Ok(Self {
            head: TreeHead { size: checkpoint.size, root: checkpoint.root },
            cosigned: CosignedCheckpoint {
                note: note.to_owned(),
                witness_key: witness_key.to_owned(),
                cosigned_at: DateTime::from_unix_micros(micros.ok_or(InvalidAnswer::Signature)?),
            },
        })
    }
}

impl Log {
    /// Takes the platform's answer to a checkpoint. A conflict needs no more trust in the platform
    /// than it has: it shows a checkpoint that this log signed itself, but for the two kinds in which
    /// another key signed.
    ///
    /// # Errors
    /// [`InvalidAnswer`]; then nothing changes.
    pub fn receive(
        &mut self,
        answer: &LedgerCosignature,
        key: &LedgerKey,
        now: DateTime,
    ) -> Result<Answered, InvalidAnswer> {
        if answer.epoch < self.start().epoch {
            return Ok(Answered::Outdated);
        }
        let claimed = |kind| LogConflict {
            kind,
            epoch: answer.epoch,
            held_size: None,
            checkpoint: answer.checkpoint.clone(),
            found_at: now,
        };
        if answer.epoch > self.start().epoch {
            return Ok(self.conflict(claimed(ConflictKind::Superseded)));
        }
        if answer.result == LedgerCheckpointResult::OtherKey {
            return Ok(self.conflict(claimed(ConflictKind::OtherKey)));
        }
        let Some(note) = &answer.checkpoint else {
            let leaves = self.leaves().clone();
            return Ok(match self.witnessing_mut().forget(&leaves) {
                0 => Answered::Outdated,
                former_size => Answered::Forgotten { former_size },
            });
        };
        let verifier =
            self.start().verifier(&key.public()).map_err(|_| InvalidAnswer::Signature)?;
        let held = HeldCheckpoint::read(note, &verifier, &answer.witness_key)?;
        let found = |kind| LogConflict { held_size: Some(held.size()), ..claimed(kind) };
        if held.size() > self.leaves().end() {
            return Ok(self.conflict(found(ConflictKind::RolledBack)));
        }
        if answer.result == LedgerCheckpointResult::Inconsistent {
            return Ok(self.conflict(found(ConflictKind::Replaced)));
        }
        Ok(match self.witnessing().root_at(held.size()) {
            None => Answered::OtherSize(held),
            Some(root) if root != held.head.root => self.conflict(found(ConflictKind::Replaced)),
            Some(_) => {
                let is_other_witness = self.is_other_witness(&held);
                self.witnessing_mut().accept(held.size(), held.cosigned);
                Answered::Cosigned { is_other_witness }
            }
        })
    }

    /// Compares a checkpoint that the platform holds with the leaves before it and those since, as
    /// they were computed from the stored entries; `None` where these are removed.
    pub fn compare(
        &mut self,
        held: HeldCheckpoint,
        leaves: Option<(LeafRange, LeafRange)>,
        now: DateTime,
    ) -> Answered {
        let found = |kind| LogConflict {
            kind,
            epoch: self.start().epoch,
            held_size: Some(held.size()),
            checkpoint: Some(held.cosigned.note.clone()),
            found_at: now,
        };
        let whole = leaves.as_ref().and_then(|(older, since)| {
            let mut whole = older.clone();
            whole.join(since).then_some(whole)
        });
        let kind = match &leaves {
            Some((older, _)) if head_of(older) != held.head => Some(ConflictKind::Replaced),
            Some(_) if whole.as_ref() == Some(self.leaves()) => None,
            _ => Some(ConflictKind::Unprovable),
        };
        if let Some(kind) = kind {
            let conflict = found(kind);
            return self.conflict(conflict);
        }
        let is_other_witness = self.is_other_witness(&held);
        if let Some((older, since)) = leaves {
            self.witnessing_mut().restart(older, since, held.cosigned);
        }
        Answered::Cosigned { is_other_witness }
    }

    fn conflict(&mut self, conflict: LogConflict) -> Answered {
        self.witnessing_mut().find_conflict(conflict);
        Answered::Conflict
    }

    fn is_other_witness(&self, held: &HeldCheckpoint) -> bool {
        let known = self.witnessing().cosigned();
        known.is_some_and(|known| known.witness_key != held.cosigned.witness_key)
    }
}

#[cfg(test)]
mod tests;
