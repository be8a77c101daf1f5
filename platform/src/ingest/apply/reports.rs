//! Reports: each sequence number once, the newest value of each field, and forwarding to tools.

use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
};

use asi_model::{
    BuiltInType, DataValue, DynamicDataRequestId, FactoryId, FieldKey, FieldName, MessageId,
    OperationId, OperationNetworkId, OrganisationId, RequestKey, ToolId,
    messages::{Decision, MappingState},
    plain_value::value_json,
    pubsub::{
        NetworkMessage,
        json::{Encoding, encode},
    },
};
use messaging::LogicalAddress;

use super::from_factories::decided_field;
use crate::{
    accesses::Contents,
    entitlement::entitled,
    ingest::{
        decode::{Incoming, IncomingReport},
        quota_arbiter::GAPS,
        unit::IngestUnit,
    },
    live::{FieldUpdate, LiveEvent},
    store::{
        AskedField, CurrentValue, DecisionEffect, Holder, NewReport, Recipient, RecipientSetId,
        ReleasedRange, StoreError, WriterRow,
    },
};

/// Messages waiting for one tool beyond which reports are no longer forwarded; the tool can still
/// read the history.
const TOOL_BACKLOG_MAX: u64 = 10_000;

/// A dynamic data request as far as ingest needs it.
struct Request {
    /// The factories that were ever asked, each with the operation that it was about.
    asked: Vec<(FactoryId, OperationId)>,
    /// The fields in effect; none once the request is gone.
    fields: HashMap<FieldName, AskedField>,
    recipients: Vec<Recipient>,
    /// Reports that were released afterwards to recipients that were added.
    released: Vec<ReleasedRange>,
    tools: Vec<(ToolId, OrganisationId)>,
}

impl Request {
    fn was_asked(&self, factory: &FactoryId, operation: &OperationId) -> bool {
        self.asked.iter().any(|(asked, about)| asked == factory && about == operation)
    }

    /// Returns the recipients in effect to which a report was released after it had left.
    fn released_to<'r>(
        &'r self,
        factory: &'r FactoryId,
        report: &'r IncomingReport,
    ) -> impl Iterator<Item = &'r OrganisationId> {
        let recipients = self.recipients.iter().map(|recipient| &recipient.organisation_id);
        recipients.filter(move |recipient| {
            self.released.iter().any(|released| {
                released.organisation_id == **recipient
                    && released.factory_id == *factory
                    && released.operation_id == report.request.operation_id
                    && released.contains(report.data_set_writer_id, report.epoch, report.sequence)
            })
        })
    }

    /// Returns the field that a factory is asked for at present.
    fn field(
        &self,
        report: &IncomingReport,
        factory: &FactoryId,
        name: &str,
    ) -> Option<&AskedField> {
        self.fields.get(name).filter(|field| {
            field.factory_id == *factory && field.operation_id == report.request.operation_id
        })
    }

    /// Returns true where a factory is asked at present for what a report is about.
    fn is_asked(&self, factory: &FactoryId, report: &IncomingReport) -> bool {
        self.fields.values().any(|field| {
            field.factory_id == *factory && field.operation_id == report.request.operation_id
        })
    }
}

