//! What people enter about operations: into the operation's journal, and from there through the
//! gates of its fields.

use std::time::Duration;

use asi_model::{
    DataValue, DateTime, FieldKey, StatusCode, messages::ValueSource, network::Operation,
};

use super::{Books, ConnectorEvent};
use crate::{
    operator::{EntryFault, Journal, OperationKey, OperatorEntry},
    values::typed_value,
};
use disclosure::GateOutcome;

/// Entries that waited longer than this on a page are not taken any more.
const AGE_MAX: Duration = Duration::from_secs(31 * 86_400);

/// What became of an entry.
#[derive(Debug, Clone, PartialEq)]
pub enum EntryOutcome {
    /// It is kept; these fields took a value from it.
    Taken(Vec<(FieldKey, GateOutcome)>),
    /// It was here already.
    Repeated,
    /// It is not kept, and never will be.
    Refused(EntryFault),
}

impl Books {
    /// Takes an entry. Whatever it says about fields that were decided Manual goes through their
    /// gates.
    pub fn enter(&mut self, entry: OperatorEntry, now: DateTime) -> EntryOutcome {
        if let Err(fault) = self.check_entry(&entry, now) {
            return EntryOutcome::Refused(fault);
        }
        let operation = entry.operation.clone();
        let journal = self.journals.entry(operation.clone()).or_default();
        if journal.has(&entry.entry_id) {
            return EntryOutcome::Repeated;
        }
        if journal.is_full() {
            return EntryOutcome::Refused(EntryFault::TooMany);
        }
        journal.insert(entry.clone());
        self.changes.operator_entries.push(entry);
        self.aftermath.events.push(ConnectorEvent::Operator(operation.clone()));
        let mut taken = Vec::new();
        for (field, value) in self.answers(&operation) {
            if let Some(outcome) = self.candidate(&field, ValueSource::Manual, value, None, now) {
                taken.push((field, outcome));
            }
        }
        EntryOutcome::Taken(taken)
    }

    /// The journal of an operation.
    #[must_use]
    pub fn journal(&self, operation: &OperationKey) -> Option<&Journal> {
        self.journals.get(operation)
    }

    /// An operation of an active network.
    #[must_use]
    pub fn operation(&self, key: &OperationKey) -> Option<&Operation> {
        let message = self.networks.get(&key.operation_network_id)?.message.as_ref()?;
        message
            .operation_network
            .operation_list
            .iter()
            .find(|operation| operation.operation_id == key.operation_id)
    }

    fn check_entry(&self, entry: &OperatorEntry, now: DateTime) -> Result<(), EntryFault> {
        self.operation(&entry.operation).ok_or(EntryFault::UnknownOperation)?;
        entry.action.check()?;
        if now.since(entry.made_at) > AGE_MAX {
            return Err(EntryFault::TooOld);
        }
        if let crate::operator::Action::Value { value, .. } = &entry.action {
            let field = entry.action.field(&entry.operation).and_then(|key| self.fields.get(&key));
            let field = field
                .filter(|field| field.decision.is_open_for(ValueSource::Manual))
                .ok_or(EntryFault::NotManual)?;
            typed_value(value, field.definition.field_type.0, entry.made_at)
                .map_err(EntryFault::WrongType)?;
        }
        Ok(())
    }

    /// What an operation's journal says about those of its fields that are decided Manual.
    fn answers(&self, operation: &OperationKey) -> Vec<(FieldKey, DataValue)> {
        let Some((document, journal)) = self.operation(operation).zip(self.journals.get(operation))
        else {
            return Vec::new();
        };
        let mut answers = Vec::new();
        for (key, field) in self.fields_of_operation(operation) {
            let definition = &field.definition;
            if !field.decision.is_open_for(ValueSource::Manual) {
                continue;
            }
            let Some((answer, at)) =
                journal.answer(&key, definition.semantic.as_ref(), document.planned_quantity)
            else {
                continue;
            };
            let value = match answer.json(definition.field_type.0) {
                None => Some(DataValue::status_only(StatusCode::BAD_NO_DATA, Some(at))),
                // A meaning that does not fit the field's type says nothing; a typed value was
                // checked when it came.
                Some(json) => typed_value(&json, definition.field_type.0, at).ok(),
            };
            answers.extend(value.map(|value| (key, value)));
        }
        answers
    }

    /// The fields of all requests about an operation.
    pub fn fields_of_operation(&self, operation: &OperationKey) -> Vec<(FieldKey, &super::Field)> {
        let Some(document) = self.operation(operation) else { return Vec::new() };
        let mut fields = Vec::new();
        for request in &document.dynamic_data_request_list {
            for definition in &request.report_data_format.report_field_list {
                let key = asi_model::RequestKey {
                    operation_network_id: operation.operation_network_id.clone(),
                    operation_id: operation.operation_id.clone(),
                    dynamic_data_request_id: request.dynamic_data_request_id.clone(),
                }
                .field(definition.name.clone());
                if let Some(field) = self.fields.get(&key) {
                    fields.push((key, field));
                }
            }
        }
        fields
    }
}
