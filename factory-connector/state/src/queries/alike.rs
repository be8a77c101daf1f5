//! Fields alike: fields of the same operation with the same meaning or name, and fields that read
//! the same variable. A second gate beside that of a field alike would let its own first value out
//! at once, and so, with that of the other, more values than the policy of either allows.

use std::{collections::BTreeSet, time::Duration};

use asi_model::{DateTime, FieldName, OrganisationId, network::Semantic};
use disclosure::{CapSubject, DisclosurePolicy, VariableKey, readers};

use crate::{ConnectorState, Field, FormerDisclosure, operator::OperationKey};

/// A field as a standing rule would disclose it.
pub(super) struct Acceptance<'s> {
    pub(super) state: &'s ConnectorState,
    pub(super) field: &'s Field,
    /// The policy that would be in force.
    pub(super) policy: &'s DisclosurePolicy,
    /// The variables that its mapping would read.
    pub(super) variables: BTreeSet<VariableKey>,
    pub(super) now: DateTime,
}

impl Acceptance<'_> {
    /// Returns true where a field alike is open to any of the recipients or their allies, or was
    /// within the longest period of the policy. Fields of one request that rules decide about at
    /// once begin together and are no second gates of each other; nor is a field that is disclosed
    /// again as it was.
    pub(super) fn is_second_gate(&self) -> bool {
        let period = self.policy.longest_period();
        if period.is_zero() || self.is_as_before(period) {
            return false;
        }
        let readers = self.readers();
        self.is_alike_open(&readers) || self.was_alike_open(&readers, period)
    }

    /// Returns true where the field itself was open within the period, to all of its recipients and
    /// in no coarser way: its gate goes on with its intervals and rates.
    fn is_as_before(&self, period: Duration) -> bool {
        let recipients = self.state.networks.recipients(&self.field.key().request);
        self.state.former.of_operation(&OperationKey::of(self.field.key())).any(|former| {
            let used = &former.used;
            used.field == self.field.id()
                && self.is_recent(former, period)
                && recipients.iter().all(|recipient| used.readers.contains(recipient))
                && self.variables.is_subset(&used.variables)
                && used.policy.allows_all_of(self.policy)
        })
    }

    /// Returns the recipients and those to whom they tell what they get.
    fn readers(&self) -> BTreeSet<OrganisationId> {
        let recipients = self.state.networks.recipients(&self.field.key().request);
        let with_allies = |recipient: &OrganisationId| {
            let subject = CapSubject::Partner(recipient.clone());
            readers(&subject, self.state.budgets.alliances())
        };
        recipients.iter().flat_map(with_allies).collect()
    }

    fn is_alike_open(&self, readers: &BTreeSet<OrganisationId>) -> bool {
        let is_second = |other: &Field| {
            let (request, own) = (&other.key().request, &self.field.key().request);
            let is_begun_together = request == own && other.decision().decided_at == Some(self.now);
            let recipients = self.state.networks.recipients(request);
            other.id() != self.field.id()
                && other.decision().is_mapped()
                && !is_begun_together
                && recipients.iter().any(|recipient| readers.contains(recipient))
        };
        let mut reading =
            self.variables.iter().flat_map(|variable| self.state.fields.reading(variable));
        self.meant_in_operation().any(is_second) || reading.any(is_second)
    }

    /// Returns the fields of the operation that have the meaning or the name of this one.
    fn meant_in_operation(&self) -> impl Iterator<Item = &Field> {
        let operation = self.state.operation(&OperationKey::of(self.field.key()));
        let requests = operation.into_iter().flat_map(|found| &found.dynamic_data_request_list);
        requests.flat_map(move |request| {
            let fields = request.report_data_format.report_field_list.iter();
            let meant = fields.filter(|field| self.is_meant(&field.name, field.semantic.as_ref()));
            meant.filter_map(move |field| {
                let mut key = self.field.key().request.clone();
                key.dynamic_data_request_id = request.dynamic_data_request_id.clone();
                self.state.field(&key.field(field.name.clone()))
            })
        })
    }

    fn was_alike_open(&self, readers: &BTreeSet<OrganisationId>, period: Duration) -> bool {
        let is_second = |former: &FormerDisclosure| {
            former.used.field != self.field.id()
                && self.is_recent(former, period)
                && former.used.readers.iter().any(|reader| readers.contains(reader))
        };
        let former = &self.state.former;
        let mut of_operation = former.of_operation(&OperationKey::of(self.field.key()));
        let mut reading = self.variables.iter().flat_map(|variable| former.of_variable(variable));
        let means_the_same =
            |it: &FormerDisclosure| self.is_meant(&it.key.field_name, it.semantic.as_ref());
        of_operation.any(|former| means_the_same(former) && is_second(former))
            || reading.any(is_second)
    }

    /// Returns true where a field of the same operation has the meaning or the name of this one.
    fn is_meant(&self, name: &FieldName, semantic: Option<&Semantic>) -> bool {
        let own = self.field.definition().semantic.as_ref();
        *name == self.field.key().field_name || (own.is_some() && semantic == own)
    }

    fn is_recent(&self, former: &FormerDisclosure, period: Duration) -> bool {
        former.ended_at.after(period) > self.now
    }
}
