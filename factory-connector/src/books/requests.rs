//! Messages of the platform: what they do to networks, fields and writers.

use std::{collections::BTreeSet, sync::Arc};

use asi_model::{
    DateTime, FieldKey, MessageId, OperationNetworkId, RequestKey,
    difference::{ConsentEffect, FieldChange, MappingEffect, difference},
    messages::{
        Acknowledgement, AcknowledgementResult, Comment, FactoryMessage, Fault, GapCause,
        OperationNetworkMessage, Withdraw,
    },
    network::{OperationNetwork, ReportField},
};

use super::{
    Books, ConnectorEvent, Field, FieldDecision, MappingWork, Network, Traffic, TwinWork,
    new_message_id,
};
use crate::store::{CommentRow, NetworkRow};
use disclosure::{Gate, GateState};

impl Books {
    /// A network came, in a new revision or again. `raw` is the message as stored.
    pub fn network_arrived(
        &mut self,
        message: OperationNetworkMessage,
        raw: String,
        now: DateTime,
    ) {
        let id = message.operation_network.operation_network_id.clone();
        let known = self.networks.get(&id);
        let result = if known.is_some_and(|known| message.revision <= known.revision) {
            AcknowledgementResult::Unchanged
        } else {
            let revision = message.revision;
            let old = known.and_then(|known| known.message.clone());
            let message = Arc::new(message.clone());
            self.apply(old.as_deref().map(|old| &old.operation_network), &message, now);
            let row = NetworkRow {
                operation_network_id: id.clone(),
                revision,
                message: Some(raw),
                received_at: now,
            };
            self.changes.networks.push(row);
            self.aftermath.twin.push(TwinWork::Apply(id.clone()));
            self.aftermath.events.push(ConnectorEvent::Inbox(id.clone()));
            tracing::info!(operation.network = %id, revision, "An operation network is in effect.");
            AcknowledgementResult::Accepted
        };
        self.acknowledge(
            message.message_id,
            Some((id.clone(), message.revision)),
            result,
            Vec::new(),
            now,
        );
        if result == AcknowledgementResult::Accepted {
            let count = self.apply_rules(Some(&id), now);
            if count > 0 {
                tracing::info!(operation.network = %id, fields = count, "Standing rules decided about new fields.");
            }
        }
    }

    /// A network was withdrawn; its revision stays as a tombstone.
    pub fn network_withdrawn(&mut self, message: Withdraw, now: DateTime) {
        let id = message.operation_network_id.clone();
        let known = self.networks.get(&id);
        let result = if known.is_some_and(|known| message.revision <= known.revision) {
            AcknowledgementResult::Unchanged
        } else {
            if let Some(old) = known.and_then(|known| known.message.clone()) {
                for (key, ..) in old.operation_network.fields() {
                    self.consent_withdrawn(&key);
                }
                for (key, ..) in old.operation_network.fields() {
                    self.remove_field(&key, now);
                }
                self.journals.retain(|operation, _| operation.operation_network_id != id);
                for (request, ..) in old.operation_network.requests() {
                    self.retire_writer(&request, GapCause::Withdrawn, now);
                }
                self.aftermath.twin.push(TwinWork::Remove(id.clone()));
            }
            let tombstone = Network { revision: message.revision, message: None, received_at: now };
            self.networks.insert(id.clone(), tombstone);
            self.changes.networks.push(NetworkRow {
                operation_network_id: id.clone(),
                revision: message.revision,
                message: None,
                received_at: now,
            });
            self.aftermath.events.push(ConnectorEvent::Inbox(id.clone()));
            tracing::info!(operation.network = %id, revision = message.revision, "An operation network was withdrawn.");
            AcknowledgementResult::Accepted
        };
        self.acknowledge(message.message_id, Some((id, message.revision)), result, Vec::new(), now);
    }

    /// A partner said something.
    pub fn comment_arrived(&mut self, comment: Comment, now: DateTime) {
        self.aftermath.events.push(ConnectorEvent::Comment(comment.operation_network_id.clone()));
        self.changes.comments.push(CommentRow { comment, is_own: false, written_at: now });
    }

    /// The engineer says something.
    pub fn comment_made(&mut self, comment: Comment, now: DateTime) {
        self.send(&FactoryMessage::Comment(comment.clone()), None, now);
        self.aftermath.events.push(ConnectorEvent::Comment(comment.operation_network_id.clone()));
        self.changes.comments.push(CommentRow { comment, is_own: true, written_at: now });
    }

    /// Answers a message.
    pub fn acknowledge(
        &mut self,
        correlation_id: MessageId,
        subject: Option<(OperationNetworkId, u64)>,
        result: AcknowledgementResult,
        fault_list: Vec<Fault>,
        now: DateTime,
    ) {
        let (operation_network_id, revision) = subject.unzip();
        let acknowledgement = Acknowledgement {
            message_id: new_message_id(),
            factory_id: self.config.factory_id.clone(),
            correlation_id: correlation_id.clone(),
            operation_network_id,
            revision,
            result,
            fault_list,
        };
        self.send(&FactoryMessage::Acknowledgement(acknowledgement), Some(correlation_id), now);
    }

