//! Proofs: that an entry is in a log, and that a log was only extended.

use super::{Hash, LeafRange, empty_root, node_hash};

/// Fault of a proof.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ProofError {
    /// The entry, or the older log, lies beyond the newer log.
    #[error("the proof speaks of more entries than the log has")]
    BeyondLog,
    /// The proof has too few or too many hashes.
    #[error("the proof has not the number of hashes that its sizes ask for")]
    WrongLength,
    /// The proof leads to another root.
    #[error("the proof leads to another root")]
    OtherRoot,
}

/// Makes the proof of RFC 6962, section 2.1.1, that a leaf is in a log: the siblings on its way to
/// the root, from the leaf on. `before` are the leaves before it, from 0 on; `after` are those after
/// it. `None` where the two ranges do not leave out exactly one leaf.
#[must_use]
pub fn inclusion_proof(before: &LeafRange, after: &LeafRange) -> Option<Vec<Hash>> {
    let leaf = before.end();
    if before.begin() != 0 || leaf.checked_add(1) != Some(after.begin()) {
        return None;
    }
    let (mut from, mut to) = (0, after.end());
    let mut proof = Vec::new();
    while to - from > 1 {
        let middle = from + split(to - from);
        if leaf < middle {
            proof.push(after.fold(middle, to)?);
            to = middle;
        } else {
            proof.push(before.fold(from, middle)?);
            from = middle;
        }
    }
    proof.reverse();
    Some(proof)
}

/// Makes the proof of RFC 6962, section 2.1.2, that a log was only extended. `older` is the whole
/// older log, `added` are the leaves since. Without older or new leaves the proof is empty. `None`
/// where the ranges do not follow each other.
#[must_use]
pub fn consistency_proof(older: &LeafRange, added: &LeafRange) -> Option<Vec<Hash>> {
    let size = older.end();
    if older.begin() != 0 || added.begin() != size {
        return None;
    }
    let (mut from, mut to) = (0, added.end());
    let mut proof = Vec::new();
    if size == 0 || size == to {
        return Some(proof);
    }
    while size != to {
        let middle = from + split(to - from);
        if size <= middle {
            proof.push(added.fold(middle, to)?);
            to = middle;
        } else {
            proof.push(older.fold(from, middle)?);
            from = middle;
        }
    }
    // A verifier has the older root already where it is the last subtree itself.
    if from != 0 {
        proof.push(older.fold(from, to)?);
    }
    proof.reverse();
    Some(proof)
}

/// Verifies, after RFC 9162, section 2.1.3.2, that a leaf has this number (from 0) in the log with
/// this size and root. Size and root come from one signed checkpoint, since a root alone belongs to
/// several sizes.
///
/// # Errors
/// [`ProofError`].
pub fn verify_inclusion(
    leaf: &Hash,
    index: u64,
    size: u64,
    root: &Hash,
    proof: &[Hash],
) -> Result<(), ProofError> {
    if index >= size {
        return Err(ProofError::BeyondLog);
    }
    let mut path = Path { index, last: size - 1 };
    let mut found = *leaf;
    for sibling in proof {
        found = match path.step().ok_or(ProofError::WrongLength)? {
            Side::Left => node_hash(sibling, &found),
            Side::Right => node_hash(&found, sibling),
        };
    }
    path.end(found == *root)
}

/// Verifies, after RFC 9162, section 2.1.4.2, that the log with the second size and root begins with
/// the whole log of the first size and root.
///
/// # Errors
/// [`ProofError`].
pub fn verify_consistency(
    (older_size, older_root): (u64, &Hash),
    (size, root): (u64, &Hash),
    proof: &[Hash],
) -> Result<(), ProofError> {
    if older_size > size {
        return Err(ProofError::BeyondLog);
    }
    if older_size == size || older_size == 0 {
        let is_same =
            if older_size == 0 { *older_root == empty_root() } else { older_root == root };
        let is_empty = size > 0 || *root == empty_root();
        return match (proof.is_empty(), is_same && is_empty) {
            (false, _) => Err(ProofError::WrongLength),
            (true, false) => Err(ProofError::OtherRoot),
            (true, true) => Ok(()),
        };
    }
    // The older root is the first hash where the older log is one perfect subtree; provers leave it
    // out.
    let (first, rest) = if older_size.is_power_of_two() {
        (older_root, proof)
    } else {
        proof.split_first().ok_or(ProofError::WrongLength)?
    };
    if rest.is_empty() {
        return Err(ProofError::WrongLength);
    }
    let mut path = Path { index: older_size - 1, last: size - 1 };
    path.skip_completed();
    let (mut older_found, mut found) = (*first, *first);
    for sibling in rest {
        match path.step().ok_or(ProofError::WrongLength)? {
            Side::Left => {
                older_found = node_hash(sibling, &older_found);
                found = node_hash(sibling, &found);
            }
            Side::Right => found = node_hash(&found, sibling),
        }
    }
    path.end(older_found == *older_root && found == *root)
}

/// Side on which a sibling stands.
enum Side {
    Left,
    Right,
}

/// Way from a node to the root: `fn` and `sn` of RFC 9162.
struct Path {
    /// Number of the node on its level.
    index: u64,
    /// Number of the last node on this level.
    last: u64,
}

impl Path {
    /// Goes up to the largest subtree whose last leaf is this one.
    const fn skip_completed(&mut self) {
        while self.index & 1 == 1 {
            self.up();
        }
    }

    /// Goes up by one sibling; `None` at the root.
    fn step(&mut self) -> Option<Side> {
        if self.last == 0 {
            return None;
        }
        let side = if self.index & 1 == 1 || self.index == self.last {
            // The last node of a level has no right sibling: it moves up unhashed to where it is a
            // right child.
            while self.index & 1 == 0 && self.index != 0 {
                self.up();
            }
            Side::Left
        } else {
            Side::Right
        };
        self.up();
        Some(side)
    }

    const fn up(&mut self) {
        self.index >>= 1;
        self.last >>= 1;
    }

    const fn end(&self, is_same: bool) -> Result<(), ProofError> {
        match (self.last == 0, is_same) {
            (false, _) => Err(ProofError::WrongLength),
            (true, false) => Err(ProofError::OtherRoot),
            (true, true) => Ok(()),
        }
    }
}

/// Returns the number of leaves in the left part of a tree with more than one leaf: the largest
/// power of two below it.
const fn split(size: u64) -> u64 {
    1 << (size - 1).ilog2()
}
