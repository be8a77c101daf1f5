//! Merging of rows by key.

use std::collections::BTreeMap;

/// Moves the later rows into the earlier ones; a later row replaces an earlier one with its key.
pub(super) fn extend<K: Ord, V>(earlier: &mut BTreeMap<K, V>, later: BTreeMap<K, V>) {
    if earlier.is_empty() {
        *earlier = later;
    } else {
        earlier.extend(later);
    }
}
