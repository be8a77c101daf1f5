//! Neighbouring leaves as few hashes: what is kept of a log to extend and to prove it.

use super::{Hash, empty_root, node_hash};

/// The leaves `begin..end` of a log, as the hashes of the largest perfect subtrees that lie in this
/// range, from left to right. A range that begins at 0 is a whole log: one subtree per set bit of
/// its size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeafRange {
    begin: u64,
    end: u64,
    hashes: Vec<Hash>,
}

impl LeafRange {
    /// Creates a range without leaves, to which those from number `begin` (counted from 0) are
    /// appended.
    #[must_use]
    pub const fn starting_at(begin: u64) -> Self {
        Self { begin, end: begin, hashes: Vec::new() }
    }

    /// Creates a range from its stored hashes; `None` where their number is not that of the range.
    #[must_use]
    pub fn from_hashes(begin: u64, end: u64, hashes: Vec<Hash>) -> Option<Self> {
        let is_complete = begin <= end && levels(begin, end).count() == hashes.len();
        is_complete.then_some(Self { begin, end, hashes })
    }

    /// Creates a range from its hashes one after another, 32 bytes each; `None` where their number
    /// is not that of the range.
    #[must_use]
    pub fn from_bytes(begin: u64, end: u64, bytes: &[u8]) -> Option<Self> {
        let (hashes, rest) = bytes.as_chunks::<32>();
        if rest.is_empty() { Self::from_hashes(begin, end, hashes.to_vec()) } else { None }
    }

    /// Returns the number of the first leaf.
    #[must_use]
    pub const fn begin(&self) -> u64 {
        self.begin
    }

    /// Returns the number after the last leaf; of a whole log its size.
    #[must_use]
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// Returns the hashes of the subtrees, from left to right.
    #[must_use]
    pub fn hashes(&self) -> &[Hash] {
        &self.hashes
    }

    /// Returns the hashes one after another, 32 bytes each, as [`from_bytes`](Self::from_bytes)
    /// reads them.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        self.hashes.concat()
    }

    /// Appends a leaf. On average one subtree is completed by a leaf.
    ///
    /// # Panics
    /// After 2^64 - 1 leaves, which no log reaches.
    pub fn append(&mut self, leaf: Hash) {
        self.push(0, leaf);
    }

    /// Appends the leaves of a range that begins where this one ends; `false` where it does not,
    /// and then nothing changes.
    #[must_use]
    pub fn join(&mut self, next: &Self) -> bool {
        if next.begin != self.end {
            return false;
        }
        for ((_, level), hash) in levels(next.begin, next.end).zip(&next.hashes) {
            self.push(level, *hash);
        }
        true
    }

    /// Computes the root of a whole log, which is a range that begins at 0.
    #[must_use]
    pub fn root(&self) -> Hash {
        self.fold(0, self.end).unwrap_or_else(empty_root)
    }

    /// Computes the root of the subtree over the leaves `from..to` of this range; `None` without
    /// leaves, or where a subtree of this range lies across one of these limits.
    pub(super) fn fold(&self, from: u64, to: u64) -> Option<Hash> {
        let mut next = to;
        let mut root = None;
        let nodes: Vec<_> = levels(self.begin, self.end).zip(&self.hashes).collect();
        for ((start, level), hash) in nodes.into_iter().rev() {
            if start + (1 << level) == next && start >= from {
                root = Some(root.map_or(*hash, |right| node_hash(hash, &right)));
                next = start;
            }
        }
        root.filter(|_| next == from)
    }

    /// Appends a perfect subtree with 2^`level` leaves, and joins what it completes.
    fn push(&mut self, mut level: u32, mut hash: Hash) {
        let mut index = self.end >> level;
        self.end = self.end.checked_add(1 << level).expect("no log has 2^64 leaves");
        // An odd subtree has its left neighbour before it, unless the range begins between them.
        while index & 1 == 1 && (index - 1) << level >= self.begin {
            let left = self.hashes.pop().expect("the left neighbour lies in the range");
            hash = node_hash(&left, &hash);
            index >>= 1;
            level += 1;
        }
        self.hashes.push(hash);
    }
}

/// Returns the largest perfect subtrees in a range: first leaf and level of each, from left to
/// right.
fn levels(begin: u64, end: u64) -> impl Iterator<Item = (u64, u32)> {
    let mut next = begin;
    std::iter::from_fn(move || {
        let rest = end.checked_sub(next).filter(|rest| *rest > 0)?;
        let level = next.trailing_zeros().min(rest.ilog2());
        let start = next;
        next += 1 << level;
        Some((start, level))
    })
}
