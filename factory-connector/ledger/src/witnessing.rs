//! State of a log at its witness: up to where the platform has countersigned it, and what is needed
//! to prove further checkpoints.

use std::time::Duration;

use asi_model::DateTime;
use serde::{Deserialize, Serialize};
use transparency_log::{Hash, LeafRange, TreeHead, consistency_proof};

/// Time without an answer after which a checkpoint is submitted again. Long, since messages and
/// answers are not lost: one that fails to come is that of a platform which knows no checkpoints.
const PATIENCE: Duration = Duration::from_secs(3600);

/// A checkpoint with the signatures of log and witness.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CosignedCheckpoint {
    /// A C2SP signed note.
    pub note: String,
    /// The key of the witness, as in C2SP signed-note.
    pub witness_key: String,
    /// Time by the clock of the witness, to the second.
    pub cosigned_at: DateTime,
}

/// Finding that the platform holds another history of the log. Nothing is disclosed until an engineer
/// restores the store or begins a new log.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LogConflict {
    pub kind: ConflictKind,
    /// Number of the log that the platform holds, among those that replaced each other.
    pub epoch: u32,
    /// Number of entries in the checkpoint that the platform holds, where it can be read.
    pub held_size: Option<u64>,
    /// The checkpoint that it holds, a C2SP signed note.
    pub checkpoint: Option<String>,
    pub found_at: DateTime,
}

/// Kind of a conflict between a log and its witness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ConflictKind {
    /// The platform holds more entries: the store was set back, or cut.
    RolledBack,
    /// The platform holds other entries: the store was replaced, or set back and continued.
    Replaced,
    /// The platform holds the log under another key.
    OtherKey,
    /// The platform holds a log that replaced this one: the store is older than that.
    Superseded,
    /// The entries that would prove the checkpoint are not in the store any more.
    Unprovable,
}

/// State of a log at its witness.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Witnessing {
    /// Leaves of the last countersigned checkpoint, from 0 on; none before the first.
    witnessed: LeafRange,
    /// Leaves since then of the checkpoint that was submitted last.
    submitted: LeafRange,
    /// Leaves since then.
    since: LeafRange,
    cosigned: Option<CosignedCheckpoint>,
    /// Time of the submission that is not answered yet.
    submitted_at: Option<DateTime>,
    conflict: Option<LogConflict>,
}

impl Witnessing {
    /// Begins for a log of which nothing was countersigned.
    #[must_use]
    pub const fn new(leaves: LeafRange) -> Self {
        Self {
            witnessed: LeafRange::starting_at(0),
            submitted: LeafRange::starting_at(0),
            since: leaves,
            cosigned: None,
            submitted_at: None,
            conflict: None,
        }
    }

    /// Creates the state as it was stored. `since` are the leaves after the witnessed ones; `None`
    /// where they do not follow each other.
    #[must_use]
    pub fn stored(
        witnessed: LeafRange,
        since: LeafRange,
        cosigned: Option<CosignedCheckpoint>,
        conflict: Option<LogConflict>,
    ) -> Option<Self> {
        let size = witnessed.end();
        let follows = witnessed.begin() == 0 && since.begin() == size;
        let submitted = LeafRange::starting_at(size);
        follows.then_some(Self {
            witnessed,
            submitted,
            since,
            cosigned,
            submitted_at: None,
            conflict,
        })
    }

    /// Returns the leaves of the last countersigned checkpoint; none before the first, and none where
    /// the platform has forgotten it.
    #[must_use]
    pub const fn witnessed(&self) -> &LeafRange {
        &self.witnessed
    }

    /// Returns the last countersigned checkpoint.
    #[must_use]
    pub const fn cosigned(&self) -> Option<&CosignedCheckpoint> {
        self.cosigned.as_ref()
    }

    /// Returns the conflict that has not been settled.
    #[must_use]
    pub const fn conflict(&self) -> Option<&LogConflict> {
        self.conflict.as_ref()
    }

    /// Returns whether a checkpoint is to be submitted: the log grew since the last one, which was
    /// answered or is overdue. One at a time, so that an answer is always about the last one.
    #[must_use]
    pub fn is_due(&self, now: DateTime) -> bool {
        match self.submitted_at {
            Some(at) => now.since(at) >= PATIENCE,
            None => self.conflict.is_none() && self.since.end() > self.witnessed.end(),
        }
    }

    /// Returns whether a platform that has countersigned before has yet to answer a submission.
    #[must_use]
    pub const fn is_awaited(&self) -> bool {
        self.submitted_at.is_some() && self.cosigned.is_some()
    }

    pub(crate) fn append(&mut self, leaf: Hash) {
        self.since.append(leaf);
    }

    /// Begins the submission of all leaves. Returns the size at which the proof begins, and the
    /// proof.
    pub(crate) fn submit(&mut self, now: DateTime) -> (u64, Vec<Hash>) {
        let next = LeafRange::starting_at(self.since.end());
        let since = std::mem::replace(&mut self.since, next);
        assert!(self.submitted.join(&since), "the ranges follow each other");
        self.submitted_at = Some(now);
        let proof = consistency_proof(&self.witnessed, &self.submitted);
        (self.witnessed.end(), proof.expect("the ranges follow each other"))
    }

    /// Computes the root at the size that was countersigned or submitted last; `None` at others.
    pub(crate) fn root_at(&self, size: u64) -> Option<Hash> {
        if size == self.submitted.end() {
            let mut whole = self.witnessed.clone();
            return (size > 0 && whole.join(&self.submitted)).then(|| whole.root());
        }
        (size > 0 && size == self.witnessed.end()).then(|| self.witnessed.root())
    }

    /// Takes a countersigned checkpoint, whose size has a [root](Self::root_at).
    pub(crate) fn accept(&mut self, size: u64, cosigned: CosignedCheckpoint) {
        if size == self.submitted.end() {
            let next = LeafRange::starting_at(size);
            let submitted = std::mem::replace(&mut self.submitted, next);
            assert!(self.witnessed.join(&submitted), "the ranges follow each other");
            self.submitted_at = None;
        }
        self.cosigned = Some(cosigned);
    }

    /// Takes a countersigned checkpoint of any size, with the leaves before and after it.
    pub(crate) fn restart(
        &mut self,
        witnessed: LeafRange,
        since: LeafRange,
        cosigned: CosignedCheckpoint,
    ) {
        self.submitted = LeafRange::starting_at(witnessed.end());
        (self.witnessed, self.since) = (witnessed, since);
        (self.cosigned, self.submitted_at) = (Some(cosigned), None);
    }

    /// Begins again with a platform that holds nothing; the last countersigned checkpoint stays as
    /// evidence. Returns its size, 0 where there is none.
    pub(crate) fn forget(&mut self, leaves: &LeafRange) -> u64 {
        let former = self.witnessed.end();
        let (cosigned, conflict) = (self.cosigned.take(), self.conflict.take());
        *self = Self { cosigned, conflict, ..Self::new(leaves.clone()) };
        former
    }

    /// Notes a conflict; the first one stays.
    pub(crate) fn find_conflict(&mut self, conflict: LogConflict) {
        self.submitted_at = None;
        self.conflict.get_or_insert(conflict);
    }
}

/// Returns size and root of a whole log.
pub(crate) fn head_of(leaves: &LeafRange) -> TreeHead {
    TreeHead { size: leaves.end(), root: leaves.root() }
}
