//! Verification of one entry or report separately: all checks that need only the hash of the entry
//! before.

use std::sync::Arc;

use asi_model::OrganisationId;
use transparency_log::leaf_hash;

use super::super::{
    Event, Hash, LedgerEntry, chain_hash,
    header::EntryHeader,
    history::{EntryDelivery, ReportEvent},
    values::CheckedValues,
    values_root,
};

/// A stored entry with unchecked columns: its faults are reported, not errors of the reader.
#[derive(Debug, Clone, Default)]
pub struct StoredEntry {
    /// Number in the chain.
    pub number: i64,
    /// Time of recording, in microseconds since 1970.
    pub recorded_at: i64,
    /// The report it refers to.
    pub report_id: Option<i64>,
    /// The canonical text that is hashed.
    pub content: Vec<u8>,
    /// Hash as stored, of any length; compared with the one of content and predecessor.
    pub hash: Vec<u8>,
}

/// The report of a QUEUED entry, with unchecked columns.
#[derive(Debug, Clone, Default)]
pub struct StoredReport {
    pub data_set_writer_id: i64,
    pub epoch: i64,
    /// Sequence number within the epoch.
    pub sequence: i64,
    /// Time of creation, in microseconds since 1970.
    pub created_at: i64,
    /// The recipients, a JSON array of organisations.
    pub recipients: Vec<u8>,
    /// The DataSetMessage, unless emptied.
    pub body: Option<Vec<u8>>,
    /// The salt of its hashes, unless emptied.
    pub salt: Option<Vec<u8>>,
    /// Time at which the broker accepted it last, in microseconds since 1970.
    pub sent_at: Option<i64>,
    /// The message in which it left last.
    pub message_id: Option<Vec<u8>>,
    /// Time at which the platform receipted it last, in microseconds since 1970.
    pub receipted_at: Option<i64>,
}

/// A report without its values, with which the entries of all its recipients are compared.
#[derive(Debug, Clone)]
pub struct ReportDigest {
    /// Writer, epoch, sequence number and time.
    stated: (i64, i64, i64, i64),
    recipients: Arc<[OrganisationId]>,
    values: Stored,
    delivery: EntryDelivery,
}

/// Stored state of a report's values.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Stored {
    /// The root over them, hexadecimal; none when they cannot be read.
    Root(Option<String>),
    Emptied,
    /// Values without their salt, or a salt without its values.
    InPart,
}

impl StoredReport {
    /// Hashes the values, once for all recipients of the report.
    #[must_use]
    pub fn digest(&self) -> ReportDigest {
        let values = match (&self.body, &self.salt) {
            (Some(body), Some(salt)) => {
                let root =
                    std::str::from_utf8(body).ok().and_then(|body| values_root(body, salt).ok());
                Stored::Root(root.map(hex::encode))
            }
            (None, None) => Stored::Emptied,
            _ => Stored::InPart,
        };
        ReportDigest {
            stated: (self.data_set_writer_id, self.epoch, self.sequence, self.created_at),
            recipients: serde_json::from_slice(&self.recipients).unwrap_or_default(),
            values,
            delivery: EntryDelivery {
                sent_at: self.sent_at,
                message_id: self
                    .message_id
                    .as_ref()
                    .map(|id| String::from_utf8_lossy(id).into_owned().into_boxed_str()),
                receipted_at: self.receipted_at,
            },
        }
    }
}

/// An entry that was checked separately.
pub struct CheckedEntry {
    pub(super) number: u64,
    /// The stored hash. The next entry follows it, so that one change results in one fault.
    pub(super) hash: Hash,
    /// Hash of the entry in its log.
    pub(super) leaf: Hash,
    pub(super) faults: Vec<&'static str>,
    pub(super) values: CheckedValues,
    /// A consent with its time of recording.
    pub(super) consent: Option<(Event, i64)>,
    pub(super) revocation: Option<String>,
    /// Time of recording beside the entry, in microseconds since 1970.
    pub(super) recorded_at: i64,
    pub(super) event: ReportEvent,
    /// The report with all its recipients, where others than this chain's are among them.
    pub(super) shared: Option<(i64, Arc<[OrganisationId]>)>,
}

