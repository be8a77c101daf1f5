//! Key frames: the DataSetMessage that a data set writer would report.

use std::{collections::BTreeMap, time::Duration};

use asi_model::{
    DateTime, FieldKey, FieldName, network::DynamicDataRequest, pubsub::DataSetMessage,
};
use disclosure::{
    DraftField, DraftGate, DraftOrGate, ReportFrame, ReportOrigin, ReportedField, draft_report,
};

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
    let origin = origin(state, id, writer, request);
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

/// Returns the message that a request's writer would report, were one field decided under a policy
/// that is not in force: the request's mapped fields and this one, in payload order. What it has of
/// this field is what the draft gate shows.
#[must_use]
pub fn draft_frame(
    state: &ConnectorState,
    key: &FieldKey,
    draft: &DraftGate,
    now: DateTime,
) -> Option<DataSetMessage> {
    let id = state.writers.id_of(&key.request)?;
    let writer = state.writers.get(id)?;
    let (_, request) = state.request(&key.request)?;
    let fields: Vec<(FieldKey, &Field)> = state
        .fields_of(&key.request)
        .filter(|(known, field)| known == key || field.decision().is_mapped())
        .collect();
    let fields = fields.iter().map(|(known, field)| DraftField {
        name: &known.field_name,
        unit: field.definition().unit.as_deref(),
        gate: if known == key {
            DraftOrGate::Draft(draft)
        } else {
            DraftOrGate::Gate(field.gate())
        },
    });
    draft_report(&origin(state, id, writer, request), fields, now)
}

/// Returns what a writer's report has besides its fields.
fn origin<'s>(
    state: &'s ConnectorState,
    id: u16,
    writer: &'s Writer,
    request: &'s DynamicDataRequest,
) -> ReportOrigin<'s> {
    ReportOrigin {
        data_set_writer_id: id,
        sequence_number: writer.next_sequence(),
        version: writer.version(),
        report_name: &request.report_data_format.report_name,
        request: writer.request(),
        recipient_list: state.networks.recipient_list(writer.request()),
    }
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
