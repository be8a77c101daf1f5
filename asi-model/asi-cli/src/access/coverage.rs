//! Accesses compared with what left: values that an organisation read and that never left for it.

use std::collections::BTreeMap;

use access_log::AccessEntry;
use asi_model::OrganisationId;
use serde::Serialize;

use super::left_values::{Coverage, LeftIndex};

/// Most faults that are listed; further ones are only counted.
const LISTED_MAX: usize = 100;

/// Result of the comparison.
#[derive(Debug, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct CoverageAudit {
    /// Number of accesses whose request, fields and ends of the time span are those of values that left.
    pub accesses_covered: u64,
    /// Number of those of which an end is covered by reports whose values retention emptied only: their
    /// times are not known exactly.
    pub accesses_covered_by_emptied: u64,
    /// Number of accesses to values that are older than the entries of the file of their
    /// organisation, which retention removed: not compared.
    pub accesses_older: u64,
    /// Number of accesses of each organisation about which no file was given. Either nothing ever left
    /// for it, or its file is missing: a fault.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub without_ledger: BTreeMap<OrganisationId, u64>,
    /// Number of ranges of reports that were released afterwards and are in none of the files. Give the
    /// files of all recipients.
    pub past_ranges_unknown: u64,
    /// Number of reports whose values were emptied and of which no entry says what they answered.
    pub reports_unassigned: u64,
    /// Number of all faults.
    pub fault_count: u64,
    /// The first hundred faults.
    pub fault_list: Vec<CoverageFault>,
}

/// Fault of an access.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct CoverageFault {
    /// Number of the entry in the access log.
    number: u64,
    viewer: OrganisationId,
    /// Sentence without a full stop.
    message: String,
}

/// Compares one access after another.
pub struct CoverageCheck {
    index: LeftIndex,
    audit: CoverageAudit,
}

impl CoverageCheck {
    /// Begins with what left.
    pub const fn new(index: LeftIndex) -> Self {
        let audit = CoverageAudit {
            accesses_covered: 0,
            accesses_covered_by_emptied: 0,
            accesses_older: 0,
            without_ledger: BTreeMap::new(),
            past_ranges_unknown: index.unknown_past,
            reports_unassigned: index.unassigned,
            fault_count: 0,
            fault_list: Vec::new(),
        };
        Self { index, audit }
    }

    /// Compares an access.
    pub fn take(&mut self, entry: &AccessEntry) {
        match self.index.check(&entry.access) {
            Coverage::Covered => self.audit.accesses_covered += 1,
            Coverage::ByEmptied => self.audit.accesses_covered_by_emptied += 1,
            Coverage::Older => self.audit.accesses_older += 1,
            Coverage::NoFile => {
                let viewer = entry.access.viewer.clone();
                let count = self.audit.without_ledger.entry(viewer).or_default();
                *count += 1;
                if *count == 1 {
                    self.audit.fault(entry, "read, and no file says that anything left for it");
                }
            }
            Coverage::NotCovered(message) => self.audit.fault(entry, &message),
        }
    }

    /// Ends the comparison.
    pub fn finish(self) -> CoverageAudit {
        self.audit
    }
}

impl CoverageAudit {
    /// Returns whether nothing was read that did not leave.
    pub const fn is_intact(&self) -> bool {
        self.fault_count == 0
    }

    fn fault(&mut self, entry: &AccessEntry, message: &str) {
        self.fault_count += 1;
        if self.fault_list.len() < LISTED_MAX {
            let viewer = entry.access.viewer.clone();
            let message = message.to_owned();
            self.fault_list.push(CoverageFault { number: entry.number, viewer, message });
        }
    }
}
