use proptest::prelude::*;

use super::*;
use crate::row::fixtures::{moment, row};

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

fn gap(first_sequence: u32, last_sequence: u32) -> SequenceGap {
    SequenceGap { data_set_writer_id: 7, epoch: 1, first_sequence, last_sequence }
}

#[test]
fn receipted_rows_are_removed_and_missing_ones_sent_again() {
    let rows = [sent(1, 0), sent(2, 1), sent(3, 2), sent(4, 3), row(5, 7, 4)];
    let later = moment() + Duration::from_secs(5);
    let effect = ReceiptEffect {
        receipted: vec![RowId(1), RowId(3)],
        resend: vec![RowId(2)],
        reopen: Vec::new(),
        lost: Vec::new(),
    };
    assert_eq!(apply_receipt(&receipt(2, &[1]), &rows, later, Duration::ZERO), effect);
}

#[test]
fn a_row_that_was_just_sent_does_not_count_as_missing() {
    let effect = apply_receipt(&receipt(2, &[1]), &[sent(2, 1)], moment(), Duration::ZERO);
    assert_eq!(effect, ReceiptEffect::default());
    let under_way = Duration::from_secs(5);
    let after = |wait| apply_receipt(&receipt(2, &[1]), &[sent(2, 1)], moment() + wait, under_way);
    assert_eq!(after(under_way), ReceiptEffect::default());
    assert_eq!(after(under_way + Duration::from_millis(1)).resend, [RowId(2)]);
}

#[test]
fn a_row_sent_before_the_clock_was_set_back_counts_as_missing() {
    let now = moment() - Duration::from_secs(300);
    let effect = apply_receipt(&receipt(2, &[1]), &[sent(2, 1)], now, Duration::from_secs(5));
    assert_eq!(effect.resend, [RowId(2)]);
}

#[test]
fn rows_of_another_epoch_or_never_sent_stay() {
    let mut other = sent(1, 0);
    other.epoch = 2;
    let effect = apply_receipt(&receipt(9, &[]), &[other, row(2, 7, 1)], moment(), Duration::ZERO);
    assert_eq!(effect, ReceiptEffect::default());
}

#[test]
fn missing_sequence_numbers_without_a_row_are_lost() {
    let effect = apply_receipt(&receipt(9, &[3, 4, 7, 8]), &[sent(1, 8)], moment(), Duration::ZERO);
    assert_eq!(effect.lost, [gap(3, 4), gap(7, 7)]);
}

#[test]
fn missing_rows_that_the_store_still_has_wait_again() {
    let mut effect = apply_receipt(&receipt(9, &[3, 4, 7]), &[], moment(), Duration::ZERO);
    effect.reopen_receipted(&[sent(11, 4), sent(12, 7)]);
    assert_eq!((effect.lost, effect.reopen), (vec![gap(3, 3)], vec![RowId(11), RowId(12)]));
}

#[test]
fn the_receipt_timeout_doubles_up_to_its_maximum() {
    let policy = OverduePolicy {
        receipt_timeout: Duration::from_secs(10),
        receipt_timeout_max: Duration::from_secs(35),
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
        let now = moment() + Duration::from_secs(seconds);
        let is_overdue = !overdue(&rows, &policy, now, true).is_empty();
        assert_eq!(is_overdue, expected, "sent {count} times, {seconds} s ago");
    }
}

#[test]
fn a_row_that_was_never_sent_is_not_overdue() {
    let much_later = moment() + Duration::from_secs(9999);
    assert_eq!(overdue(&[row(1, 7, 0)], &OverduePolicy::default(), much_later, true), []);
}

#[test]
fn a_row_sent_in_the_future_is_overdue() {
    let before = moment() - Duration::from_secs(300);
    assert_eq!(overdue(&[sent(1, 0)], &OverduePolicy::default(), before, true), [RowId(1)]);
}

#[test]
fn without_receipts_only_the_newest_row_of_each_writer_is_overdue() {
    let other = ReportRow { data_set_writer_id: 8, ..sent(3, 0) };
    let rows = [sent(1, 0), sent(2, 1), other, row(4, 7, 2)];
    let later = moment() + Duration::from_secs(61);
    assert_eq!(overdue(&rows, &OverduePolicy::default(), later, false), [RowId(2), RowId(3)]);
}

/// Rows per case of the property.
const ROWS: u32 = 20;

/// A spool, a network that loses messages, and a platform that receipts the ones that arrive.
struct Exchange {
    rows: Vec<ReportRow>,
    arrived: HashSet<u32>,
    now: OffsetDateTime,
}

impl Exchange {
    fn new() -> Self {
        let rows = (0..ROWS).map(|sequence| row(i64::from(sequence), 7, sequence)).collect();
        Self { rows, arrived: HashSet::new(), now: moment() }
    }

    /// Sends every waiting row; `is_lost` by sequence number.
    fn send(&mut self, is_lost: impl Fn(u32) -> bool) {
        self.now += Duration::from_secs(100);
        for row in self.rows.iter_mut().filter(|row| row.sent_at.is_none()) {
            row.sent_at = Some(self.now);
            row.sent_count += 1;
            if !is_lost(row.sequence) {
                self.arrived.insert(row.sequence);
            }
        }
        self.now += Duration::from_secs(10_000);
    }

    /// The platform's receipt; none while nothing arrived.
    fn receipt(&self) -> Option<WriterReceipt> {
        let through = self.arrived.iter().copied().max()?;
        let missing: Vec<_> = (0..through).filter(|s| !self.arrived.contains(s)).collect();
        Some(receipt(through, &missing))
    }

    fn make_wait(&mut self, ids: &[RowId]) {
        for row in self.rows.iter_mut().filter(|row| ids.contains(&row.id)) {
            row.sent_at = None;
        }
    }
}

proptest! {
    #[test]
    fn whatever_the_network_loses_every_row_is_receipted_in_the_end(
        losses in proptest::collection::vec(
            proptest::collection::vec(any::<bool>(), ROWS as usize),
            0..6,
        ),
    ) {
        let mut exchange = Exchange::new();
        // One round more than losses: where nothing at all arrived, the first message that does
        // brings the first receipt.
        for round in 0..=losses.len() + 1 {
            exchange.send(|sequence| losses.get(round).is_some_and(|l| l[sequence as usize]));
            if let Some(receipt) = exchange.receipt() {
                let effect = apply_receipt(&receipt, &exchange.rows, exchange.now, Duration::ZERO);
                for row in &exchange.rows {
                    let has_arrived = exchange.arrived.contains(&row.sequence);
                    prop_assert!(!effect.receipted.contains(&row.id) || has_arrived, "{:?}", row);
                }
                exchange.rows.retain(|row| !effect.receipted.contains(&row.id));
                exchange.make_wait(&effect.resend);
            }
            let hears_receipts = !exchange.arrived.is_empty();
            let policy = OverduePolicy::default();
            let late = overdue(&exchange.rows, &policy, exchange.now, hears_receipts);
            exchange.make_wait(&late);
        }
        prop_assert_eq!(exchange.rows, []);
        prop_assert_eq!(exchange.arrived.len(), ROWS as usize);
    }
}
