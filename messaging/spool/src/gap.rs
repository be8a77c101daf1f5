//! Gaps: ranges of sequence numbers that will never arrive.

use crate::row::ReportRow;

/// Sequence numbers of one writer and epoch that will never arrive. Committed as a `gap` message in
/// the transaction that removes the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SequenceGap {
    pub data_set_writer_id: u16,
    pub epoch: u32,
    /// First missing sequence number.
    pub first_sequence: u32,
    /// Last missing sequence number, inclusive.
    pub last_sequence: u32,
}

impl SequenceGap {
    /// Returns true where the report is missing in it.
    #[must_use]
    pub fn has(&self, row: &ReportRow) -> bool {
        (row.data_set_writer_id, row.epoch) == (self.data_set_writer_id, self.epoch)
            && (self.first_sequence..=self.last_sequence).contains(&row.sequence)
    }
}

/// Joins the rows' sequence numbers into as few gaps as possible, ordered by writer, epoch and
/// sequence.
#[must_use]
pub fn gaps_of(rows: &[ReportRow]) -> Vec<SequenceGap> {
    join(rows.iter().map(|row| (row.data_set_writer_id, row.epoch, row.sequence)).collect())
}

/// Joins sequence numbers, each with its writer and epoch, given in any order.
#[must_use]
pub fn join(mut sequences: Vec<(u16, u32, u32)>) -> Vec<SequenceGap> {
    sequences.sort_unstable();
    sequences.dedup();
    let mut gaps: Vec<SequenceGap> = Vec::new();
    for (data_set_writer_id, epoch, sequence) in sequences {
        match gaps.last_mut() {
            Some(gap)
                if gap.data_set_writer_id == data_set_writer_id
                    && gap.epoch == epoch
                    && gap.last_sequence.checked_add(1) == Some(sequence) =>
            {
                gap.last_sequence = sequence;
            }
            _ => gaps.push(SequenceGap {
                data_set_writer_id,
                epoch,
                first_sequence: sequence,
                last_sequence: sequence,
            }),
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::fixtures::row;

    fn gap(data_set_writer_id: u16, first_sequence: u32, last_sequence: u32) -> SequenceGap {
        SequenceGap { data_set_writer_id, epoch: 1, first_sequence, last_sequence }
    }

    #[test]
    fn adjacent_sequence_numbers_join_into_one_gap() {
        let rows = [row(1, 7, 3), row(2, 7, 4), row(3, 8, 5), row(4, 7, 6), row(5, 7, 4)];
        assert_eq!(gaps_of(&rows), [gap(7, 3, 4), gap(7, 6, 6), gap(8, 5, 5)]);
    }
}