impl StoredEntry {
    /// Returns the stored hash; zeros when it is not one.
    #[must_use]
    pub fn stored_hash(&self) -> Hash {
        self.hash.as_slice().try_into().unwrap_or_default()
    }

    /// Checks an entry of a chain, given the stored hash of the one before and its report, if it has
    /// one.
    #[must_use]
    pub fn check(
        &self,
        recipient: &[u8],
        previous: &Hash,
        report: Option<&ReportDigest>,
    ) -> CheckedEntry {
        let mut checked = CheckedEntry {
            number: u64::try_from(self.number).unwrap_or_default(),
            hash: self.stored_hash(),
            leaf: leaf_hash(&self.content),
            faults: Vec::new(),
            values: CheckedValues::None,
            consent: None,
            revocation: None,
            recorded_at: self.recorded_at,
            event: ReportEvent::Other,
            shared: None,
        };
        let content = std::str::from_utf8(&self.content).ok();
        if content.is_some_and(|content| chain_hash(previous, content)[..] != self.hash[..]) {
            checked.faults.push("the entry or one before it was changed");
        }
        let Some((content, header)) = content.and_then(|content| {
            Some((content, serde_json::from_str::<EntryHeader<'_>>(content).ok()?))
        }) else {
            checked.faults.push("the entry cannot be read");
            return checked;
        };
        if header.recipient.as_bytes() != recipient || header.number != checked.number {
            checked.faults.push("the entry stands in another's place");
        }
        if header.recorded_at.unix_micros() != self.recorded_at {
            checked.faults.push("the time beside the entry is not the entry's");
        }
        if header.is_queued() {
            self.compare(&mut checked, &header, report);
            return checked;
        }
        if self.report_id.is_some() {
            checked.faults.push("the entry refers to a report that is not its own");
        }
        if header.is_rare() {
            self.parse_completely(&mut checked, content);
        } else {
            match header.event() {
                Some(event) => checked.event = event,
                None => checked.faults.push("the entry cannot be read"),
            }
        }
        checked
    }

    /// Parses an entry of a kind that has more than a header.
    fn parse_completely(&self, checked: &mut CheckedEntry, content: &str) {
        match serde_json::from_str::<LedgerEntry>(content).map(|entry| entry.event) {
            Ok(Event::Revoked { revocation_id, .. }) => checked.revocation = Some(revocation_id),
            Ok(event @ Event::Consent { .. }) => checked.consent = Some((event, self.recorded_at)),
            Ok(Event::Retention(statement)) => checked.event = ReportEvent::Retained(statement),
            Ok(Event::PastReleased { range, .. })
                if range.first_sequence <= range.last_sequence => {}
            _ => checked.faults.push("the entry cannot be read"),
        }
    }

    fn compare(
        &self,
        checked: &mut CheckedEntry,
        header: &EntryHeader<'_>,
        report: Option<&ReportDigest>,
    ) {
        let Some(report) = report else {
            checked.faults.push("the report with the values was deleted");
            return;
        };
        let (writer, epoch, sequence, at) = report.stated;
        let Some(range) = header.range() else {
            checked.faults.push("the entry cannot be read");
            return;
        };
        let is_same = i64::from(range.data_set_writer_id) == writer
            && i64::from(range.epoch) == epoch
            && i64::from(range.first_sequence) == sequence
            && at == self.recorded_at;
        if !is_same {
            checked.faults.push("the report is not the one that was queued");
        }
        let own = report.recipients.iter().filter(|known| known.as_str() == header.recipient);
        if own.count() != 1 {
            checked.faults.push("the report's recipients were changed");
        }
        if report.recipients.len() > 1 {
            checked.shared = self.report_id.map(|id| (id, Arc::clone(&report.recipients)));
        }
        checked.event = ReportEvent::Queued {
            range,
            stated: report.delivery.clone(),
            is_emptied: report.values == Stored::Emptied,
        };
        match &report.values {
            Stored::Root(root) => {
                checked.values = CheckedValues::Compared;
                if root.is_none() || root.as_deref() != header.values() {
                    checked.faults.push("the values are not those that were reported");
                }
            }
            Stored::Emptied => checked.values = CheckedValues::Emptied,
            Stored::InPart => checked.faults.push("the values were removed in part"),
        }
    }
}
