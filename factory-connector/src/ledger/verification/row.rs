//! The verification of one entry by itself: everything that needs no other entry but the hash of the one before.

use asi_model::OrganisationId;

use super::super::{Entry, Event, Hash, SequenceRange, chain_hash, values_root};

/// A stored entry, as raw as it lies there: whatever is wrong with it is to be found, not to be tripped over.
#[derive(Debug, Clone, Default)]
pub struct StoredEntry {
    /// Whose chain.
    pub recipient: Vec<u8>,
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
    /// The report, where there is one with that number.
    pub report: Option<StoredReport>,
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
    pub(super) recipient: String,
    pub(super) number: u64,
    /// The hash as stored: the next entry follows it, so that one change yields one fault.
    pub(super) hash: Hash,
    pub(super) faults: Vec<&'static str>,
    pub(super) values: Values,
    pub(super) consent: Option<(String, u32, Event, i64)>,
    pub(super) revocation: Option<String>,
}

impl StoredEntry {
    /// The hash as stored; zeros where it is none.
    #[must_use]
    pub fn stored_hash(&self) -> Hash {
        self.hash.as_slice().try_into().unwrap_or_default()
    }

    /// Looks at the entry, given the stored hash of the one before it.
    #[must_use]
    pub fn check(&self, previous: &Hash) -> CheckedEntry {
        let mut checked = CheckedEntry {
            recipient: String::from_utf8_lossy(&self.recipient).into_owned(),
            number: u64::try_from(self.number).unwrap_or_default(),
            hash: self.stored_hash(),
            faults: Vec::new(),
            values: Values::None,
            consent: None,
            revocation: None,
        };
        let Ok(content) = std::str::from_utf8(&self.content) else {
            checked.faults.push("the entry cannot be read");
            return checked;
        };
        if chain_hash(previous, content)[..] != self.hash[..] {
            checked.faults.push("the entry or one before it was changed");
        }
        let Ok(entry) = serde_json::from_str::<Entry>(content) else {
            checked.faults.push("the entry cannot be read");
            return checked;
        };
        if entry.recipient.as_str().as_bytes() != self.recipient || entry.number != checked.number {
            checked.faults.push("the entry stands in another's place");
        }
        if entry.recorded_at.unix_micros() != self.recorded_at {
            checked.faults.push("the time beside the entry is not the entry's");
        }
        match entry.event {
            Event::Queued { range, values, .. } => {
                self.check_report(&mut checked, &entry.recipient, range, &values);
            }
            _ if self.report_id.is_some() => checked.faults.push("the entry refers to a report that is not its own"),
            Event::Consent { ref field, version, .. } => {
                checked.consent = Some((field.to_string(), version, entry.event, self.recorded_at));
            }
            Event::Revoked { revocation_id, .. } => checked.revocation = Some(revocation_id),
            _ => {}
        }
        checked
    }

    fn check_report(
        &self,
        checked: &mut CheckedEntry,
        recipient: &OrganisationId,
        range: SequenceRange,
        committed: &str,
    ) {
        let Some(report) = &self.report else {
            checked.faults.push("the report with the values was deleted");
            return;
        };
        let stored = (report.data_set_writer_id, report.epoch, report.sequence, report.created_at);
        let stated = (
            i64::from(range.data_set_writer_id),
            i64::from(range.epoch),
            i64::from(range.first_sequence),
            self.recorded_at,
        );
        if stored != stated {
            checked.faults.push("the report is not the one that was queued");
        }
        let is_recipient = serde_json::from_slice::<Vec<OrganisationId>>(&report.recipients)
            .is_ok_and(|recipients| recipients.contains(recipient));
        if !is_recipient {
            checked.faults.push("the report's recipients were changed");
        }
        match (&report.body, &report.salt) {
            (Some(body), Some(salt)) => {
                checked.values = Values::Compared;
                let root = std::str::from_utf8(body).ok().and_then(|body| values_root(body, salt).ok());
                if root.map(hex::encode).as_deref() != Some(committed) {
                    checked.faults.push("the values are not those that were reported");
                }
            }
            (None, None) => checked.values = Values::Emptied,
            _ => checked.faults.push("the values were removed in part"),
        }
    }
}
