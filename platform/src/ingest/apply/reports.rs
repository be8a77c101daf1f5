//! What reports do: each number once, the newest value of each field, and what tools are to have.

use std::collections::HashMap;

use asi_model::{
    DataValue, FactoryId, FieldKey, MessageId, RequestKey, ToolId,
    pubsub::{
        NetworkMessage,
        json::{Encoding, encode},
    },
};
use messaging::LogicalAddress;

use super::{Applier, Asked};
use crate::{
    ingest::decode::{Incoming, IncomingReport},
    live::{LiveEvent, ValueNews},
    plain::{data_value, plain},
    store::{CurrentValue, NewReport, StoreError},
};

/// Rows waiting in the outbox for one tool beyond which reports are no longer forwarded: the tool
/// reads the history.
const TOOL_BACKLOG_MAX: u64 = 10_000;

impl Applier<'_> {
    pub(super) async fn reports_of(
        &mut self,
        factory: &FactoryId,
        incoming: &Incoming,
        reports: &[IncomingReport],
        message: &NetworkMessage,
    ) -> Result<(), StoreError> {
        let mut forwarded: HashMap<ToolId, Vec<usize>> = HashMap::new();
        for report in reports {
            let asked = self.asked(&report.request).await?;
            if let Some(asked) = asked.as_ref().filter(|asked| asked.factory_id != *factory) {
                let reason =
                    format!("The request {} is asked of {}.", report.request, asked.factory_id);
                self.refuse(factory, incoming, "FOREIGN_REQUEST", reason).await?;
                continue;
            }
            let writer = self.writer(factory, report.data_set_writer_id, report.epoch).await?;
            writer.needs_receipt = true;
            if !writer.sequences.add(report.sequence) {
                writer.duplicates += 1;
                self.effects.duplicates += 1;
                continue;
            }
            writer.received += 1;
            writer.last_report_at = Some(incoming.received_at);
            writer.operation_network_id = Some(report.request.operation_network_id.to_string());
            writer.dynamic_data_request_id =
                Some(report.request.dynamic_data_request_id.to_string());
            let is_newest = writer.sequences.through() == Some(report.sequence);
            self.heard.entry(factory.clone()).or_default().report_at = Some(incoming.received_at);
            let shown: serde_json::Map<_, _> = report
                .fields
                .iter()
                .map(|(name, value)| (name.clone(), data_value(value)))
                .collect();
            let shown = serde_json::Value::Object(shown);
            let mut request = report.request.clone();
            if let Some(asked) = asked {
                request.operation_id = asked.operation_id.clone();
                let news = self.collect_values(&asked, &request, incoming, report);
                self.effects.networks.insert(request.operation_network_id.clone());
                for tool in &asked.tools {
                    forwarded.entry(tool.clone()).or_default().push(report.position);
                }
                if is_newest && !asked.recipients.is_empty() {
                    let event = LiveEvent::Value {
                        request: request.clone(),
                        factory_id: factory.clone(),
                        fields: news,
                    };
                    self.effects.news.push(event.to(asked.recipients.clone()));
                }
            } else {
                metrics::counter!("verbund_unasked_reports_total").increment(1);
            }
            self.reports.push(NewReport {
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
                fields: shown,
            });
        }
        for (tool, positions) in forwarded {
            self.forward(tool, &incoming.message_id, message, &positions).await?;
        }
        Ok(())
    }

    /// Keeps of each field the value with the highest epoch and sequence; all values as pages show
    /// them.
    fn collect_values(
        &mut self,
        asked: &Asked,
        request: &RequestKey,
        incoming: &Incoming,
        report: &IncomingReport,
    ) -> Vec<ValueNews> {
        let mut news = Vec::with_capacity(report.fields.len());
        for (name, value) in &report.fields {
            let Some(name) = asked.fields.get(name.as_str()) else { continue };
            let candidate = current_value(request.field(name.clone()), value, incoming, report);
            news.push(value_news(&candidate));
            let order = |value: &CurrentValue| (value.epoch, value.sequence);
            match self.values.get_mut(&candidate.key) {
                Some(held) if order(held) > order(&candidate) => {}
                Some(held) => *held = candidate,
                None => drop(self.values.insert(candidate.key.clone(), candidate)),
            }
        }
        news
    }

    /// Hands a tool those parts of a message that it may have.
    async fn forward(
        &mut self,
        tool: ToolId,
        id: &MessageId,
        message: &NetworkMessage,
        positions: &[usize],
    ) -> Result<(), StoreError> {
        let address = LogicalAddress::ToolReports(tool);
        if self.work.outbox().waiting(&address).await? >= TOOL_BACKLOG_MAX {
            metrics::counter!("verbund_tool_reports_dropped_total").increment(1);
            return Ok(());
        }
        let part = NetworkMessage {
            message_id: Some(id.clone()),
            messages: positions
                .iter()
                .filter_map(|position| message.messages.get(*position))
                .cloned()
                .collect(),
            ..message.clone()
        };
        self.send(address, id.clone(), "ua-data", None, encode(&part, Encoding::Digicor)).await
    }
}

fn value_news(value: &CurrentValue) -> ValueNews {
    ValueNews {
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
        value: plain(&value.value),
        built_in_type: value.value.built_in_type().map_or(0, asi_model::BuiltInType::id),
        status: value.status,
        source_timestamp: value.source_timestamp,
        report_timestamp: report.report_timestamp,
        received_at: incoming.received_at,
    }
}