/// Reports and newest values of one unit of ingest, written together at its end.
#[derive(Default)]
pub(super) struct ReportCollector {
    requests: HashMap<(OperationNetworkId, DynamicDataRequestId), Arc<Request>>,
    recipient_sets: HashMap<BTreeSet<OrganisationId>, Option<RecipientSetId>>,
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
        let mut forwarded: HashMap<(ToolId, OrganisationId), Vec<&IncomingReport>> = HashMap::new();
        let mut foreign = None;
        for report in reports {
            let request = self.request(unit, &report.request).await?;
            if !request.was_asked(factory, &report.request.operation_id) {
                // This report alone: the others of the message may answer requests of the factory.
                if take(unit, factory, report).await?.is_some() {
                    foreign = Some(&report.request);
                }
                continue;
            }
            let Some(is_newest) = count(unit, factory, incoming, report).await? else { continue };
            let from = Sender { factory, incoming, is_newest };
            let entitled = self.store(unit, &request, &from, report).await?;
            let tools = request.tools.iter().filter(|(_, of)| entitled.contains(of));
            for tool in tools.filter(|_| request.is_asked(factory, report)) {
                forwarded.entry(tool.clone()).or_default().push(report);
            }
        }
        if let Some(request) = foreign {
            let address = LogicalAddress::FactoryIngress(factory.clone());
            unit.reject_foreign(&address, incoming, factory, request).await?;
        }
        for (tool, reports) in forwarded {
            forward(unit, tool, factory, &incoming.message_id, message, &reports).await?;
        }
        Ok(())
    }

    /// Forgets the requests read so far, because one was added or a revision answered.
    pub(super) fn forget_requests(&mut self) {
        self.requests.clear();
    }

    /// Follows a decision: a value that was collected for a field which is no longer open is no
    /// current one, and neither is one of before the field was opened.
    pub(super) fn decided(&mut self, decision: &Decision, effect: DecisionEffect) {
        if effect == DecisionEffect::Ignored {
            return;
        }
        self.requests.clear();
        let Some(key) = decided_field(decision) else { return };
        let is_from_before = |value: &CurrentValue| {
            value.report_timestamp.is_none_or(|reported| reported < decision.decided_at)
        };
        if decision.mapping_state != MappingState::Mapped
            || (effect == DecisionEffect::Opened
                && self.values.get(&key).is_some_and(is_from_before))
        {
            self.values.remove(&key);
        }
    }

    /// Writes reports and values.
    pub(super) async fn write(self, unit: &mut IngestUnit<'_>) -> Result<(), StoreError> {
        unit.effects.reports = self.reports.len() as u64;
        unit.work.reports().add(&self.reports).await?;
        let values: Vec<CurrentValue> = self.values.into_values().collect();
        unit.work.fields().put_values(&values).await
    }

    /// Collects a report with its values, and returns the organisations that may read it.
    async fn store(
        &mut self,
        unit: &mut IngestUnit<'_>,
        request: &Request,
        from: &Sender<'_>,
        report: &IncomingReport,
    ) -> Result<BTreeSet<OrganisationId>, StoreError> {
        let reported_at = report.report_timestamp.or(report.shopfloor_timestamp);
        let released_to = unit.released_to(from.factory, report).await?;
        let mut entitled = entitled(&request.recipients, released_to, reported_at);
        entitled.extend(request.released_to(from.factory, report).cloned());
        let recipient_set = self.recipient_set(unit, &entitled).await?;
        if request.is_asked(from.factory, report) {
            unit.effects.networks.insert(report.request.operation_network_id.clone());
            let fields = self.collect_values(request, from, report, recipient_set);
            // Open pages show the present; what arrives late is in the history.
            if from.is_newest && !entitled.is_empty() && !fields.is_empty() {
                let (request, factory_id) = (report.request.clone(), from.factory.clone());
                let event = LiveEvent::Value { request, factory_id, fields };
                unit.effects.notifications.push(event.to(entitled.iter().cloned().collect()));
            }
        } else {
            metrics::counter!("verbund_unasked_reports_total").increment(1);
        }
        self.reports.push(new_report(from, report, recipient_set));
        Ok(entitled)
    }

    async fn request(
        &mut self,
        unit: &mut IngestUnit<'_>,
        request: &RequestKey,
    ) -> Result<Arc<Request>, StoreError> {
        let key = (request.operation_network_id.clone(), request.dynamic_data_request_id.clone());
        if let Some(known) = self.requests.get(&key) {
            return Ok(Arc::clone(known));
        }
        let fields = unit.work.fields().asked(&key.0, &key.1).await?;
        let read = Arc::new(Request {
            asked: unit.work.asked_requests().of_request(&key.0, &key.1).await?,
            fields: fields.into_iter().map(|field| (field.field_name.clone(), field)).collect(),
            recipients: unit.work.recipients().of_request(&key.0, &key.1).await?,
            released: unit.work.past_releases().of_request(&key.0, &key.1).await?,
            tools: unit.work.tools().of_request(&key.0, &key.1).await?,
        });
        self.requests.insert(key, Arc::clone(&read));
        Ok(read)
    }

    async fn recipient_set(
        &mut self,
        unit: &mut IngestUnit<'_>,
        members: &BTreeSet<OrganisationId>,
    ) -> Result<Option<RecipientSetId>, StoreError> {
        if let Some(known) = self.recipient_sets.get(members) {
            return Ok(*known);
        }
        let id = unit.work.recipient_sets().intern(members).await?;
        self.recipient_sets.insert(members.clone(), id);
        Ok(id)
    }

    /// Retains of each field the value with the highest epoch and sequence number. Returns the
    /// values of the fields that are open, as pages show them.
    fn collect_values(
        &mut self,
        request: &Request,
        from: &Sender<'_>,
        report: &IncomingReport,
        recipient_set: Option<RecipientSetId>,
    ) -> Vec<FieldUpdate> {
        let mut notifications = Vec::with_capacity(report.fields.len());
        for (name, value) in &report.fields {
            let Some(field) = request.field(report, from.factory, name) else { continue };
            let key = report.request.field(field.field_name.clone());
            let candidate = current_value(key, value, from.incoming, report, recipient_set);
            if field.is_mapped {
                notifications.push(FieldUpdate::from(&candidate));
            }
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

/// A factory with a message of its own.
struct Sender<'m> {
    factory: &'m FactoryId,
    incoming: &'m Incoming,
    /// True for the newest report of its writer.
    is_newest: bool,
}

/// Takes a report's number into its writer's sequence, so that the connector is receipted; none for
/// a repeat.
async fn take<'u>(
    unit: &'u mut IngestUnit<'_>,
    factory: &FactoryId,
    report: &IncomingReport,
) -> Result<Option<&'u mut WriterRow>, StoreError> {
    let (id, epoch, sequence) = (report.data_set_writer_id, report.epoch, report.sequence);
    let writer = unit.writer(factory, id, epoch).await?;
    let (key, coarse) = (writer.key.clone(), writer.sequences.coarse_through());
    // Where holes were too many to count each, the store says what is held.
    let is_held = writer.sequences.is_uncertain(sequence)
        && unit.work.reports().is_held(&key, sequence).await?;
    let writer = unit.writer(factory, id, epoch).await?;
    let is_new = if is_held { writer.repeat(sequence) } else { writer.take(sequence) };
    if writer.sequences.coarse_through() != coarse {
        unit.effects.refused(GAPS, Holder::Factory(factory.clone()));
    }
    if !is_new {
        unit.effects.duplicates += 1;
        return Ok(None);
    }
    unit.writer(factory, id, epoch).await.map(Some)
}

