//! Data sets brought up to date: their metadata precedes the reports that it describes.

use std::sync::Arc;

use asi_model::{
    BuiltInType, DateTime, FieldName, RequestKey,
    pubsub::{DataSetMetaData, FieldMetaData, MetaDataMessage, ReportHeader, unit_member},
};
use sha2::{Digest as _, Sha256};
use uuid::Uuid;

use crate::{
    ChangeSet, ConnectorState, ControlBody, Writer,
    keep_alive_schedule::schedule_keep_alive,
    queries::{fields_of, time_step},
    writes::ControlRow,
};

/// Describes each data set about which something was decided once, however many its decisions.
pub(super) fn refresh_writers(state: &mut ConnectorState, changes: &mut ChangeSet) {
    for (id, now) in std::mem::take(&mut changes.to_refresh) {
        refresh_writer(state, changes, id, now);
    }
}

/// Appended fields change the minor version only; any other change begins a new epoch.
fn refresh_writer(state: &mut ConnectorState, changes: &mut ChangeSet, id: u16, now: DateTime) {
    let Some(writer) = state.writers.get(id).filter(|writer| !writer.is_retired()) else {
        return;
    };
    let fields: Vec<FieldName> = state
        .fields_of(writer.request())
        .filter(|(_, field)| field.decision().is_mapped())
        .map(|(key, _)| key.field_name)
        .collect();
    // A consent that ended and was given again within one transaction ended nevertheless.
    let is_ended = changes.purges.get(&id).is_some_and(|purge| purge.is_end);
    if is_ended || !state.writers.append_fields(id, fields.clone(), now) {
        state.writers.begin_epoch(id, Some(fields), now);
    }
    describe(state, changes, id, now);
    schedule_keep_alive(state, id);
}

/// Begins a new epoch: sequence numbers start again, and everything is described and reported again.
pub(crate) fn begin_epoch(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    id: u16,
    now: DateTime,
) {
    state.writers.begin_epoch(id, None, now);
    describe(state, changes, id, now);
}

/// Queues the metadata of a writer, and a report where values are disclosed already.
fn describe(state: &mut ConnectorState, changes: &mut ChangeSet, id: u16, now: DateTime) {
    let Some(writer) = state.writers.get(id) else { return };
    changes.writes.writers.changed.insert(id, writer.row());
    if writer.fields().is_empty() {
        return;
    }
    let has_values = fields_of(state, writer).any(|(_, field)| field.gate().disclosed().is_some());
    let Some(meta_data) = meta_data(state, writer) else { return };
    let timestamp = now.floor_to(time_step(state, writer));
    let message_id = state.ids.next_message_id();
    let message = MetaDataMessage {
        message_id: Some(message_id.clone()),
        publisher_id: Some(Arc::from(state.config.factory_id.as_str())),
        data_set_writer_id: id,
        timestamp: Some(timestamp),
        meta_data,
        ..MetaDataMessage::default()
    };
    let body = ControlBody::of_meta_data(&message, state.config.encoding);
    state.queue_control(
        changes,
        ControlRow {
            id: 0,
            message_id,
            subject: "ua-metadata".to_owned(),
            correlation_id: None,
            body,
            created_at: now,
            ttl_ms: None,
        },
    );
    if has_values {
        state.writers.mark_unreported(id);
    }
}

/// Returns the metadata of a writer, in the payload's order.
fn meta_data(state: &ConnectorState, writer: &Writer) -> Option<DataSetMetaData> {
    let (_, document) = state.request(writer.request())?;
    let field_id = |name: &str| field_id(writer.request(), name);
    let names_recipients = state.networks.recipient_list(writer.request()).is_some();
    let mut fields: Vec<_> = ReportHeader::meta_data(names_recipients, field_id).collect();
    for (name, field) in fields_of(state, writer) {
        let id = field_id(name.as_str());
        let statement = field.statement();
        fields.push(FieldMetaData::of_report_field(field.definition(), statement.as_ref(), id));
        if field.definition().unit.is_some() {
            let unit = unit_member(name.as_str());
            let unit_id = field_id(&unit);
            fields.push(FieldMetaData::new(unit, BuiltInType::String, unit_id));
        }
    }
    Some(DataSetMetaData {
        name: Arc::from(document.report_data_format.report_name.as_str()),
        fields,
        configuration_version: writer.version(),
        ..DataSetMetaData::default()
    })
}

/// Derives the DataSetFieldId from the field's key, so that it is the same after every restart.
fn field_id(request: &RequestKey, name: &str) -> Uuid {
    let digest = Sha256::digest(format!("{request}/{name}"));
    let mut bytes = [0_u8; 16];
    bytes.copy_from_slice(&digest[..16]);
    uuid::Builder::from_custom_bytes(bytes).into_uuid()
}
