//! What the platform's receipts mean for the rows of one writer: the promise of no loss rests on
//! these decisions.

use std::{
    collections::{HashMap, HashSet},
    time::Duration,
};

use asi_model::messages::WriterReceipt;
use time::OffsetDateTime;

use super::{ReportRow, RowId, SequenceGap};

/// What a receipt does to the rows of its writer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReceiptEffect {
    /// The platform holds them: they may go.
    pub held: Vec<RowId>,
    /// Sent, yet missing at the platform: they wait again.
    pub resend: Vec<RowId>,
    /// Missing at the platform and no longer in the spool: announce them, or the platform asks for
    /// ever.
    pub lost: Vec<SequenceGap>,
}

/// Applies a receipt to `rows`, which must be *all* rows in the spool of that writer and epoch.
///
/// A row counts as missing only when it was sent before `sent_before` (usually some seconds ago): a
/// younger one may still be on its way. Rows that were never sent are never held: a receipt that
/// claims them is about another life of the same writer, and the row is sent.
#[must_use]
pub fn apply_receipt(
    receipt: &WriterReceipt,
    rows: &[ReportRow],
    sent_before: OffsetDateTime,
) -> ReceiptEffect {
    let missing: HashSet<u32> = receipt.missing_list.iter().copied().collect();
    let mut effect = ReceiptEffect::default();
    let mut present = HashSet::with_capacity(rows.len());
    for row in rows {
        if row.data_set_writer_id != receipt.data_set_writer_id || row.epoch != receipt.epoch {
            continue;
        }
        present.insert(row.sequence);
        let Some(sent_at) = row.sent_at else { continue };
        if missing.contains(&row.sequence) {
            if sent_at < sent_before {
                effect.resend.push(row.id);
            }
        } else if row.sequence <= receipt.through_sequence {
            effect.held.push(row.id);
        }
    }
    effect.lost = lost_of(receipt, &present);
    effect
}

fn lost_of(receipt: &WriterReceipt, present: &HashSet<u32>) -> Vec<SequenceGap> {
    let mut sequences: Vec<_> =
        receipt.missing_list.iter().copied().filter(|s| !present.contains(s)).collect();
    sequences.sort_unstable();
    sequences.dedup();
    let mut gaps: Vec<SequenceGap> = Vec::new();
    for sequence in sequences {
        match gaps.last_mut() {
            Some(gap) if gap.last_sequence.checked_add(1) == Some(sequence) => {
                gap.last_sequence = sequence
            }
            _ => gaps.push(SequenceGap {
                data_set_writer_id: receipt.data_set_writer_id,
                epoch: receipt.epoch,
                first_sequence: sequence,
                last_sequence: sequence,
            }),
        }
    }
    gaps
}

/// How long to wait for a receipt before a row is sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverduePolicy {
    /// After the first sending; doubles with each further one.
    pub patience: Duration,
    /// The longest wait.
    pub patience_max: Duration,
}

impl Default for OverduePolicy {
    fn default() -> Self {
        Self { patience: Duration::from_secs(60), patience_max: Duration::from_secs(3600) }
    }
}

impl OverduePolicy {
    fn patience_after(&self, sent_count: u32) -> Duration {
        let doublings = sent_count.saturating_sub(1).min(16);
        self.patience.saturating_mul(1 << doublings).min(self.patience_max)
    }
}