/// Adds a report to its writer's sequence. Returns none for a repeat, else whether the report is
/// the newest of its writer.
async fn count(
    unit: &mut IngestUnit<'_>,
    factory: &FactoryId,
    incoming: &Incoming,
    report: &IncomingReport,
) -> Result<Option<bool>, StoreError> {
    let Some(writer) = take(unit, factory, report).await? else { return Ok(None) };
    writer.last_report_at = Some(incoming.received_at);
    writer.operation_network_id = Some(report.request.operation_network_id.to_string());
    writer.dynamic_data_request_id = Some(report.request.dynamic_data_request_id.to_string());
    let is_newest = writer.sequences.through() == Some(report.sequence);
    unit.heard(factory).report_at = Some(incoming.received_at);
    Ok(Some(is_newest))
}

/// Forwards to a tool of an organisation the data set messages of these reports.
async fn forward(
    unit: &mut IngestUnit<'_>,
    (tool, organisation): (ToolId, OrganisationId),
    factory: &FactoryId,
    id: &MessageId,
    message: &NetworkMessage,
    reports: &[&IncomingReport],
) -> Result<(), StoreError> {
    let address = LogicalAddress::ToolReports(tool.clone());
    // What is released while it has no access it never gets.
    if unit.work.revoked_access().of(&address).await?.is_some() {
        return Ok(());
    }
    if unit.work.outgoing().waiting(&address).await? >= TOOL_BACKLOG_MAX {
        metrics::counter!("verbund_tool_reports_dropped_total").increment(1);
        return Ok(());
    }
    let contents = Contents::gather(reports.iter().flat_map(|report| {
        let reported_at = report.report_timestamp.or(report.shopfloor_timestamp);
        report.fields.iter().map(move |(name, value)| {
            (factory, &report.request, name.as_str(), value.source_timestamp.or(reported_at))
        })
    }));
    let messages = reports.iter().filter_map(|report| message.messages.get(report.position));
    let part = NetworkMessage {
        message_id: Some(id.clone()),
        messages: messages.cloned().collect(),
        ..message.clone()
    };
    let body = encode(&part, Encoding::Digicor);
    unit.forward(tool, organisation, contents, id.clone(), body).await
}

fn new_report(
    from: &Sender<'_>,
    report: &IncomingReport,
    recipient_set: Option<RecipientSetId>,
) -> NewReport {
    let fields = report.fields.iter().map(|(name, value)| (name.clone(), value.into())).collect();
    NewReport {
        factory_id: from.factory.clone(),
        data_set_writer_id: report.data_set_writer_id,
        epoch: report.epoch,
        sequence: report.sequence,
        request: report.request.clone(),
        report_name: report.report_name.clone(),
        shopfloor_timestamp: report.shopfloor_timestamp,
        report_timestamp: report.report_timestamp,
        received_at: from.incoming.received_at,
        is_replay: from.incoming.envelope.replay,
        recipient_set,
        fields,
    }
}

fn current_value(
    key: FieldKey,
    value: &DataValue,
    incoming: &Incoming,
    report: &IncomingReport,
    recipient_set: Option<RecipientSetId>,
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
        recipient_set,
    }
}
