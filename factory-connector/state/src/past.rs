//! The past of a request for one recipient: reports that left for others before it was added.

use std::{collections::BTreeMap, sync::Arc};

use asi_model::{DateTime, FieldName, OrganisationId, RequestKey};
use disclosure::DisclosurePolicy;
use ledger::{Hash, SequenceRange};

/// Numbers of the consents under which a report left, by field.
pub type ReportConsents = Arc<BTreeMap<FieldName, u32>>;

/// A report that left for others.
#[derive(Debug, Clone, PartialEq)]
pub struct PastReport {
    /// Number of the report in the store.
    pub id: i64,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    /// Sequence number within the epoch.
    pub sequence: u32,
    pub created_at: DateTime,
    /// Root over the values, as the ledger has it.
    pub values: Hash,
    pub consents: ReportConsents,
}

/// Reports of a request that left for others and that the store still has with their values.
#[derive(Debug, Clone, PartialEq)]
pub struct Past {
    pub request: RequestKey,
    /// The recipient that has none of them.
    pub recipient: OrganisationId,
    /// Reports in the order of their numbers.
    pub reports: Vec<PastReport>,
    /// Policy that was in force under each consent, by field and number.
    pub policies: BTreeMap<(FieldName, u32), DisclosurePolicy>,
}

/// Offer to show the past to a recipient.
#[derive(Debug, Clone, PartialEq)]
pub struct PastOffer {
    /// The reports, grouped by the consents under which they left; the oldest first.
    pub parts: Vec<PastPart>,
    /// Reports that can be shown, with the root over their values: one range for neighbouring
    /// sequence numbers.
    pub ranges: Vec<(SequenceRange, Hash)>,
    /// Number of reports that can be shown.
    pub report_count: u64,
    /// Root over all of them.
    pub root: Hash,
    /// Number of the newest report that the offer is about, shown or not.
    pub through_report: i64,
    /// Numbers of the newest reports that can be shown, the oldest of them first.
    pub newest: Vec<i64>,
}

/// Reports that left under the same consents.
#[derive(Debug, Clone, PartialEq)]
pub struct PastPart {
    pub consents: ReportConsents,
    /// Number of reports.
    pub report_count: u64,
    /// Time of the first report.
    pub from: DateTime,
    /// Time of the last report.
    pub until: DateTime,
    /// Fields that are not open to the recipient at present.
    pub closed_fields: Vec<FieldName>,
    /// Fields that left under a policy which does not satisfy the present one.
    pub looser_fields: Vec<FieldName>,
}

impl PastPart {
    /// Returns true where the reports can be shown: every field of them is open to the recipient,
    /// and left under a policy that satisfies the present one.
    #[must_use]
    pub const fn is_offered(&self) -> bool {
        self.closed_fields.is_empty() && self.looser_fields.is_empty()
    }
}
