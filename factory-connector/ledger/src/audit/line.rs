//! Check of one line of an audit file for itself.

use std::borrow::Cow;

use asi_model::DateTime;
use serde::Deserialize;
use serde_json::value::RawValue;
use transparency_log::leaf_hash;

use crate::{
    Event, Hash, LedgerEntry, SequenceRange,
    header::EntryHeader,
    history::{EntryDelivery, ReportEvent},
    values::CheckedValues,
    values_root,
};

/// An entry with what belongs to it, as [`AuditEntry`](super::AuditEntry), without copies of its
/// texts.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Line<'t> {
    #[serde(borrow)]
    entry: Cow<'t, str>,
    #[serde(borrow)]
    report: Option<&'t RawValue>,
    #[serde(borrow)]
    salt: Option<Cow<'t, str>>,
    sent_at: Option<DateTime>,
    #[serde(borrow)]
    message_id: Option<Cow<'t, str>>,
    delivered_at: Option<DateTime>,
}

/// A line that was checked for itself, to be taken in its order.
pub struct CheckedLine {
    /// Hash of the entry in its log; none where the line cannot be read.
    pub(super) leaf: Option<Hash>,
    /// Number that the entry says it has; none where it cannot be read.
    pub(super) number: Option<u64>,
    /// Microseconds since 1970.
    pub(super) recorded_at: i64,
    pub(super) faults: Vec<&'static str>,
    pub(super) values: CheckedValues,
    pub(super) event: ReportEvent,
}

impl CheckedLine {
    /// Checks a line of the chain of this organisation.
    pub(super) fn new(text: &str, recipient: &str) -> Self {
        let mut checked = Self {
            leaf: None,
            number: None,
            recorded_at: 0,
            faults: Vec::new(),
            values: CheckedValues::None,
            event: ReportEvent::Other,
        };
        let Ok(line) = serde_json::from_str::<Line<'_>>(text) else {
            checked.faults.push("the line cannot be read");
            return checked;
        };
        checked.leaf = Some(leaf_hash(line.entry.as_bytes()));
        let Ok(header) = serde_json::from_str::<EntryHeader<'_>>(&line.entry) else {
            checked.faults.push("the entry cannot be read");
            return checked;
        };
        checked.number = Some(header.number);
        checked.recorded_at = header.recorded_at.unix_micros();
        if header.recipient != recipient {
            checked.faults.push("the entry is one of another chain");
        }
        match header.range().filter(|_| header.is_queued()) {
            Some(range) => checked.compare_values(range, header.values(), &line),
            None => checked.take_other(&header, &line),
        }
        checked
    }

    fn take_other(&mut self, header: &EntryHeader<'_>, line: &Line<'_>) {
        let has_report = line.report.is_some()
            || line.salt.is_some()
            || line.sent_at.is_some()
            || line.message_id.is_some()
            || line.delivered_at.is_some();
        if has_report {
            self.faults.push("the entry has the report of another");
        }
        let event = if header.is_rare() {
            let entry = serde_json::from_str::<LedgerEntry>(&line.entry);
            entry.ok().and_then(|entry| match entry.event {
                Event::Retention(statement) => Some(ReportEvent::Retained(statement)),
                // Queued for others: this chain does not know the reports.
                Event::PastReleased { range, .. } => {
                    (range.first_sequence <= range.last_sequence).then_some(ReportEvent::Other)
                }
                _ => Some(ReportEvent::Other),
            })
        } else {
            header.event().filter(|_| !header.is_queued())
        };
        match event {
            Some(event) => self.event = event,
            None => self.faults.push("the entry cannot be read"),
        }
    }

    fn compare_values(&mut self, range: SequenceRange, values: Option<&str>, line: &Line<'_>) {
        match (line.report, &line.salt) {
            (Some(report), Some(salt)) => {
                self.values = CheckedValues::Compared;
                let root = hex::decode(salt.as_bytes()).ok();
                let root = root.and_then(|salt| values_root(report.get(), &salt).ok());
                if root.is_none() || root.map(hex::encode).as_deref() != values {
                    self.faults.push("the values are not those that were reported");
                }
            }
            (None, None) => self.values = CheckedValues::Emptied,
            _ => self.faults.push("the values were removed in part"),
        }
        let micros = |at: Option<DateTime>| at.map(DateTime::unix_micros);
        self.event = ReportEvent::Queued {
            range,
            stated: EntryDelivery {
                sent_at: micros(line.sent_at),
                message_id: line.message_id.as_deref().map(Box::from),
                receipted_at: micros(line.delivered_at),
            },
            is_emptied: self.values == CheckedValues::Emptied,
        };
    }
}
