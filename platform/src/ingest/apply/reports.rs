//! Reports: each sequence number once, the newest value of each field, and forwarding to tools.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::{
    BuiltInType, DataValue, FactoryId, FieldKey, FieldName, MessageId, OperationId,
    OperationNetworkId, OrganisationId, RequestKey, ToolId,
    pubsub::{
        NetworkMessage,
        json::{Encoding, encode},
    },
};
use messaging::LogicalAddress;

use crate::{
    ingest::{
        decode::{Incoming, IncomingReport},
        unit::IngestUnit,
    },
    live::{FieldUpdate, LiveEvent},
    store::{CurrentValue, NewReport, StoreError},
    value_json::value_json,
};

/// Messages waiting for one tool beyond which reports are no longer forwarded; the tool can still
/// read the history.
const TOOL_BACKLOG_MAX: u64 = 10_000;

/// The part of a dynamic data request that ingest needs.
struct Request {
    factory_id: FactoryId,
    operation_id: OperationId,
    fields: HashSet<FieldName>,
    recipients: Vec<OrganisationId>,
    tools: Vec<ToolId>,
}

/// Reports and newest values of one unit of ingest, written together at its end.
#[derive(Default)]
pub(super) struct ReportCollector {
    requests: HashMap<(OperationNetworkId, String), Option<Arc<Request>>>,
    reports: Vec<NewReport>,
    values: HashMap<FieldKey, CurrentValue>,
}

impl ReportCollector {
    /// Collects the reports of one message and forwards them to the tools of their requests.
    pub(super) async fn collect(
        &mut self,
        unit: &mut IngestUnit<'_>,
        factory: &FactoryId,
        incoming: &Incoming,
        reports: &[IncomingReport],
        message: &NetworkMessage,
    ) -> Result<(), StoreError> {
        let mut forwarded: HashMap<ToolId, Vec<usize>> = HashMap::new();
        for report in reports {
            let request = self.request(unit, &report.request).await?;
            if let Some(asked) = request.as_ref().filter(|asked| asked.factory_id != *factory) {
                let address = LogicalAddress::FactoryIngress(factory.clone());
                let reason =
                    format!("The request {} is asked of {}.", report.request, asked.factory_id);
                // This report alone: the others of the message answer requests of the factory
                // itself.
                unit.reject(&address, incoming, "FOREIGN_REQUEST", reason).await?;
                continue;
            }
            let Some(is_newest) = count(unit, factory, incoming, report).await? else { continue };
            let mut key = report.request.clone();
            if let Some(request) = request {
                key.operation_id = request.operation_id.clone();
                unit.effects.networks.insert(key.operation_network_id.clone());
                for tool in &request.tools {
                    forwarded.entry(tool.clone()).or_default().push(report.position);
                }
                let fields = self.collect_values(&request, &key, incoming, report);
                // Open pages show the present; what arrives late is in the history.
                if is_newest && !request.recipients.is_empty() {
                    let (request_key, factory_id) = (key.clone(), factory.clone());
                    let event = LiveEvent::Value { request: request_key, factory_id, fields };
                    unit.effects.notifications.push(event.to(request.recipients.clone()));
                }
            } else {
                metrics::counter!("verbund_unasked_reports_total").increment(1);
            }
            self.reports.push(new_report(factory, key, incoming, report));
        }
        for (tool, positions) in forwarded {
            forward(unit, tool, &incoming.message_id, message, &positions).await?;
        }
        Ok(())
    }

    /// Forgets the requests read so far, because one was added.
    pub(super) fn forget_requests(&mut self) {
        self.requests.clear();
    }

    /// Writes reports and values.
    pub(super) async fn write(self, unit: &mut IngestUnit<'_>) -> Result<(), StoreError> {
        unit.effects.reports = self.reports.len() as u64;
        unit.work.reports().add(&self.reports).await?;
        let values: Vec<CurrentValue> = self.values.into_values().collect();
        unit.work.fields().put_values(&values).await
    }

    async fn request(
        &mut self,
        unit: &mut IngestUnit<'_>,
        request: &RequestKey,
    ) -> Result<Option<Arc<Request>>, StoreError> {
        let key =
            (request.operation_network_id.clone(), request.dynamic_data_request_id.to_string());
        if let Some(known) = self.requests.get(&key) {
            return Ok(known.clone());
        }
        let read = match unit.work.fields().asked(&key.0, &key.1).await? {
            None => None,
            Some((factory_id, operation_id, fields)) => Some(Arc::new(Request {
                factory_id,
                operation_id,
                fields: fields.into_iter().collect(),
                recipients: unit.work.recipients().of_request(&key.0, &key.1).await?,
                tools: unit.work.tools().of_request(&key.0, &key.1).await?,
            })),
        };
        self.requests.insert(key, read.clone());
        Ok(read)
    }

