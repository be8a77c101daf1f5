//! Commitment to reports of the past that are shown to one more recipient.

use transparency_log::{LeafRange, leaf_hash};

use crate::Hash;

/// Computes the root over the roots of reports' values (see [`values_root`](crate::values_root)),
/// in the order of the reports: the root of a Merkle tree of RFC 6962 with one leaf per report.
/// An auditor can be proven one report without the others.
#[must_use]
pub fn past_root(values: impl IntoIterator<Item = Hash>) -> Hash {
    let mut leaves = LeafRange::starting_at(0);
    for root in values {
        leaves.append(leaf_hash(&root));
    }
    leaves.root()
}

#[cfg(test)]
mod tests {
    use sha2::{Digest as _, Sha256};

    use super::*;

    #[test]
    fn the_root_is_that_of_a_tree_with_a_leaf_per_report() {
        let leaf = |root: Hash| -> Hash {
            Sha256::new().chain_update([0]).chain_update(root).finalize().into()
        };
        let node = |left: Hash, right: Hash| -> Hash {
            Sha256::new().chain_update([1]).chain_update(left).chain_update(right).finalize().into()
        };
        let [a, b, c] = [[1; 32], [2; 32], [3; 32]];
        assert_eq!(past_root([a]), leaf(a));
        assert_eq!(past_root([a, b, c]), node(node(leaf(a), leaf(b)), leaf(c)));
        assert_ne!(past_root([a, b]), past_root([b, a]));
    }
}
