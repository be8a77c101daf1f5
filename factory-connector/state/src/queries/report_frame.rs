//! Key frames: the DataSetMessage that a data set writer would report.

use std::{collections::BTreeMap, time::Duration};

use asi_model::{
    DateTime, FieldName,
    network::DynamicDataRequest,
    pubsub::{DataSetMessage, PayloadField, ReportHeader},
};
use disclosure::{ReportFrame, ReportOrigin, ReportedField};

use crate::{ConnectorState, Field, Writer};

/// Returns the newest disclosed values of a writer's data set in payload order, with the number of
/// the consent for each field; `None` before the first value.
#[must_use]
pub fn key_frame(
    state: &ConnectorState,
    id: u16,
    now: DateTime,
) -> Option<(ReportFrame, BTreeMap<FieldName, u32>)> {
    let writer = state.writers.get(id).filter(|writer| !writer.fields().is_empty())?;
    let (_, request) = state.request(writer.request())?;
    let origin = ReportOrigin {
        data_set_writer_id: id,
        sequence_number: writer.next_sequence(),
        version: writer.version(),
        report_name: &request.report_data_format.report_name,
        request: writer.request(),
        recipient_list: state.networks.recipient_list(writer.request()),
    };
    let mut consents = BTreeMap::new();
    let fields = fields_of(state, writer).map(|(name, field)| {
        if field.gate().disclosed().is_some() {
            consents.insert(name.clone(), field.decision().version);
        }
        let unit = field.definition().unit.as_deref();
        ReportedField { name, unit, gate: field.gate() }
    });
    let frame = ReportFrame::of(&origin, fields, now)?;
    Some((frame, consents))
}

/// Returns the longest time step of a data set's fields: on it are all times of the writer's
/// messages.
pub(crate) fn time_step(state: &ConnectorState, writer: &Writer) -> Duration {
    let steps = fields_of(state, writer).map(|(_, field)| field.gate().policy().time_step());
    steps.max().unwrap_or_default()
}

/// Returns the longest time step of a writer's data set, zero where there is none: so much younger
/// than it says a report can be.
#[must_use]
pub fn time_step_of(state: &ConnectorState, id: u16) -> Duration {
    state.writers.get(id).map_or(Duration::ZERO, |writer| time_step(state, writer))
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
