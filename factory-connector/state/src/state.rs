//! The whole state: its registries side by side.

use std::sync::Arc;

use asi_model::{
    DateTime, FactoryId, FieldKey, MessageId, RequestKey,
    messages::{FactoryMessage, OperationNetworkMessage},
    network::{DynamicDataRequest, Operation},
    pubsub::json::Encoding,
};

use crate::{
    BudgetRegistry, ChangeSet, ControlBody, Field, FieldRegistry, FormerDisclosureRegistry,
    IdSource, JournalRegistry, LedgerChains, NetworkRegistry, PastDecisionRegistry, PolicyRegistry,
    WriterRegistry,
    operator::{Journal, OperationKey},
    writes::ControlRow,
};

/// Identity and form of the reports of this connector.
#[derive(Debug, Clone)]
pub struct StateConfig {
    pub factory_id: FactoryId,
    pub encoding: Encoding,
}

/// State of a connector. It is changed by use cases only.
pub struct ConnectorState {
    pub(crate) config: StateConfig,
    pub(crate) networks: NetworkRegistry,
    pub(crate) fields: FieldRegistry,
    pub(crate) writers: WriterRegistry,
    pub(crate) policies: PolicyRegistry,
    pub(crate) budgets: BudgetRegistry,
    pub(crate) journals: JournalRegistry,
    pub(crate) ledger: LedgerChains,
    pub(crate) past: PastDecisionRegistry,
    pub(crate) former: FormerDisclosureRegistry,
    pub(crate) ids: IdSource,
    /// The greatest number given in the spool.
    pub(crate) last_row: i64,
}

impl ConnectorState {
    /// Returns identity and form of the reports.
    #[must_use]
    pub const fn config(&self) -> &StateConfig {
        &self.config
    }

    /// Returns the operation networks.
    #[must_use]
    pub const fn networks(&self) -> &NetworkRegistry {
        &self.networks
    }

    /// Returns the requested fields.
    #[must_use]
    pub const fn fields(&self) -> &FieldRegistry {
        &self.fields
    }

    /// Returns the data set writers.
    #[must_use]
    pub const fn writers(&self) -> &WriterRegistry {
        &self.writers
    }

    /// Returns policies and standing rules.
    #[must_use]
    pub const fn policies(&self) -> &PolicyRegistry {
        &self.policies
    }

    /// Returns alliances and caps.
    #[must_use]
    pub const fn budgets(&self) -> &BudgetRegistry {
        &self.budgets
    }

    /// Returns the ends of the ledger's chains.
    #[must_use]
    pub const fn ledger(&self) -> &LedgerChains {
        &self.ledger
    }

    /// Returns the decisions about the past.
    #[must_use]
    pub const fn past(&self) -> &PastDecisionRegistry {
        &self.past
    }

    /// Returns the journal of an operation, if anything was entered about it.
    #[must_use]
    pub fn journal(&self, operation: &OperationKey) -> Option<&Journal> {
        self.journals.get(operation)
    }

    /// Returns a field.
    #[must_use]
    pub fn field(&self, key: &FieldKey) -> Option<&Field> {
        self.fields.get(key)
    }

    /// Returns an operation of an active network.
    #[must_use]
    pub fn operation(&self, key: &OperationKey) -> Option<&Operation> {
        self.networks.operation(key)
    }

    /// Returns a request of an active network, with the message it came in.
    #[must_use]
    pub fn request(
        &self,
        key: &RequestKey,
    ) -> Option<(&Arc<OperationNetworkMessage>, &DynamicDataRequest)> {
        self.networks.request(key)
    }

    /// Returns the fields of a request whose document is at hand, in payload order.
    pub fn fields_in<'s>(
        &'s self,
        key: &'s RequestKey,
        request: &'s DynamicDataRequest,
    ) -> impl Iterator<Item = (FieldKey, &'s Field)> {
        request.report_data_format.report_field_list.iter().filter_map(move |definition| {
            let key = key.field(definition.name.clone());
            self.fields.get(&key).map(|field| (key, field))
        })
    }

    /// Returns the fields of a request, in payload order.
    pub fn fields_of<'s>(
        &'s self,
        request: &'s RequestKey,
    ) -> impl Iterator<Item = (FieldKey, &'s Field)> {
        let document = self.request(request).map(|(_, document)| document);
        document.into_iter().flat_map(move |document| self.fields_in(request, document))
    }

    /// Returns the greatest number given in the spool. Numbers of messages that are under way must
    /// not be given again after the state was loaded again.
    #[must_use]
    pub const fn last_row(&self) -> i64 {
        self.last_row
    }

    /// Returns the next number in the spool.
    pub(crate) const fn next_row(&mut self) -> i64 {
        self.last_row += 1;
        self.last_row
    }

    /// Queues a control message for the platform.
    pub(crate) fn send(
        &mut self,
        changes: &mut ChangeSet,
        message: &FactoryMessage,
        correlation_id: Option<MessageId>,
        now: DateTime,
    ) {
        self.queue_control(
            changes,
            ControlRow {
                id: 0,
                message_id: message.message_id().clone(),
                subject: message.message_type().to_owned(),
                correlation_id,
                body: ControlBody::of(message),
                created_at: now,
                ttl_ms: None,
            },
        );
    }

    /// Queues a control message under the next number.
    pub(crate) fn queue_control(&mut self, changes: &mut ChangeSet, message: ControlRow) {
        let id = self.next_row();
        changes.writes.controls.queued.push(ControlRow { id, ..message });
        changes.effects.link.is_spool_filled = true;
    }
}