    /// Retains of each field the value with the highest epoch and sequence number. Returns all
    /// values of the report as pages show them.
    fn collect_values(
        &mut self,
        request: &Request,
        key: &RequestKey,
        incoming: &Incoming,
        report: &IncomingReport,
    ) -> Vec<FieldUpdate> {
        let mut notifications = Vec::with_capacity(report.fields.len());
        for (name, value) in &report.fields {
            let Some(name) = request.fields.get(name.as_str()) else { continue };
            let candidate = current_value(key.field(name.clone()), value, incoming, report);
            notifications.push(field_update(&candidate));
            let order = |value: &CurrentValue| (value.epoch, value.sequence);
            match self.values.get_mut(&candidate.key) {
                Some(newest) if order(newest) > order(&candidate) => {}
                Some(newest) => *newest = candidate,
                None => drop(self.values.insert(candidate.key.clone(), candidate)),
            }
        }
        notifications
    }
}

/// Adds a report to its writer's sequence. Returns none for a repeat, else whether the report is
/// the newest of its writer.
async fn count(
    unit: &mut IngestUnit<'_>,
    factory: &FactoryId,
    incoming: &Incoming,
    report: &IncomingReport,
) -> Result<Option<bool>, StoreError> {
    let writer = unit.writer(factory, report.data_set_writer_id, report.epoch).await?;
    // For a repeat as well: its sender may have missed the receipt.
    writer.needs_receipt = true;
    if !writer.sequences.add(report.sequence) {
        writer.duplicates += 1;
        unit.effects.duplicates += 1;
        return Ok(None);
    }
    writer.received += 1;
    writer.last_report_at = Some(incoming.received_at);
    writer.operation_network_id = Some(report.request.operation_network_id.to_string());
    writer.dynamic_data_request_id = Some(report.request.dynamic_data_request_id.to_string());
    let is_newest = writer.sequences.through() == Some(report.sequence);
    unit.heard(factory).report_at = Some(incoming.received_at);
    Ok(Some(is_newest))
}

/// Forwards to a tool the data set messages at `positions`.
async fn forward(
    unit: &mut IngestUnit<'_>,
    tool: ToolId,
    id: &MessageId,
    message: &NetworkMessage,
    positions: &[usize],
) -> Result<(), StoreError> {
    let address = LogicalAddress::ToolReports(tool);
    if unit.work.outgoing().waiting(&address).await? >= TOOL_BACKLOG_MAX {
        metrics::counter!("verbund_tool_reports_dropped_total").increment(1);
        return Ok(());
    }
    let messages = positions.iter().filter_map(|position| message.messages.get(*position));
    let part = NetworkMessage {
        message_id: Some(id.clone()),
        messages: messages.cloned().collect(),
        ..message.clone()
    };
    unit.send(address, id.clone(), "ua-data", None, encode(&part, Encoding::Digicor)).await
}

fn new_report(
    factory: &FactoryId,
    request: RequestKey,
    incoming: &Incoming,
    report: &IncomingReport,
) -> NewReport {
    let fields = report.fields.iter().map(|(name, value)| (name.clone(), value.into())).collect();
    NewReport {
        factory_id: factory.clone(),
        data_set_writer_id: report.data_set_writer_id,
        epoch: report.epoch,
        sequence: report.sequence,
        request,
        report_name: report.report_name.clone(),
        shopfloor_timestamp: report.shopfloor_timestamp,
        report_timestamp: report.report_timestamp,
        received_at: incoming.received_at,
        is_replay: incoming.is_replay,
        fields,
    }
}

fn field_update(value: &CurrentValue) -> FieldUpdate {
    FieldUpdate {
        key: value.key.clone(),
        value: value.value.clone(),
        status: value.status.to_string(),
        source_timestamp: value.source_timestamp,
        report_timestamp: value.report_timestamp,
        received_at: value.received_at,
        epoch: value.epoch,
        sequence: value.sequence,
    }
}

fn current_value(
    key: FieldKey,
    value: &DataValue,
    incoming: &Incoming,
    report: &IncomingReport,
) -> CurrentValue {
    CurrentValue {
        key,
        epoch: report.epoch,
        sequence: report.sequence,
        value: value_json(&value.value),
        built_in_type: value.value.built_in_type().map_or(0, BuiltInType::id),
        status: value.status,
        source_timestamp: value.source_timestamp,
        report_timestamp: report.report_timestamp,
        received_at: incoming.received_at,
    }
}
