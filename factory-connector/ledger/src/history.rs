//! History of a chain's reports, played from its entries and compared with what is said beside them:
//! when each report was sent and receipted, and whether its values may be missing.

mod ranges;

use std::collections::BTreeMap;

use ranges::Ranges;

use super::{RetentionRule, RetentionStatement, SequenceRange};

const WRONG_DELIVERY: &str = "time or message of the delivery is not the one that was entered";
const EMPTIED: &str = "the values were emptied without a statement of retention";
const REMOVED: &str = "entries were removed without a statement of retention";

/// Writer, epoch and sequence number of a report.
type ReportId = (u16, u32, u32);

/// Delivery of a report.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct EntryDelivery {
    /// Microseconds since 1970, as are all times beside entries.
    pub(crate) sent_at: Option<i64>,
    pub(crate) message_id: Option<Box<str>>,
    pub(crate) receipted_at: Option<i64>,
}

/// Event of an entry as far as it concerns reports.
#[derive(Debug, Clone, Default)]
pub(crate) enum ReportEvent {
    /// The entry is about no report.
    #[default]
    Other,
    Queued {
        range: SequenceRange,
        /// Delivery as it is said beside the entry.
        stated: EntryDelivery,
        is_emptied: bool,
    },
    Sent {
        range: SequenceRange,
        message_id: Option<Box<str>>,
    },
    Receipted(SequenceRange),
    /// The reports were given up or taken back.
    Ended(SequenceRange),
    Retained(RetentionStatement),
}

/// Report whose delivery as entered so far is not the one that is said beside its entry.
#[derive(Debug)]
struct OpenReport {
    /// Number of its entry.
    number: u64,
    stated: EntryDelivery,
    entered: EntryDelivery,
}

/// Report without values of which no statement of retention was found so far.
#[derive(Debug)]
struct EmptiedReport {
    number: u64,
    /// Microseconds since 1970.
    queued_at: i64,
}

/// The reports of a chain. What is settled is remembered as a range of sequence numbers only: a chain
/// of any length takes as much memory as it has reports that are on their way.
#[derive(Debug, Default)]
pub(crate) struct ReportHistory {
    queued: BTreeMap<(u16, u32), Ranges>,
    open: BTreeMap<ReportId, OpenReport>,
    emptied: BTreeMap<ReportId, EmptiedReport>,
    removed_through: u64,
    /// The chain has a statement of retention, as only later versions make.
    is_stated: bool,
    /// Time of the statement about a former version.
    former_at: Option<i64>,
    /// Number of the last entry before the present ones; 0 where the chain is whole, and whatever is
    /// delivered was queued in it.
    start: u64,
}

impl ReportHistory {
    /// Starts after the entry with this number; 0 for the beginning of the chain.
    pub(crate) fn after(start: u64) -> Self {
        Self { start, ..Self::default() }
    }

    /// Returns the time of the statement about a former version, in microseconds since 1970.
    pub(crate) const fn former_at(&self) -> Option<i64> {
        self.former_at
    }

    /// Returns whether the chain states any retention.
    pub(crate) const fn is_stated(&self) -> bool {
        self.is_stated
    }

