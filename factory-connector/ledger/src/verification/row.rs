//! The verification of one entry or report by itself: everything that needs no other entry but the
//! hash of the one before.

use std::borrow::Cow;

use asi_model::{DateTime, OrganisationId};
use serde::Deserialize;

use super::super::{Entry, Event, Hash, chain_hash, values_root};

/// A stored entry, as raw as it lies there: whatever is wrong with it is to be found, not to be
/// tripped over.
#[derive(Debug, Clone, Default)]
pub struct StoredEntry {
    /// Its place.
    pub number: i64,
    /// When it was recorded, in microseconds since 1970.
    pub recorded_at: i64,
    /// The report it refers to.
    pub report_id: Option<i64>,
    /// The hashed text.
    pub content: Vec<u8>,
    /// The stored hash.
    pub hash: Vec<u8>,
}

/// The report of a QUEUED entry, as raw as it lies there.
#[derive(Debug, Clone, Default)]
pub struct StoredReport {
    /// The writer.
    pub data_set_writer_id: i64,
    /// Its epoch.
    pub epoch: i64,
    /// Its sequence number.
    pub sequence: i64,
    /// When it was made, in microseconds since 1970.
    pub created_at: i64,
    /// Who may see it, as JSON.
    pub recipients: Vec<u8>,
    /// The DataSetMessage, unless emptied.
    pub body: Option<Vec<u8>>,
    /// The salt of its hashes, unless emptied.
    pub salt: Option<Vec<u8>>,
}

/// A report without its values: what the entries of all its recipients are compared with.
#[derive(Debug, Clone)]
pub struct ReportDigest {
    /// Writer, epoch, sequence number and time.
    stated: (i64, i64, i64, i64),
    recipients: Vec<OrganisationId>,
    values: Stored,
}

/// What is left of a report's values.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Stored {
    /// The root over them, hexadecimal; none where they cannot be read.
    Root(Option<String>),
    /// Nothing.
    Emptied,
    /// Values without their salt, or a salt without its values.
    InPart,
}

impl StoredReport {
    /// Hashes the values: once, however many recipients the report has.
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
        }
    }
}

/// What came of the values of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    /// It has none.
    None,
    /// They were compared.
    Compared,
    /// Retention has emptied them.
    Emptied,
}

/// An entry that was looked at by itself.
pub struct CheckedEntry {
    pub(super) number: u64,
    /// The hash as stored: the next entry follows it, so that one change yields one fault.
    pub(super) hash: Hash,
    pub(super) faults: Vec<&'static str>,
    pub(super) values: Values,
    /// A consent, and when it was recorded.
    pub(super) consent: Option<(Event, i64)>,
    pub(super) revocation: Option<String>,
}

/// What verification needs of an entry's text. Consents and revocations are rare and read as a
/// whole.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Glance<'t> {
    #[serde(borrow)]
    recipient: Cow<'t, str>,
    number: u64,
    recorded_at: DateTime,
    event: Kind,
    data_set_writer_id: Option<u16>,
    epoch: Option<u32>,
    first_sequence: Option<u32>,
    values: Option<&'t str>,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
enum Kind {
    Consent,
    Queued,
    Sent,
    Receipted,
    Coalesced,
    Expired,
    Purged,
    Revoked,
}

impl StoredEntry {
    /// The hash as stored; zeros where it is none.
    #[must_use]
    pub fn stored_hash(&self) -> Hash {
        self.hash.as_slice().try_into().unwrap_or_default()
    }

    /// Looks at the entry of a chain, given the stored hash of the one before it and its report,
    /// where there is one with that number.
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
            faults: Vec::new(),
            values: Values::None,
            consent: None,
            revocation: None,
        };
        let content = std::str::from_utf8(&self.content).ok();
        if content.is_some_and(|content| chain_hash(previous, content)[..] != self.hash[..]) {
            checked.faults.push("the entry or one before it was changed");
        }
        let Some((content, glance)) = content
            .and_then(|content| Some((content, serde_json::from_str::<Glance<'_>>(content).ok()?)))
        else {
            checked.faults.push("the entry cannot be read");
            return checked;
        };
        if glance.recipient.as_bytes() != recipient || glance.number != checked.number {
            checked.faults.push("the entry stands in another's place");
        }
        if glance.recorded_at.unix_micros() != self.recorded_at {
            checked.faults.push("the time beside the entry is not the entry's");
        }
        if glance.event == Kind::Queued {
            self.compare(&mut checked, &glance, report);
        } else if self.report_id.is_some() {
            checked.faults.push("the entry refers to a report that is not its own");
        } else if matches!(glance.event, Kind::Consent | Kind::Revoked) {
            self.read_whole(&mut checked, content);
        }
        checked
    }

    fn read_whole(&self, checked: &mut CheckedEntry, content: &str) {
        match serde_json::from_str::<Entry>(content).map(|entry| entry.event) {
            Ok(Event::Revoked { revocation_id, .. }) => checked.revocation = Some(revocation_id),
            Ok(event @ Event::Consent { .. }) => checked.consent = Some((event, self.recorded_at)),
            _ => checked.faults.push("the entry cannot be read"),
        }
    }

    fn compare(
        &self,
        checked: &mut CheckedEntry,
        glance: &Glance<'_>,
        report: Option<&ReportDigest>,
    ) {
        let Some(report) = report else {
            checked.faults.push("the report with the values was deleted");
            return;
        };
        let (writer, epoch, sequence, at) = report.stated;
        let is_same = glance.data_set_writer_id.map(i64::from) == Some(writer)
            && glance.epoch.map(i64::from) == Some(epoch)
            && glance.first_sequence.map(i64::from) == Some(sequence)
            && at == self.recorded_at;
        if !is_same {
            checked.faults.push("the report is not the one that was queued");
        }
        if !report.recipients.iter().any(|recipient| recipient.as_str() == glance.recipient) {
            checked.faults.push("the report's recipients were changed");
        }
        match &report.values {
            Stored::Root(root) => {
                checked.values = Values::Compared;
                if root.is_none() || root.as_deref() != glance.values {
                    checked.faults.push("the values are not those that were reported");
                }
            }
            Stored::Emptied => checked.values = Values::Emptied,
            Stored::InPart => checked.faults.push("the values were removed in part"),
        }
    }
}
