//! Decisions about the past: which reports of before a recipient was asked about already.

use std::collections::HashMap;

use asi_model::{OrganisationId, RequestKey};

/// Owner of the decisions about the past, as far as they are needed to decide once about a report.
#[derive(Debug, Default)]
pub struct PastDecisionRegistry(HashMap<(RequestKey, OrganisationId), i64>);

impl PastDecisionRegistry {
    pub(crate) fn new(
        decided: impl IntoIterator<Item = (RequestKey, OrganisationId, i64)>,
    ) -> Self {
        let mut registry = Self::default();
        for (request, recipient, report) in decided {
            registry.note(request, recipient, report);
        }
        registry
    }

    /// Returns the greatest number of a report about which it was decided whether the recipient
    /// sees it; `None` before the first decision.
    #[must_use]
    pub fn decided_through(&self, request: &RequestKey, recipient: &OrganisationId) -> Option<i64> {
        self.0.get(&(request.clone(), recipient.clone())).copied()
    }

    pub(crate) fn note(&mut self, request: RequestKey, recipient: OrganisationId, report: i64) {
        let through = self.0.entry((request, recipient)).or_insert(report);
        *through = report.max(*through);
    }
}
