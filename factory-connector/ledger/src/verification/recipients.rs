//! Recipients of reports: each one beside a report has an entry about it in its chain.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

use asi_model::OrganisationId;

/// Reports of which not all recipients' entries were taken yet. Chains are read side by side, so
/// there are few at a time.
#[derive(Default)]
pub(super) struct AwaitedRecipients(HashMap<i64, Awaited>);

struct Awaited {
    /// Time of the report, in microseconds since 1970.
    at: i64,
    recipients: BTreeSet<OrganisationId>,
}

impl AwaitedRecipients {
    /// Takes the entry about a report in one recipient's chain, recorded at `at` in microseconds
    /// since 1970.
    pub(super) fn take(
        &mut self,
        (report, recipients): (i64, Arc<[OrganisationId]>),
        own: &str,
        at: i64,
    ) {
        let awaited = self
            .0
            .entry(report)
            .or_insert_with(|| Awaited { at, recipients: recipients.iter().cloned().collect() });
        awaited.recipients.retain(|recipient| recipient.as_str() != own);
        if awaited.recipients.is_empty() {
            self.0.remove(&report);
        }
    }

    /// Returns the recipients without an entry, each once. The entries of a chain that ends before
    /// `pruned` of its recipient may have been removed.
    pub(super) fn finish(self, pruned: &BTreeMap<&str, i64>) -> BTreeSet<OrganisationId> {
        let missing = self.0.into_values().flat_map(|awaited| {
            let is_pruned = move |recipient: &OrganisationId| {
                pruned.get(recipient.as_str()).is_some_and(|last| awaited.at <= *last)
            };
            awaited.recipients.into_iter().filter(move |recipient| !is_pruned(recipient))
        });
        missing.collect()
    }
}
