//! Alliances of partners, and caps of the information that they get, each in its newest version.

use std::collections::BTreeMap;

use asi_model::DateTime;
use disclosure::{Alliance, Cap, CapInForce, CapSubject, DocumentId, RuleFault, Versioned};

use crate::{
    DocumentError,
    documents::{by_id, put},
    snapshot::StoredBudgets,
    writes::DocumentRow,
};

/// Owner of alliances and caps.
#[derive(Debug, Clone, Default)]
pub struct BudgetRegistry {
    alliances: BTreeMap<DocumentId, Versioned<Alliance>>,
    caps: BTreeMap<DocumentId, Versioned<Cap>>,
}

impl From<StoredBudgets> for BudgetRegistry {
    fn from(stored: StoredBudgets) -> Self {
        Self { alliances: by_id(stored.alliances), caps: by_id(stored.caps) }
    }
}

impl BudgetRegistry {
    /// Returns the alliances, retired ones included.
    pub fn alliances(&self) -> impl Iterator<Item = &Versioned<Alliance>> {
        self.alliances.values()
    }

    /// Returns the caps, retired ones included.
    pub fn caps(&self) -> impl Iterator<Item = &Versioned<Cap>> {
        self.caps.values()
    }

    /// Returns a cap.
    #[must_use]
    pub fn cap(&self, id: &DocumentId) -> Option<&Versioned<Cap>> {
        self.caps.get(id)
    }

    /// Returns the caps in force, each with those whom it counts together.
    pub fn caps_in_force(&self) -> impl Iterator<Item = CapInForce> {
        self.caps.values().filter_map(|cap| CapInForce::new(cap, self.alliances.values()))
    }

    /// Stores the next version of an alliance, and returns its row.
    pub(crate) fn put_alliance(
        &mut self,
        id: &DocumentId,
        alliance: Alliance,
        expected: Option<u32>,
        author: (&str, DateTime),
    ) -> Result<DocumentRow, DocumentError> {
        let others = self.alliances.values().filter(|other| other.key.id != *id);
        let mut faults = alliance.faults(others);
        let is_subject = |cap: &&Versioned<Cap>| {
            !cap.document.is_retired
                && matches!(&cap.document.subject, CapSubject::AllianceId(other) if other == id)
        };
        if let Some(cap) = self.caps.values().find(is_subject).filter(|_| alliance.is_retired) {
            let message =
                format!("The cap {} is about it: retire the cap first.", cap.document.name);
            faults.push(RuleFault { pointer: "/isRetired".to_owned(), message });
        }
        if faults.is_empty() {
            put(&mut self.alliances, id, alliance, expected, author)
        } else {
            Err(DocumentError::Faults(faults))
        }
    }

    /// Stores the next version of a cap, and returns its row.
    pub(crate) fn put_cap(
        &mut self,
        id: &DocumentId,
        cap: Cap,
        expected: Option<u32>,
        author: (&str, DateTime),
    ) -> Result<DocumentRow, DocumentError> {
        let mut faults = cap.faults();
        if let CapSubject::AllianceId(alliance) = &cap.subject
            && !cap.is_retired
            && self.alliances.get(alliance).is_none_or(|known| known.document.is_retired)
        {
            let message = format!("There is no alliance {alliance}, or it is retired.");
            faults.push(RuleFault { pointer: "/subject/allianceId".to_owned(), message });
        }
        if faults.is_empty() {
            put(&mut self.caps, id, cap, expected, author)
        } else {
            Err(DocumentError::Faults(faults))
        }
    }
}