    /// Takes the next entry, recorded at `at` in microseconds since 1970.
    pub(crate) fn take(
        &mut self,
        number: u64,
        at: i64,
        event: ReportEvent,
    ) -> Result<(), &'static str> {
        match event {
            ReportEvent::Other => Ok(()),
            ReportEvent::Queued { range, stated, is_emptied } => {
                self.queue(number, at, &range, stated, is_emptied)
            }
            ReportEvent::Sent { range, message_id } => self.deliver(&range, |delivery| {
                delivery.sent_at = Some(at);
                if message_id.is_some() {
                    delivery.message_id.clone_from(&message_id);
                }
            }),
            ReportEvent::Receipted(range) => {
                self.deliver(&range, |delivery| delivery.receipted_at = Some(at))
            }
            ReportEvent::Ended(range) => self.count(&range).map(drop),
            ReportEvent::Retained(statement) => self.retain(at, &statement),
        }
    }

    /// Ends the history: returns faults with the numbers of their entries. Values of reports that
    /// were queued before `granted`, in microseconds since 1970, may be missing without a statement.
    pub(crate) fn finish(self, granted: Option<i64>) -> Vec<(u64, &'static str)> {
        let open = self.open.into_values().map(|report| (report.number, WRONG_DELIVERY));
        let is_granted = |at: i64| granted.is_some_and(|before| at < before);
        let emptied = self.emptied.into_values().filter(|report| !is_granted(report.queued_at));
        let emptied = emptied.map(|report| (report.number, EMPTIED));
        let removed = (self.removed_through != self.start).then_some((self.start, REMOVED));
        open.chain(emptied).chain(removed).collect()
    }

    fn queue(
        &mut self,
        number: u64,
        at: i64,
        range: &SequenceRange,
        stated: EntryDelivery,
        is_emptied: bool,
    ) -> Result<(), &'static str> {
        let SequenceRange { data_set_writer_id: writer, epoch, first_sequence, last_sequence } =
            *range;
        if first_sequence != last_sequence {
            return Err("the entry is about several reports");
        }
        if !self.queued.entry((writer, epoch)).or_default().insert(first_sequence) {
            return Err("the report was queued twice");
        }
        let id = (writer, epoch, first_sequence);
        let entered = EntryDelivery::default();
        if stated != entered {
            self.open.insert(id, OpenReport { number, stated, entered });
        }
        if is_emptied {
            self.emptied.insert(id, EmptiedReport { number, queued_at: at });
        }
        Ok(())
    }

    fn deliver(
        &mut self,
        range: &SequenceRange,
        change: impl Fn(&mut EntryDelivery),
    ) -> Result<(), &'static str> {
        let queued = self.count(range)?;
        let mut open = 0;
        let mut settled = Vec::new();
        for (id, report) in self.open.range_mut(ids(range)) {
            open += 1;
            change(&mut report.entered);
            if report.entered == report.stated {
                settled.push(*id);
            }
        }
        for id in settled {
            self.open.remove(&id);
        }
        // What is not open was never delivered or delivered last before, as is said beside it.
        if open == queued { Ok(()) } else { Err(WRONG_DELIVERY) }
    }

    fn retain(&mut self, at: i64, statement: &RetentionStatement) -> Result<(), &'static str> {
        self.is_stated = true;
        let before = statement.before.unix_micros();
        if before > at {
            return Err("the statement of retention is about the future");
        }
        if statement.rule == RetentionRule::FormerVersion && *self.former_at.get_or_insert(at) != at
        {
            return Err("what a former version emptied is stated twice");
        }
        for range in &statement.emptied {
            if range.first_sequence > range.last_sequence {
                return Err("the entry is about no report");
            }
            let covered: Vec<ReportId> = self
                .emptied
                .range(ids(range))
                .filter(|(_, report)| report.queued_at < before)
                .map(|(id, _)| *id)
                .collect();
            for id in covered {
                self.emptied.remove(&id);
            }
        }
        self.removed_through = self.removed_through.max(statement.removed_through.unwrap_or(0));
        Ok(())
    }

    /// Returns the number of reports in a range that were queued in the present entries.
    fn count(&self, range: &SequenceRange) -> Result<u64, &'static str> {
        let SequenceRange { data_set_writer_id: writer, epoch, first_sequence, last_sequence } =
            *range;
        if first_sequence > last_sequence {
            return Err("the entry is about no report");
        }
        let queued = self.queued.get(&(writer, epoch));
        let count = queued.map_or(0, |queued| queued.count(first_sequence, last_sequence));
        let is_complete = count == u64::from(last_sequence - first_sequence) + 1;
        if is_complete || self.start > 0 {
            Ok(count)
        } else {
            Err("the entry is about a report that was not queued")
        }
    }
}

fn ids(range: &SequenceRange) -> std::ops::RangeInclusive<ReportId> {
    let SequenceRange { data_set_writer_id: writer, epoch, first_sequence, last_sequence } = *range;
    (writer, epoch, first_sequence)..=(writer, epoch, last_sequence)
}