/// Chooses the rows that were sent so long ago without a receipt that a broker must be taken to
/// have lost them. To be asked only while the link is up. A row sent at a time yet to come was sent
/// by a clock that has been set back since: nobody knows how long ago, so it counts as long ago.
///
/// While no receipts arrive (`hears_receipts`), only the newest of each writer's rows is chosen: it
/// asks the platform, which answers with a receipt that names what it lacks. A platform that is
/// away finds one row more, not the backlog twice.
#[must_use]
pub fn overdue(
    rows: &[ReportRow],
    policy: &OverduePolicy,
    now: OffsetDateTime,
    hears_receipts: bool,
) -> Vec<RowId> {
    let is_late = |row: &&ReportRow| {
        row.sent_at.is_some_and(|at| at > now || now - at > policy.patience_after(row.sent_count))
    };
    let late = rows.iter().filter(is_late);
    if hears_receipts {
        return late.map(|row| row.id).collect();
    }
    let mut newest: HashMap<u16, RowId> = HashMap::new();
    for row in late {
        let known = newest.entry(row.data_set_writer_id).or_insert(row.id);
        *known = row.id.max(*known);
    }
    let mut newest: Vec<_> = newest.into_values().collect();
    newest.sort_unstable();
    newest
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::spool::tests::{moment, row};

    fn receipt(through: u32, missing: &[u32]) -> WriterReceipt {
        WriterReceipt {
            data_set_writer_id: 7,
            epoch: 1,
            through_sequence: through,
            missing_list: missing.to_vec(),
        }
    }

    fn sent(id: i64, sequence: u32) -> ReportRow {
        ReportRow { sent_at: Some(moment()), sent_count: 1, ..row(id, 7, sequence) }
    }

    #[test]
    fn held_rows_go_and_missing_ones_are_sent_again() {
        let rows = [sent(1, 0), sent(2, 1), sent(3, 2), sent(4, 3), row(5, 7, 4)];
        let later = moment() + Duration::from_secs(5);
        let effect = apply_receipt(&receipt(2, &[1]), &rows, later);
        assert_eq!(effect.held, [RowId(1), RowId(3)]);
        assert_eq!(effect.resend, [RowId(2)]);
        assert!(effect.lost.is_empty());
    }

    #[test]
    fn what_was_just_sent_again_is_given_time() {
        let effect = apply_receipt(&receipt(2, &[1]), &[sent(2, 1)], moment());
        assert_eq!(effect, ReceiptEffect::default());
    }

    #[test]
    fn rows_of_another_epoch_or_never_sent_stay() {
        let mut other = sent(1, 0);
        other.epoch = 2;
        let effect = apply_receipt(&receipt(9, &[]), &[other, row(2, 7, 1)], moment());
        assert_eq!(effect, ReceiptEffect::default());
    }

    #[test]
    fn what_is_missing_and_gone_is_announced() {
        let effect = apply_receipt(&receipt(9, &[3, 4, 7, 8]), &[sent(1, 8)], moment());
        let runs: Vec<_> =
            effect.lost.iter().map(|g| (g.first_sequence, g.last_sequence)).collect();
        assert_eq!(runs, [(3, 4), (7, 7)]);
    }

    #[test]
    fn patience_doubles_up_to_its_cap() {
        let policy = OverduePolicy {
            patience: Duration::from_secs(10),
            patience_max: Duration::from_secs(35),
        };
        for (count, seconds, expected) in [
            (1, 10, false),
            (1, 11, true),
            (2, 20, false),
            (2, 21, true),
            (3, 36, true),
            (40, 35, false),
        ] {
            let rows = [ReportRow { sent_count: count, ..sent(1, 0) }];
            let is_overdue =
                !overdue(&rows, &policy, moment() + Duration::from_secs(seconds), true).is_empty();
            assert_eq!(is_overdue, expected, "sent {count} times, {seconds} s ago");
        }
        assert!(
            overdue(&[row(1, 7, 0)], &policy, moment() + Duration::from_secs(9999), true)
                .is_empty()
        );
    }

    #[test]
    fn a_row_sent_at_a_time_yet_to_come_is_overdue() {
        let before = moment() - Duration::from_secs(300);
        assert_eq!(overdue(&[sent(1, 0)], &OverduePolicy::default(), before, true), [RowId(1)]);
    }

    #[test]
    fn while_no_receipts_arrive_one_row_of_each_writer_asks() {
        let other = ReportRow { data_set_writer_id: 8, ..sent(3, 0) };
        let rows = [sent(1, 0), sent(2, 1), other, row(4, 7, 2)];
        let later = moment() + Duration::from_secs(61);
        assert_eq!(overdue(&rows, &OverduePolicy::default(), later, false), [RowId(2), RowId(3)]);
    }

    proptest! {
        /// Whatever is lost on the way, repeating send and receipt ends with everything held.
        #[test]
        fn sending_until_receipted_loses_nothing(
            losses in proptest::collection::vec(proptest::collection::vec(any::<bool>(), 20), 0..6),
        ) {
            let mut rows: Vec<_> = (0..20).map(|i| row(i64::from(i), 7, i)).collect();
            let mut arrived = HashSet::new();
            let mut now = moment();
            // One round more than losses: where nothing at all arrived, the first that does brings
            // the first receipt.
            for round in 0..=losses.len() + 1 {
                now += Duration::from_secs(100);
                for row in rows.iter_mut().filter(|r| r.sent_at.is_none()) {
                    row.sent_at = Some(now);
                    row.sent_count += 1;
                    let is_lost = losses.get(round).is_some_and(|l| l[row.sequence as usize]);
                    if !is_lost { arrived.insert(row.sequence); }
                }
                now += Duration::from_secs(10_000);
                if let Some(through) = arrived.iter().copied().max() {
                    let missing: Vec<_> = (0..through).filter(|s| !arrived.contains(s)).collect();
                    let effect = apply_receipt(&receipt(through, &missing), &rows, now);
                    for row in &rows { prop_assert!(!effect.held.contains(&row.id) || arrived.contains(&row.sequence)); }
                    rows.retain(|r| !effect.held.contains(&r.id));
                    for row in &mut rows { if effect.resend.contains(&row.id) { row.sent_at = None; } }
                }
                for id in overdue(&rows, &OverduePolicy::default(), now, !arrived.is_empty()) {
                    for row in &mut rows { if row.id == id { row.sent_at = None; } }
                }
            }
            prop_assert!(rows.is_empty());
            prop_assert_eq!(arrived.len(), 20);
        }
    }
}
