//! Receipts that are asked for, where nothing else would prompt the platform: of reports whose consent
//! ended after they were sent, and of gaps that were announced.

use std::{
    collections::{BTreeMap, HashMap, HashSet},
    time::Duration,
};

use asi_model::{DateTime, messages::WriterSequences};
use connector_state::{
    use_cases::deliver::ask_for_receipts,
    writes::{AnnouncedGapRow, WaitingRow},
};
use messaging::spool::{OverduePolicy, ReportRow, RowId, overdue};
use tokio::time::Instant;

use super::unit_of_work::UnitOfWork;
use crate::store::StoreError;

/// Most writers of one request, as the message is bounded.
const WRITERS_MAX: usize = 500;
/// Most gaps that one round examines.
const GAPS_MAX: u32 = 10_000;

/// Writer and epoch.
type WriterEpoch = (u16, u32);

/// Receipts that were asked for since the start, by writer and epoch.
#[derive(Debug, Default)]
pub(super) struct ReceiptRequests {
    asked: HashMap<WriterEpoch, AskedReceipt>,
}

/// Receipt that was asked for and has not come, or not settled everything.
#[derive(Debug, Clone, Copy)]
struct AskedReceipt {
    again_at: Instant,
    count: u32,
}

impl ReceiptRequests {
    /// Asks for the receipts of writers with reports or gaps that wait for one for too long. `waiting`
    /// are rows of the spool. To be called only while the link is up.
    pub(super) async fn ask(
        &mut self,
        work: &mut UnitOfWork,
        waiting: &[WaitingRow],
        now: DateTime,
    ) -> Result<(), StoreError> {
        let policy = work.config.spool.overdue();
        let timeout = micros(policy.receipt_timeout);
        let before = DateTime::from_unix_micros(now.unix_micros().saturating_sub(timeout));
        let gaps = work.store.read().announced_gaps().oldest(before, now, GAPS_MAX).await?;
        let writers = self.due(&policy, unsettled(&policy, waiting, &gaps, now), Instant::now());
        if !writers.is_empty() {
            work.pending.merge(ask_for_receipts(&mut work.state, writers, now));
        }
        Ok(())
    }

    /// Returns the writers to ask about now: those that were not asked about lately.
    fn due(
        &mut self,
        policy: &OverduePolicy,
        unsettled: BTreeMap<WriterEpoch, u32>,
        instant: Instant,
    ) -> Vec<WriterSequences> {
        self.asked.retain(|writer, _| unsettled.contains_key(writer));
        let mut writers = Vec::new();
        for ((data_set_writer_id, epoch), through_sequence) in unsettled {
            let key = (data_set_writer_id, epoch);
            let known = self.asked.get(&key).copied();
            if known.is_some_and(|asked| asked.again_at > instant) || writers.len() == WRITERS_MAX {
                continue;
            }
            let count = known.map_or(1, |asked| asked.count.saturating_add(1));
            let again_at = instant + policy.timeout_after(count);
            self.asked.insert(key, AskedReceipt { again_at, count });
            writers.push(WriterSequences { data_set_writer_id, epoch, through_sequence });
        }
        writers
    }
}

/// Returns the last sequence number that waits for a receipt for too long, by writer and epoch; `gaps` do
/// so already.
fn unsettled(
    policy: &OverduePolicy,
    waiting: &[WaitingRow],
    gaps: &[AnnouncedGapRow],
    now: DateTime,
) -> BTreeMap<WriterEpoch, u32> {
    let revoked = waiting.iter().filter(|row| row.is_revoked);
    let revoked: Vec<ReportRow> = revoked.map(|row| row.row).collect();
    let late: HashSet<RowId> = overdue(&revoked, policy, now.into(), true).into_iter().collect();
    let reports = revoked.iter().filter(|row| late.contains(&row.id));
    let reports = reports.map(|row| ((row.data_set_writer_id, row.epoch), row.sequence));
    let gaps = gaps.iter().map(|AnnouncedGapRow { gap, .. }| {
        ((gap.data_set_writer_id, gap.epoch), gap.last_sequence)
    });
    let mut unsettled = BTreeMap::new();
    for (writer, sequence) in reports.chain(gaps) {
        let through = unsettled.entry(writer).or_insert(sequence);
        *through = sequence.max(*through);
    }
    unsettled
}

fn micros(duration: Duration) -> i64 {
    i64::try_from(duration.as_micros()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use asi_model::messages::GapCause;
    use messaging::spool::SequenceGap;

    use super::*;

    const POLICY: OverduePolicy = OverduePolicy {
        receipt_timeout: Duration::from_secs(60),
        receipt_timeout_max: Duration::from_secs(150),
    };

    fn second(second: i64) -> DateTime {
        DateTime::from_unix_micros(second * 1_000_000)
    }

    fn sent(sequence: u32, at: i64, is_revoked: bool) -> WaitingRow {
        WaitingRow {
            row: ReportRow {
                id: RowId(sequence.into()),
                data_set_writer_id: 1,
                epoch: 7,
                sequence,
                created_at: second(at).into(),
                sent_at: Some(second(at).into()),
                sent_count: 1,
                bytes: 10,
            },
            recipients: Vec::new(),
            is_revoked,
            message: sequence.into(),
            is_done: false,
        }
    }

    fn gap(writer: u16, last_sequence: u32) -> AnnouncedGapRow {
        let (epoch, first_sequence) = (7, 2);
        let gap = SequenceGap { data_set_writer_id: writer, epoch, first_sequence, last_sequence };
        AnnouncedGapRow { gap, cause: GapCause::Revoked, announced_at: second(0) }
    }

    #[test]
    fn what_is_not_sent_again_waits_for_a_receipt_that_is_asked_for() {
        let rows = [sent(3, 0, true), sent(5, 0, false), sent(4, 70, true)];
        let found = unsettled(&POLICY, &rows, &[gap(2, 9), gap(2, 4)], second(100));
        let expected = [((1, 7), 3), ((2, 7), 9)];
        assert_eq!(found.into_iter().collect::<Vec<_>>(), expected, "5 is sent again, 4 is young");
    }

    #[test]
    fn a_receipt_that_does_not_come_is_asked_for_ever_more_rarely() {
        let mut requests = ReceiptRequests::default();
        let begin = Instant::now();
        let mut asked_at = Vec::new();
        for passed in (0..600).step_by(10) {
            let open = BTreeMap::from([((1, 7), 3)]);
            let due = requests.due(&POLICY, open, begin + Duration::from_secs(passed));
            asked_at.extend(due.iter().map(|writer| (passed, writer.through_sequence)));
        }
        assert_eq!(asked_at, [(0, 3), (60, 3), (180, 3), (330, 3), (480, 3)]);
        assert!(requests.due(&POLICY, BTreeMap::new(), begin).is_empty());
        assert!(requests.asked.is_empty(), "what has been settled is forgotten");
    }

    #[test]
    fn a_request_names_no_more_writers_than_a_message_may() {
        let mut requests = ReceiptRequests::default();
        let open: BTreeMap<WriterEpoch, u32> = (0..700).map(|writer| ((writer, 7), 1)).collect();
        let now = Instant::now();
        let counts = [(); 3].map(|()| requests.due(&POLICY, open.clone(), now).len());
        assert_eq!(counts, [WRITERS_MAX, 200, 0]);
    }
}