    /// Brings fields and writers from the old revision to the new one.
    fn apply(
        &mut self,
        old: Option<&OperationNetwork>,
        message: &Arc<OperationNetworkMessage>,
        now: DateTime,
    ) {
        let new = &message.operation_network;
        let empty = OperationNetwork {
            operation_network_id: new.operation_network_id.clone(),
            name: None,
            description: None,
            operation_list: Vec::new(),
            operation_relation_list: Vec::new(),
        };
        let difference = difference(old.unwrap_or(&empty), new);
        for change in
            difference.fields.iter().filter(|change| change.change == FieldChange::Removed)
        {
            self.consent_withdrawn(&change.key);
        }
        for request in &difference.requests.removed {
            self.retire_writer(request, GapCause::Withdrawn, now);
        }
        let network = Network {
            revision: message.revision,
            message: Some(Arc::clone(message)),
            received_at: now,
        };
        self.networks.insert(new.operation_network_id.clone(), network);
        let mut to_refresh: BTreeSet<RequestKey> = BTreeSet::new();
        for (request, ..) in new.requests() {
            self.add_writer(&request, now);
        }
        for change in difference.fields {
            match change.change {
                FieldChange::Removed => {
                    if self.remove_field(&change.key, now) {
                        // What waits still carries the field's value.
                        if let Some(writer) = self.writer_of.get(&change.key.request).copied() {
                            self.purges.entry(writer).or_insert(GapCause::Withdrawn);
                        }
                        to_refresh.insert(change.key.request.clone());
                    }
                }
                FieldChange::Added => self.add_field(&change.key, now),
                FieldChange::Changed => {
                    if self.change_field(&change.key, change.mapping, change.consent, now) {
                        to_refresh.insert(change.key.request.clone());
                    }
                }
            }
        }
        for request in to_refresh {
            if let Some(writer) = self.writer_of.get(&request).copied() {
                self.refresh_writer(writer, now);
            }
        }
    }

    fn add_field(&mut self, key: &FieldKey, now: DateTime) {
        let (Some(definition), Some(writer)) =
            (self.requested(key), self.writer_of.get(&key.request).copied())
        else {
            tracing::error!(field = %key, "A requested field has no data set writer: all 65 535 are taken.");
            return;
        };
        self.last_field += 1;
        let decision = FieldDecision::default();
        let field = Field {
            key: key.clone(),
            id: self.last_field,
            gate: Gate::new(
                Arc::clone(&decision.policy),
                definition.field_type.0,
                GateState::default(),
                now,
            ),
            definition,
            decision,
            traffic: Traffic::new(now),
            validity: self.validity_of(key),
            newest: None,
            transform: None,
            shelf: super::Shelf::default(),
            writer,
            noted_due: None,
            marks: super::Marks::default(),
        };
        self.fields.insert(field);
        self.store_field(key);
    }

    /// A field's definition as its request now states it.
    fn requested(&self, key: &FieldKey) -> Option<ReportField> {
        let (_, request) = self.request(&key.request)?;
        request
            .report_data_format
            .report_field_list
            .iter()
            .find(|field| field.name == key.field_name)
            .cloned()
    }

    /// The partner takes a request for a mapped field back.
    fn consent_withdrawn(&mut self, key: &FieldKey) {
        let decision = self.fields.get(key).map(|field| &field.decision);
        if let Some(version) =
            decision.filter(|decision| decision.is_mapped()).map(|decision| decision.version)
        {
            self.consent_ends(
                key,
                version,
                GapCause::Withdrawn,
                Some("The partner withdrew the request."),
                None,
            );
        }
    }

    /// True where the data set of the field's request changes.
    fn remove_field(&mut self, key: &FieldKey, now: DateTime) -> bool {
        let Some(field) = self.fields.remove(key) else { return false };
        self.tell_watchers(key, now);
        if let Some(due) = field.noted_due {
            self.due.remove(&(due, field.id));
        }
        self.unwatch(key);
        self.changes.fields.remove(&field.id);
        self.changes.field_values.remove(&field.id);
        self.changes.removed_fields.push(field.id);
        self.clear_shelf(&field);
        if field.decision.mapping.is_some() {
            self.aftermath.mappings.push(MappingWork::Remove(field.mapping_id()));
        }
        field.decision.is_mapped()
    }

    /// True where the data set of the field's request changes.
    fn change_field(
        &mut self,
        key: &FieldKey,
        mapping: MappingEffect,
        consent: ConsentEffect,
        now: DateTime,
    ) -> bool {
        let Some(definition) = self.requested(key) else { return false };
        let validity = self.validity_of(key);
        let Some(field) = self.fields.get_mut(key) else {
            self.add_field(key, now);
            return false;
        };
        let was_mapped = field.decision.is_mapped();
        let has_other_type = field.definition.field_type != definition.field_type;
        field.definition = definition;
        field.validity = validity;
        if has_other_type {
            field.gate = Gate::new(
                Arc::clone(field.gate.policy()),
                field.definition.field_type.0,
                GateState::default(),
                now,
            );
        }
        if mapping == MappingEffect::Suggested {
            field.transform = None;
        }
        if consent == ConsentEffect::Kept {
            self.note_expiry(key);
            self.store_field(key);
            return was_mapped;
        }
        if field.decision.mapping_state != asi_model::messages::MappingState::Pending {
            self.reopen(key, now);
        }
        was_mapped
    }
}
