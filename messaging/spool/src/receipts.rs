//! Receipts of the platform, applied to the rows of one writer: nothing is lost because only
//! receipted rows are removed and overdue rows are sent again.

use std::{
    collections::{HashMap, HashSet},
    time::Duration,
};

use asi_model::messages::WriterReceipt;
use time::OffsetDateTime;

use crate::{
    gap::{SequenceGap, join},
    row::{ReportRow, RowId},
};

/// Consequences of a receipt for the rows of its writer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReceiptEffect {
    /// Rows that the platform has stored: remove them.
    pub receipted: Vec<RowId>,
    /// Rows that were sent but are missing at the platform: make them wait again.
    pub resend: Vec<RowId>,
    /// Rows that were receipted before and are missing all the same: make them wait again.
    pub reopen: Vec<RowId>,
    /// Sequence numbers that are missing at the platform and no longer in the spool. Unless they
    /// are announced as gaps, the platform asks for them forever.
    pub lost: Vec<SequenceGap>,
}

impl ReceiptEffect {
    /// Iterates over the numbers in `lost`.
    pub fn lost_sequences(&self) -> impl Iterator<Item = u32> {
        self.lost.iter().flat_map(|gap| gap.first_sequence..=gap.last_sequence)
    }

    /// Takes rows that the store still has out of `lost` and makes them wait again. `kept` are rows
    /// of that writer and epoch that were receipted.
    ///
    /// Receipts have no order: one that a restored broker delivers late lists as missing what
    /// arrived since. Sending again is then discarded as a repeat, while a gap would deny what the
    /// partner holds. And a platform restored from a backup gets back what it had receipted.
    pub fn reopen_receipted(&mut self, receipted: &[ReportRow]) {
        let numbers: HashSet<u32> = receipted.iter().map(|row| row.sequence).collect();
        let key = |gap: &SequenceGap| (gap.data_set_writer_id, gap.epoch);
        let lost = self.lost.iter().flat_map(|gap| {
            let (writer, epoch) = key(gap);
            (gap.first_sequence..=gap.last_sequence).map(move |number| (writer, epoch, number))
        });
        self.lost = join(lost.filter(|(_, _, number)| !numbers.contains(number)).collect());
        self.reopen = receipted.iter().map(|row| row.id).collect();
    }
}

/// Applies a receipt to `rows`, which must be *all* rows in the spool of that writer and epoch.
///
/// A row counts as missing only when it was not sent within `under_way` before `now` (usually some
/// seconds): a younger one may still be on its way. One that was sent in the future was sent before the
/// clock was set back, and counts. Rows that were never sent are never receipted: a receipt
/// that claims them belongs to an earlier writer of the same id, and the row is sent.
#[must_use]
pub fn apply_receipt(
    receipt: &WriterReceipt,
    rows: &[ReportRow],
    now: OffsetDateTime,
    under_way: Duration,
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
            if sent_at > now || sent_at < now - under_way {
                effect.resend.push(row.id);
            }
        } else if row.sequence <= receipt.through_sequence {
            effect.receipted.push(row.id);
        }
    }
    let lost = missing.into_iter().filter(|sequence| !present.contains(sequence));
    effect.lost =
        join(lost.map(|sequence| (receipt.data_set_writer_id, receipt.epoch, sequence)).collect());
    effect
}

/// Time to wait for a receipt before a row is sent again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverduePolicy {
    /// Wait after the first sending; doubles with each further one.
    pub receipt_timeout: Duration,
    /// Limit of the doubled wait.
    pub receipt_timeout_max: Duration,
}

impl Default for OverduePolicy {
    fn default() -> Self {
        Self {
            receipt_timeout: Duration::from_secs(60),
            receipt_timeout_max: Duration::from_secs(3600),
        }
    }
}

impl OverduePolicy {
    /// Returns the wait after so many sendings.
    #[must_use]
    pub fn timeout_after(&self, sent_count: u32) -> Duration {
        let doublings = sent_count.saturating_sub(1).min(16);
        self.receipt_timeout.saturating_mul(1 << doublings).min(self.receipt_timeout_max)
    }
}

/// Chooses the rows that were sent so long ago without a receipt that the broker is presumed to
/// have lost them. To be called only while the link is up.
///
/// A row with a `sent_at` in the future was sent before the clock was set back. Its age is unknown,
/// so it counts as overdue.
///
/// While no receipts arrive (`hears_receipts` is false), only the newest overdue row of each writer
/// is chosen. It prompts the platform, which answers with a receipt that lists the missing ones. A
/// platform that was away finds one row more instead of the whole backlog twice.
#[must_use]
pub fn overdue(
    rows: &[ReportRow],
    policy: &OverduePolicy,
    now: OffsetDateTime,
    hears_receipts: bool,
) -> Vec<RowId> {
    let is_late = |row: &&ReportRow| {
        row.sent_at.is_some_and(|at| at > now || now - at > policy.timeout_after(row.sent_count))
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
mod tests;
