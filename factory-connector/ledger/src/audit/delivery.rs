//! Delivery of reports, played from the entries and compared with what the file says beside them.

use std::collections::BTreeMap;

use asi_model::{DateTime, MessageId};

use super::file::AuditEntry;
use crate::{Event, LedgerEntry, SequenceRange};

/// Writer, epoch and sequence number of a report.
type ReportId = (u16, u32, u32);

/// Delivery of a report.
#[derive(Debug, Default, PartialEq, Eq)]
struct Delivery {
    /// In microseconds since 1970, as are all times beside entries.
    sent_at: Option<i64>,
    message_id: Option<MessageId>,
    delivered_at: Option<i64>,
}

/// Delivery of a report as the file says, and as its entries say.
#[derive(Debug)]
struct Report {
    number: u64,
    stated: Delivery,
    entered: Delivery,
}

/// The reports of a file.
#[derive(Debug, Default)]
pub(super) struct Deliveries {
    reports: BTreeMap<ReportId, Report>,
    /// The file has the chain from its beginning on: whatever is delivered was queued in it.
    is_whole: bool,
}

impl Deliveries {
    pub(super) fn new(is_whole: bool) -> Self {
        Self { reports: BTreeMap::new(), is_whole }
    }

    /// Takes the next entry.
    pub(super) fn take(
        &mut self,
        entry: &LedgerEntry,
        line: &AuditEntry,
    ) -> Result<(), &'static str> {
        let micros = |at: Option<DateTime>| at.map(DateTime::unix_micros);
        let at = Some(entry.recorded_at.unix_micros());
        match &entry.event {
            Event::Queued { range, .. } => {
                let stated = Delivery {
                    sent_at: micros(line.sent_at),
                    message_id: line.message_id.clone(),
                    delivered_at: micros(line.delivered_at),
                };
                let report = Report { number: entry.number, stated, entered: Delivery::default() };
                let id = (range.data_set_writer_id, range.epoch, range.first_sequence);
                match self.reports.insert(id, report) {
                    Some(_) => Err("the report was queued twice"),
                    None => Ok(()),
                }
            }
            Event::Sent { range, message_id } => self.each(range, |delivery| {
                delivery.sent_at = at;
                if message_id.is_some() {
                    delivery.message_id.clone_from(message_id);
                }
            }),
            Event::Receipted(range) => self.each(range, |delivery| delivery.delivered_at = at),
            Event::Coalesced(range) | Event::Expired(range) | Event::Purged(range) => {
                self.each(range, |_| {})
            }
            Event::Consent { .. } | Event::Revoked { .. } => Ok(()),
        }
    }

    /// Returns the numbers of the entries beside which the file says something else.
    pub(super) fn wrong(self) -> impl Iterator<Item = u64> {
        let wrong = self.reports.into_values().filter(|report| report.stated != report.entered);
        wrong.map(|report| report.number)
    }

    fn each(
        &mut self,
        range: &SequenceRange,
        change: impl Fn(&mut Delivery),
    ) -> Result<(), &'static str> {
        let SequenceRange { data_set_writer_id: writer, epoch, first_sequence, last_sequence } =
            *range;
        if first_sequence > last_sequence {
            return Err("the entry is about no report");
        }
        let ids = (writer, epoch, first_sequence)..=(writer, epoch, last_sequence);
        let mut count = 0;
        for (_, report) in self.reports.range_mut(ids) {
            change(&mut report.entered);
            count += 1;
        }
        let is_complete = count == u64::from(last_sequence - first_sequence) + 1;
        if is_complete || !self.is_whole {
            Ok(())
        } else {
            Err("the entry is about a report that was not queued")
        }
    }
}
