//! Removal of rows that the platform has not receipted: over the quota or too old.

use std::{collections::HashSet, time::Duration};

use time::OffsetDateTime;

use crate::{
    gap::{SequenceGap, gaps_of},
    row::{ReportRow, RowId},
};

/// Rows to remove, with the gaps to announce in the same transaction.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Removal {
    pub rows: Vec<RowId>,
    pub gaps: Vec<SequenceGap>,
    /// Size of the removed rows, in bytes.
    pub bytes: u64,
}

impl Removal {
    fn of(rows: &[ReportRow]) -> Self {
        Self {
            rows: rows.iter().map(|row| row.id).collect(),
            gaps: gaps_of(rows),
            bytes: rows.iter().map(|row| row.bytes).sum(),
        }
    }
}

/// Chooses rows of `candidates` (in any order) to remove until at least `bytes_to_free` are free.
///
/// Every row is a key frame, so a newer one supersedes it: the rows in `newest`, the newest of each
/// writer, are never removed. Rows that were never sent are removed before rows that may have
/// arrived, and older ones before newer ones, so that the remaining values are as fresh as
/// possible. Where the candidates do not suffice, all removable ones are chosen; the caller asks
/// again with the next candidates.
#[must_use]
pub fn coalesce(candidates: &[ReportRow], newest: &HashSet<RowId>, bytes_to_free: u64) -> Removal {
    let mut removable: Vec<_> =
        candidates.iter().filter(|row| !newest.contains(&row.id)).copied().collect();
    removable.sort_unstable_by_key(|row| (row.sent_at.is_some(), row.id));
    let mut freed = 0;
    let count = removable
        .iter()
        .take_while(|row| {
            let is_needed = freed < bytes_to_free;
            freed += row.bytes;
            is_needed
        })
        .count();
    Removal::of(&removable[..count])
}

/// Chooses the rows older than `age_max`.
#[must_use]
pub fn expire(rows: &[ReportRow], age_max: Duration, now: OffsetDateTime) -> Removal {
    let expired: Vec<_> =
        rows.iter().filter(|row| now - row.created_at > age_max).copied().collect();
    Removal::of(&expired)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;

    use super::*;
    use crate::row::fixtures::row;

    #[test]
    fn unsent_rows_are_removed_oldest_first_and_the_newest_stay() {
        let mut rows = vec![row(1, 7, 0), row(2, 7, 1), row(3, 8, 0), row(4, 7, 2), row(5, 8, 1)];
        rows[0].sent_at = Some(rows[0].created_at);
        let newest = HashSet::from([RowId(4), RowId(5)]);
        let gap = |data_set_writer_id, sequence| SequenceGap {
            data_set_writer_id,
            epoch: 1,
            first_sequence: sequence,
            last_sequence: sequence,
        };
        assert_eq!(
            coalesce(&rows, &newest, 150),
            Removal {
                rows: vec![RowId(2), RowId(3)],
                gaps: vec![gap(7, 1), gap(8, 0)],
                bytes: 200
            }
        );
        assert_eq!(coalesce(&rows, &newest, 10_000).rows, [RowId(2), RowId(3), RowId(1)]);
        assert_eq!(coalesce(&rows, &newest, 0), Removal::default());
    }

    #[test]
    fn only_rows_older_than_the_age_limit_expire() {
        let mut rows = vec![row(1, 7, 0), row(2, 7, 1)];
        let now = rows[0].created_at + Duration::from_secs(100);
        rows[1].created_at = now;
        assert_eq!(expire(&rows, Duration::from_secs(100), now), Removal::default());
        assert_eq!(expire(&rows, Duration::from_secs(99), now).rows, [RowId(1)]);
    }

    /// Rows of the given writers in order, each with its writer's next sequence number.
    fn rows_of(writers: &[u16]) -> Vec<ReportRow> {
        let mut sequences = [0; 4];
        let ids = 0_i64..;
        ids.zip(writers)
            .map(|(id, writer)| {
                let sequence = &mut sequences[usize::from(*writer)];
                *sequence += 1;
                row(id, *writer, *sequence)
            })
            .collect()
    }

    proptest! {
        #[test]
        fn exactly_the_removed_rows_are_announced(
            writers in proptest::collection::vec(0u16..4, 1..60),
            bytes_to_free in 0u64..8000,
        ) {
            let rows = rows_of(&writers);
            let newest: HashMap<_, _> =
                rows.iter().map(|row| (row.data_set_writer_id, row.id)).collect();
            let newest: HashSet<_> = newest.into_values().collect();

            let removal = coalesce(&rows, &newest, bytes_to_free);

            prop_assert!(removal.rows.iter().all(|id| !newest.contains(id)));
            let is_exhausted = removal.rows.len() + newest.len() == rows.len();
            prop_assert!(removal.bytes >= bytes_to_free || is_exhausted);
            for row in &rows {
                let gaps = removal.gaps.iter().filter(|gap| {
                    gap.data_set_writer_id == row.data_set_writer_id
                        && (gap.first_sequence..=gap.last_sequence).contains(&row.sequence)
                });
                let expected = usize::from(removal.rows.contains(&row.id));
                prop_assert_eq!(gaps.count(), expected, "gaps that cover {:?}", row);
            }
            let announced: u32 =
                removal.gaps.iter().map(|gap| gap.last_sequence - gap.first_sequence + 1).sum();
            prop_assert_eq!(announced as usize, removal.rows.len());
        }
    }
}
