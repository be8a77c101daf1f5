//! Consents that end: what the receipt states about each of them.

use std::collections::BTreeMap;

use asi_model::{FieldKey, OrganisationId, RequestKey, messages::GapCause};
use ledger::RevokedField;
use uuid::Uuid;

/// Cause and author of the end of consents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Ending<'e> {
    pub(crate) cause: GapCause,
    pub(crate) reason: Option<&'e str>,
    /// Name of the user; none where the partner or the end of a validity takes consent back.
    pub(crate) revoked_by: Option<&'e str>,
    /// All consents that end in this use case share one receipt.
    pub(crate) is_joint: bool,
}

/// Consents that ended together and are stated in one receipt.
#[derive(Debug)]
pub(crate) struct EndedConsents {
    pub(crate) revocation_id: Uuid,
    pub(crate) revoked_by: Option<String>,
    pub(crate) reason: Option<String>,
    pub(crate) cause: GapCause,
    pub(crate) fields: Vec<RevokedField>,
    /// The writers of the fields, by DataSetWriterId.
    pub(crate) writers: BTreeMap<u16, EndedWriter>,
}

/// A writer at the moment when a consent to one of its fields ended.
#[derive(Debug, Clone)]
pub(crate) struct EndedWriter {
    pub(crate) epoch: u32,
    pub(crate) next_sequence: u32,
    pub(crate) request: RequestKey,
    pub(crate) recipients: Vec<OrganisationId>,
}

impl EndedConsents {
    pub(crate) fn new(revocation_id: Uuid, ending: Ending<'_>) -> Self {
        Self {
            revocation_id,
            revoked_by: ending.revoked_by.map(str::to_owned),
            reason: ending.reason.map(str::to_owned),
            cause: ending.cause,
            fields: Vec::new(),
            writers: BTreeMap::new(),
        }
    }

    /// Returns true where a consent that ends so can be stated in this receipt.
    pub(crate) fn continues(&self, ending: Ending<'_>) -> bool {
        (ending.is_joint || ending.revoked_by.is_none())
            && self.cause == ending.cause
            && self.revoked_by.as_deref() == ending.revoked_by
            && self.reason.as_deref() == ending.reason
    }

    /// States the end of a consent.
    pub(crate) fn push(
        &mut self,
        field: FieldKey,
        consent_version: u32,
        id: u16,
        writer: EndedWriter,
    ) {
        self.fields.push(RevokedField { field, consent_version });
        self.writers.entry(id).or_insert(writer);
    }
}

/// Adds a later receipt of the same transaction: to the last one where both state the same.
pub(super) fn append(all: &mut Vec<EndedConsents>, mut later: EndedConsents) {
    for (id, writer) in &mut later.writers {
        // A writer that ends twice in one transaction is stated as it was at the first end.
        if let Some(first) = all.iter().find_map(|ended| ended.writers.get(id)) {
            writer.clone_from(first);
        }
    }
    let ending = Ending {
        cause: later.cause,
        reason: later.reason.as_deref(),
        revoked_by: later.revoked_by.as_deref(),
        is_joint: false,
    };
    match all.last_mut().filter(|last| last.continues(ending)) {
        None => all.push(later),
        Some(last) => {
            last.fields.append(&mut later.fields);
            for (id, writer) in later.writers {
                last.writers.entry(id).or_insert(writer);
            }
        }
    }
}
