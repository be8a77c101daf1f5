//! Key frames: the DataSetMessage that a data set writer would report.

use std::{collections::BTreeMap, sync::Arc, time::Duration};

use asi_model::{
    DataValue, DateTime, FieldName,
    network::DynamicDataRequest,
    pubsub::{DataSetMessage, PayloadField, ReportHeader, unit_member},
};

use crate::{ConnectorState, Field, Writer};

/// Resolution of the times of reports without a time step. The leak budget counts on it.
const TIMESTAMP_STEP: Duration = Duration::from_millis(1);

/// Returns the newest disclosed values of a writer's data set in payload order, with the number of
/// the consent for each field; `None` before the first value.
#[must_use]
pub fn key_frame(
    state: &ConnectorState,
    id: u16,
    now: DateTime,
) -> Option<(DataSetMessage, BTreeMap<FieldName, u32>)> {
    let writer = state.writers.get(id).filter(|writer| !writer.fields().is_empty())?;
    let (_, request) = state.request(writer.request())?;
    let mut values = Vec::with_capacity(writer.fields().len() * 2);
    let mut consents = BTreeMap::new();
    let mut newest: Option<DateTime> = None;
    // In the same pass: it is made for every report.
    let mut step = Duration::ZERO;
    for (name, field) in fields_of(state, writer) {
        step = step.max(field.gate().policy().time_step());
        let Some(value) = field.gate().disclosed() else { continue };
        newest = newest.max(value.source_timestamp);
        consents.insert(name.clone(), field.decision().version);
        let shown = DataValue { source_timestamp: None, server_timestamp: None, ..value.clone() };
        values.push(PayloadField::with(Arc::from(name.as_str()), shown));
        if let Some(unit) = &field.definition().unit {
            values.push(PayloadField::new(unit_member(name.as_str()), unit.as_str()));
        }
    }
    if consents.is_empty() {
        return None;
    }
    let shopfloor_timestamp = newest.unwrap_or(now).floor_to(step);
    let mut fields = header(state, writer, request, shopfloor_timestamp);
    fields.append(&mut values);
    let frame = DataSetMessage {
        data_set_writer_id: Some(id),
        sequence_number: Some(writer.next_sequence()),
        meta_data_version: Some(writer.version()),
        timestamp: Some(now.floor_to(step.max(TIMESTAMP_STEP))),
        fields,
        ..DataSetMessage::default()
    };
    Some((frame, consents))
}

/// Returns the longest time step of a data set's fields: on it are all times of the writer's
/// messages.
pub(crate) fn time_step(state: &ConnectorState, writer: &Writer) -> Duration {
    let steps = fields_of(state, writer).map(|(_, field)| field.gate().policy().time_step());
    steps.max().unwrap_or_default()
}

/// Returns a writer's report before any of its fields has a value.
#[must_use]
pub fn empty_frame(state: &ConnectorState, id: u16, now: DateTime) -> DataSetMessage {
    let writer = state.writers.get(id);
    let document = writer.and_then(|writer| Some((writer, state.request(writer.request())?.1)));
    let fields =
        document.map_or_else(Vec::new, |(writer, request)| header(state, writer, request, now));
    DataSetMessage {
        data_set_writer_id: Some(id),
        sequence_number: writer.map(Writer::next_sequence),
        meta_data_version: writer.map(Writer::version),
        timestamp: Some(now),
        fields,
        ..DataSetMessage::default()
    }
}

/// Returns the members that a writer's reports begin with.
fn header(
    state: &ConnectorState,
    writer: &Writer,
    request: &DynamicDataRequest,
    shopfloor_timestamp: DateTime,
) -> Vec<PayloadField> {
    let header = ReportHeader {
        report_name: &request.report_data_format.report_name,
        request: writer.request(),
        shopfloor_timestamp,
        recipient_list: state.networks.recipient_list(writer.request()),
    };
    header.payload_fields()
}

/// Returns the fields that a writer's metadata describes, in payload order.
pub(crate) fn fields_of<'s>(
    state: &'s ConnectorState,
    writer: &'s Writer,
) -> impl Iterator<Item = (&'s FieldName, &'s Field)> {
    writer.fields().iter().filter_map(|name| {
        state.fields.get(&writer.request().field(name.clone())).map(|field| (name, field))
    })
}
