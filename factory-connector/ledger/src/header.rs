//! Header of an entry: the members of its text that most checks need.

use std::borrow::Cow;

use asi_model::DateTime;
use serde::Deserialize;

use super::{SequenceRange, history::ReportEvent};

/// Members that most kinds of entries have. Kinds that are rare have more and are parsed completely.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct EntryHeader<'t> {
    #[serde(borrow)]
    pub(crate) recipient: Cow<'t, str>,
    pub(crate) number: u64,
    pub(crate) recorded_at: DateTime,
    event: EntryKind,
    data_set_writer_id: Option<u16>,
    epoch: Option<u32>,
    first_sequence: Option<u32>,
    last_sequence: Option<u32>,
    #[serde(borrow)]
    message_id: Option<Cow<'t, str>>,
    values: Option<&'t str>,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum EntryKind {
    Consent,
    Queued,
    Sent,
    Receipted,
    Coalesced,
    Expired,
    Purged,
    Revoked,
    Retention,
    PastReleased,
}

impl EntryHeader<'_> {
    /// Returns whether the entry commits to the values of a report.
    pub(crate) fn is_queued(&self) -> bool {
        self.event == EntryKind::Queued
    }

    /// Returns whether the entry has more than a header.
    pub(crate) const fn is_rare(&self) -> bool {
        matches!(
            self.event,
            EntryKind::Consent
                | EntryKind::Revoked
                | EntryKind::Retention
                | EntryKind::PastReleased
        )
    }

    /// Returns the root over the values of a report, hexadecimal.
    pub(crate) const fn values(&self) -> Option<&str> {
        self.values
    }

    /// Returns the reports that the entry is about; `None` where it does not name them.
    pub(crate) fn range(&self) -> Option<SequenceRange> {
        Some(SequenceRange {
            data_set_writer_id: self.data_set_writer_id?,
            epoch: self.epoch?,
            first_sequence: self.first_sequence?,
            last_sequence: self.last_sequence?,
        })
    }

    /// Returns what became of reports; `None` where the entry does not name them. QUEUED entries and
    /// rare ones are the caller's.
    pub(crate) fn event(&self) -> Option<ReportEvent> {
        let range = self.range()?;
        Some(match self.event {
            EntryKind::Sent => {
                let message_id = self.message_id.as_deref().map(Box::from);
                ReportEvent::Sent { range, message_id }
            }
            EntryKind::Receipted => ReportEvent::Receipted(range),
            EntryKind::Coalesced | EntryKind::Expired | EntryKind::Purged => {
                ReportEvent::Ended(range)
            }
            EntryKind::Consent
            | EntryKind::Queued
            | EntryKind::Revoked
            | EntryKind::Retention
            | EntryKind::PastReleased => ReportEvent::Other,
        })
    }
}
