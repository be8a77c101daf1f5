//! At its quota the spool keeps only newer values: every row is a key frame, so a newer one
//! supersedes it.

use std::collections::HashSet;

use super::{Removal, ReportRow, RowId};

/// Chooses rows to remove until at least `bytes_to_free` are free, of `candidates` (any order).
///
/// The newest row of a writer never goes: `newest` lists those. Rows that were never sent go before
/// rows that may have arrived, and older ones before newer ones, so that what remains is as fresh
/// as it can be. When the candidates do not suffice, all that may go goes; ask again with the next
/// ones.
#[must_use]
pub fn coalesce(candidates: &[ReportRow], newest: &HashSet<RowId>, bytes_to_free: u64) -> Removal {
    let mut may_go: Vec<_> =
        candidates.iter().filter(|r| !newest.contains(&r.id)).copied().collect();
    may_go.sort_unstable_by_key(|row| (row.sent_at.is_some(), row.id));
    let mut freed = 0;
    let count = may_go
        .iter()
        .take_while(|row| {
            let is_needed = freed < bytes_to_free;
            freed += row.bytes;
            is_needed
        })
        .count();
    Removal::of(&may_go[..count])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::spool::{SequenceGap, tests::row};

    #[test]
    fn old_unsent_rows_go_first_and_the_newest_stays() {
        let mut rows = vec![row(1, 7, 0), row(2, 7, 1), row(3, 8, 0), row(4, 7, 2), row(5, 8, 1)];
        rows[0].sent_at = Some(rows[0].created_at);
        let newest = HashSet::from([RowId(4), RowId(5)]);
        let removal = coalesce(&rows, &newest, 150);
        assert_eq!(removal.rows, [RowId(2), RowId(3)]);
        assert_eq!(removal.bytes, 200);
        assert_eq!(
            removal.gaps,
            [
                SequenceGap {
                    data_set_writer_id: 7,
                    epoch: 1,
                    first_sequence: 1,
                    last_sequence: 1
                },
                SequenceGap {
                    data_set_writer_id: 8,
                    epoch: 1,
                    first_sequence: 0,
                    last_sequence: 0
                },
            ]
        );
        assert_eq!(coalesce(&rows, &newest, 10_000).rows, [RowId(2), RowId(3), RowId(1)]);
        assert_eq!(coalesce(&rows, &newest, 0), Removal::default());
    }

    proptest! {
        #[test]
        fn every_removed_row_is_announced_and_no_other(
            writers in proptest::collection::vec(0u16..4, 1..60),
            to_free in 0u64..8000,
        ) {
            let mut sequences = [0u32; 4];
            let rows: Vec<_> = writers.iter().enumerate().map(|(i, w)| {
                let sequence = &mut sequences[usize::from(*w)];
                *sequence += 1;
                row(i64::try_from(i).expect("small"), *w, *sequence)
            }).collect();
            let mut newest = std::collections::HashMap::new();
            for r in &rows { newest.insert(r.data_set_writer_id, r.id); }
            let newest: HashSet<_> = newest.into_values().collect();
            let removal = coalesce(&rows, &newest, to_free);
            prop_assert!(removal.rows.iter().all(|id| !newest.contains(id)));
            prop_assert!(removal.bytes >= to_free || removal.rows.len() + newest.len() == rows.len());
            let announced: u64 = removal.gaps.iter().map(|g| u64::from(g.last_sequence - g.first_sequence) + 1).sum();
            prop_assert_eq!(announced, removal.rows.len() as u64);
            for r in &rows {
                let is_announced = removal.gaps.iter().any(|g| g.data_set_writer_id == r.data_set_writer_id
                    && (g.first_sequence..=g.last_sequence).contains(&r.sequence));
                prop_assert_eq!(is_announced, removal.rows.contains(&r.id));
            }
        }
    }
}
