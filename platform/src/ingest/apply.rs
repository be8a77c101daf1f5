//! What received messages do to the store, within one unit of work.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::{
    DataValue, DateTime, FactoryId, FieldKey, FieldName, MessageId, OperationId, OperationNetworkId, OrganisationId,
    RequestKey, ToolId,
    messages::{Acknowledgement, AcknowledgementResult, Decision, DecisionTarget, FactoryMessage, Gap},
    pubsub::{
        DataSetMetaData, NetworkMessage,
        json::{Encoding, encode},
    },
};
use messaging::LogicalAddress;

use super::{
    decode::{Content, Incoming, IncomingReport},
    leases::Signs,
};
use crate::{
    clock::new_message_id,
    leases::FactoryLease,
    live::{LiveEvent, News, ValueNews},
    networks::{Author, ChangeError, add_request},
    plain::{data_value, plain},
    store::{
        CurrentValue, Heard, NewComment, NewDeadLetter, NewInboxMessage, NewOutgoing, NewReport, PartState, Scope,
        StoreError, Work, WriterKey, WriterRow,
    },
    tools::{DataRequestMessage, ToolAcknowledgement},
};

/// What a unit of work did, to be told after its commit.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// To tell pages.
    pub(super) news: Vec<News>,
    /// Whether messages wait to be sent.
    pub(super) has_outgoing: bool,
    /// Metadata that decoding needs from now on.
    pub(super) meta_data: Vec<((FactoryId, u16), DataSetMetaData)>,
    /// Factories of which something arrived.
    pub(super) heard: HashMap<FactoryId, Heard>,
    /// Networks whose progress may have changed.
    pub(super) networks: HashSet<OperationNetworkId>,
    /// Reports stored.
    pub(super) reports: u64,
    /// Repeats discarded.
    pub(super) duplicates: u64,
    /// Dead letters by code.
    pub(super) dead_letters: Vec<&'static str>,
}

/// What is asked by a request, as far as ingest needs it.
struct Asked {
    factory_id: FactoryId,
    operation_id: OperationId,
    fields: HashSet<FieldName>,
    recipients: Vec<OrganisationId>,
    tools: Vec<ToolId>,
}

/// Rows waiting in the outbox for one tool beyond which reports are no longer forwarded: the tool reads the history.
const TOOL_BACKLOG_MAX: u64 = 10_000;

/// Applies batches of messages to the store; what it has read it remembers until the end of the work.
pub(super) struct Applier<'w> {
    pub(super) work: &'w mut Work,
    pub(super) now: DateTime,
    resend_after: std::time::Duration,
    pub(super) effects: Effects,
    pub(super) signs: &'w Signs,
    pub(super) leases: HashMap<FactoryId, Option<FactoryLease>>,
    asked: HashMap<(OperationNetworkId, String), Option<Arc<Asked>>>,
    writers: HashMap<WriterKey, WriterRow>,
    reports: Vec<NewReport>,
    values: HashMap<FieldKey, CurrentValue>,
    pub(super) heard: HashMap<FactoryId, Heard>,
}

impl<'w> Applier<'w> {
    pub(super) fn new(work: &'w mut Work, now: DateTime, resend_after: std::time::Duration, signs: &'w Signs) -> Self {
        Self {
            work,
            now,
            resend_after,
            effects: Effects::default(),
            signs,
            leases: HashMap::new(),
            asked: HashMap::new(),
            writers: HashMap::new(),
            reports: Vec::new(),
            values: HashMap::new(),
            heard: HashMap::new(),
        }
    }

    /// Applies a batch of one address, in its order.
    pub(super) async fn batch(&mut self, address: &LogicalAddress, batch: &[Incoming]) -> Result<(), StoreError> {
        let mut usable = Vec::with_capacity(batch.len());
        for message in batch {
            if self.may_speak(address, message).await? {
                usable.push(message);
            }
        }
        let kept_ones = usable.iter().filter(|message| is_kept(&message.content));
        let rows: Vec<NewInboxMessage> = kept_ones.map(|message| kept(message)).collect();
        let mut new = self.work.inbox().store(&address.to_string(), &rows).await?;
        for message in usable {
            if let Some(factory) = address.factory_id() {
                let heard = self.heard.entry(factory.clone()).or_default();
                heard.at = heard.at.max(Some(message.received_at));
            }
            // The first of several with one id takes it out, so that repeats within the batch are discarded, too.
            if is_kept(&message.content) && !new.remove(&message.message_id) {
                self.repeat(address, message).await?;
                continue;
            }
            self.message(address, message).await?;
        }
        Ok(())
    }

    /// Writes what was collected.
    pub(super) async fn finish(mut self) -> Result<Effects, StoreError> {
        self.effects.reports = self.reports.len() as u64;
        self.work.reports().add(&self.reports).await?;
        let values: Vec<CurrentValue> = self.values.into_values().collect();
        self.work.fields().put_values(&values).await?;
        for writer in self.writers.values() {
            self.work.writers().put(writer).await?;
        }
        for (factory, heard) in &self.heard {
            self.work.factories().heard(factory, heard).await?;
        }
        self.effects.heard = self.heard;
        Ok(self.effects)
    }

    /// A message that was stored before: its reports are receipted again, for the receipt may have been lost.
    async fn repeat(&mut self, address: &LogicalAddress, message: &Incoming) -> Result<(), StoreError> {
        self.effects.duplicates += 1;
        if let (Some(factory), Content::Reports { reports, .. }) = (address.factory_id(), &message.content) {
            for report in reports {
                let writer = self.writer(factory, report.data_set_writer_id, report.epoch).await?;
                writer.duplicates += 1;
                writer.needs_receipt = true;
            }
        }
        Ok(())
    }

    async fn message(&mut self, address: &LogicalAddress, incoming: &Incoming) -> Result<(), StoreError> {
        match (&incoming.content, address.factory_id()) {
            (Content::Reports { reports, keep_alives, message }, Some(factory)) => {
                for (writer, epoch) in keep_alives {
                    self.writer(factory, *writer, *epoch).await?.last_keep_alive_at = Some(incoming.received_at);
                }
                self.reports_of(factory, incoming, reports, message).await
            }
            (Content::MetaData(writer, meta_data), Some(factory)) => {
                let key = (factory.clone(), *writer);
                self.work.meta_data().put(factory, *writer, incoming.received_at, &incoming.body).await?;
                self.effects.meta_data.push((key, (**meta_data).clone()));
                Ok(())
            }
            (Content::Status(state), Some(factory)) => {
                self.heard.entry(factory.clone()).or_default().publisher_state = Some(state.name());
                Ok(())
            }
            (Content::Factory(message), Some(_)) => self.factory_message(address, incoming, message).await,
            (Content::DataRequest(request), _) => self.data_request(request).await,
            (Content::Dead(letter), _) => self.dead(letter).await,
            _ => Ok(()),
        }
    }

    async fn reports_of(
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
                let reason = format!("The request {} is asked of {}.", report.request, asked.factory_id);
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
            writer.dynamic_data_request_id = Some(report.request.dynamic_data_request_id.to_string());
            let is_newest = writer.sequences.through() == Some(report.sequence);
            self.heard.entry(factory.clone()).or_default().report_at = Some(incoming.received_at);
            let shown: serde_json::Map<_, _> =
                report.fields.iter().map(|(name, value)| (name.clone(), data_value(value))).collect();
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
                    let event =
                        LiveEvent::Value { request: request.clone(), factory_id: factory.clone(), fields: news };
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

    /// Keeps of each field the value with the highest epoch and sequence; all values as pages show them.
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
            messages: positions.iter().filter_map(|position| message.messages.get(*position)).cloned().collect(),
            ..message.clone()
        };
        self.send(address, id.clone(), "ua-data", None, encode(&part, Encoding::Digicor)).await
    }

    async fn factory_message(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
        message: &FactoryMessage,
    ) -> Result<(), StoreError> {
        match message {
            FactoryMessage::Acknowledgement(acknowledgement) => self.acknowledgement(acknowledgement).await,
            FactoryMessage::Decision(decision) => self.decision(decision).await,
            FactoryMessage::Gap(gap) => self.gap(gap).await,
            FactoryMessage::Comment(comment) => {
                let network = self.work.networks().lookup(&Scope::Platform, &comment.operation_network_id).await?;
                let parts = self.work.parts().of_network(&comment.operation_network_id).await?;
                let has_part = parts.iter().any(|part| part.factory_id == comment.factory_id);
                let Some(network) = network.filter(|_| has_part) else {
                    let reason = format!("{} has no part in {}.", comment.factory_id, comment.operation_network_id);
                    return self.refuse_from(address, incoming, "UNKNOWN_NETWORK", reason).await;
                };
                let new = NewComment {
                    operation_network_id: comment.operation_network_id.clone(),
                    factory_id: comment.factory_id.clone(),
                    dynamic_data_request_id: comment.dynamic_data_request_id.clone(),
                    field_name: comment.field_name.clone(),
                    author_id: comment.author_id.chars().take(200).collect(),
                    is_from_factory: true,
                    text: comment.text.chars().take(10_000).collect(),
                    created_at: incoming.received_at,
                };
                let comment_id = self.work.comments().add(&new).await?;
                let members = self.members(&network.collaboration_id).await?;
                let operation_network_id = comment.operation_network_id.clone();
                self.effects.news.push(LiveEvent::Comment { operation_network_id, comment_id }.to(members));
                Ok(())
            }
            FactoryMessage::AssetOffer(offer) => self.work.meta_data().put_offer(offer, incoming.received_at).await,
            // Answered before anything else of its batch.
            FactoryMessage::LeaseRequest(_) => Ok(()),
        }
    }

    async fn acknowledgement(&mut self, answer: &Acknowledgement) -> Result<(), StoreError> {
        let network = answer.operation_network_id.as_ref();
        let part = self.work.parts().of_answer(&answer.factory_id, &answer.correlation_id, network).await?;
        let Some(mut part) = part else { return Ok(()) };
        let is_for_this = part.message_id == answer.correlation_id || answer.revision == Some(part.revision);
        // An answer to an older revision says nothing of the one in effect; one that repeats says nothing new.
        if !is_for_this || (part.state != PartState::Sent && answer.result == AcknowledgementResult::Unchanged) {
            return Ok(());
        }
        part.state = match answer.result {
            AcknowledgementResult::Accepted => PartState::Accepted,
            AcknowledgementResult::Unchanged => PartState::Unchanged,
            AcknowledgementResult::Rejected => PartState::Rejected,
        };
        part.fault_list.clone_from(&answer.fault_list);
        part.acknowledged_at = Some(self.now);
        self.work.parts().put(&part).await?;
        let row = self.work.networks().lookup(&Scope::Platform, &part.operation_network_id).await?;
        let Some(row) = row else { return Ok(()) };
        let members = self.members(&row.collaboration_id).await?;
        let event = LiveEvent::Part {
            operation_network_id: part.operation_network_id,
            factory_id: part.factory_id,
            revision: part.revision,
            state: part.state,
            fault_list: part.fault_list,
        };
        self.effects.news.push(event.to(members));
        Ok(())
    }

    async fn decision(&mut self, decision: &Decision) -> Result<(), StoreError> {
        let DecisionTarget::Field { operation_network_id, operation_id, dynamic_data_request_id, field_name } =
            &decision.target
        else {
            return Ok(());
        };
        let request = RequestKey {
            operation_network_id: operation_network_id.clone(),
            operation_id: operation_id.clone(),
            dynamic_data_request_id: dynamic_data_request_id.clone(),
        };
        let key = request.field(field_name.clone());
        if !self.work.fields().decide(&key, decision).await? {
            return Ok(());
        }
        let concerned = self.work.fields().concerned(operation_network_id, dynamic_data_request_id.as_str()).await?;
        let event = LiveEvent::Decision {
            key,
            mapping_state: decision.mapping_state,
            reason: decision.reason.clone(),
            decided_at: decision.decided_at,
        };
        self.effects.news.push(event.to(concerned));
        Ok(())
    }

    async fn gap(&mut self, gap: &Gap) -> Result<(), StoreError> {
        let writer = self.writer(&gap.factory_id, gap.data_set_writer_id, gap.epoch).await?;
        writer.sequences.add_range(gap.first_sequence, gap.last_sequence);
        writer.needs_receipt = true;
        self.work.writers().add_gap(gap, self.now).await
    }

    /// A tool's request becomes a request of its organisation, or an answer says why not.
    async fn data_request(&mut self, message: &DataRequestMessage) -> Result<(), StoreError> {
        let Some(tool) = self.work.tools().lookup(&Scope::Platform, &message.tool_id).await? else { return Ok(()) };
        let author = Author::tool(&tool.tool_id, tool.organisation_id, self.now);
        let mut request = message.dynamic_data_request.clone();
        request.dynamic_data_request_publisher_id = Some(message.tool_id.clone());
        let (network, operation) = (&message.operation_network_id, &message.operation_id);
        let added = add_request(self.work, network, operation, request, &author, self.resend_after).await;
        let (result, revision, fault_list) = match added {
            Ok(outcome) => {
                self.asked.clear();
                self.effects.news.extend(outcome.news);
                self.effects.has_outgoing = true;
                let result = match outcome.is_changed {
                    true => AcknowledgementResult::Accepted,
                    false => AcknowledgementResult::Unchanged,
                };
                (result, Some(outcome.revision), Vec::new())
            }
            Err(ChangeError::Store(error)) => return Err(error),
            Err(ChangeError::Faulty(faults)) => (AcknowledgementResult::Rejected, None, faults),
            Err(error) => {
                let fault = asi_model::messages::Fault {
                    pointer: String::new(),
                    code: "NOT_POSSIBLE".to_owned(),
                    message: format!("{error}."),
                };
                (AcknowledgementResult::Rejected, None, vec![fault])
            }
        };
        let answer = ToolAcknowledgement {
            message_type: "acknowledgement",
            message_id: new_message_id(),
            tool_id: message.tool_id.clone(),
            correlation_id: message.message_id.clone(),
            operation_network_id: network.clone(),
            revision,
            result,
            fault_list,
        };
        let body = serde_json::to_vec(&answer).expect("an acknowledgement has text keys only");
        let address = LogicalAddress::ToolReports(message.tool_id.clone());
        let correlation = Some(message.message_id.clone());
        self.send(address, answer.message_id.clone(), "acknowledgement", correlation, body).await
    }

    async fn send(
        &mut self,
        address: LogicalAddress,
        message_id: MessageId,
        subject: &str,
        correlation_id: Option<MessageId>,
        body: Vec<u8>,
    ) -> Result<(), StoreError> {
        self.effects.has_outgoing = true;
        let message = NewOutgoing {
            address,
            message_id,
            subject: subject.to_owned(),
            correlation_id,
            created_at: self.now,
            time_to_live: None,
            content_encoding: None,
            body: body.into(),
        };
        self.work.outbox().add(&message).await
    }

    pub(super) async fn refuse(
        &mut self,
        factory: &FactoryId,
        incoming: &Incoming,
        code: &'static str,
        reason: String,
    ) -> Result<(), StoreError> {
        self.refuse_from(&LogicalAddress::FactoryIngress(factory.clone()), incoming, code, reason).await
    }

    async fn refuse_from(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
        code: &'static str,
        reason: String,
    ) -> Result<(), StoreError> {
        let letter = NewDeadLetter {
            address: address.to_string(),
            message_id: Some(incoming.message_id.to_string()),
            subject: incoming.message_type.clone(),
            code,
            reason,
            received_at: incoming.received_at,
            body: incoming.body.clone().into_bytes(),
            content_encoding: None,
        };
        self.dead(&letter).await
    }

    async fn dead(&mut self, letter: &NewDeadLetter) -> Result<(), StoreError> {
        tracing::warn!(address = letter.address, code = letter.code, "A message is of no use and was set aside.");
        self.effects.dead_letters.push(letter.code);
        self.work.dead_letters().add(letter).await
    }

    async fn members(&mut self, id: &asi_model::CollaborationId) -> Result<Vec<OrganisationId>, StoreError> {
        let collaboration = self.work.collaborations().lookup(&Scope::Platform, id).await?;
        Ok(collaboration.map(|collaboration| collaboration.members).unwrap_or_default())
    }

    async fn writer(&mut self, factory: &FactoryId, id: u16, epoch: u32) -> Result<&mut WriterRow, StoreError> {
        let key = WriterKey { factory_id: factory.clone(), data_set_writer_id: id, epoch };
        if !self.writers.contains_key(&key) {
            let row = self.work.writers().lookup(&key).await?.unwrap_or_else(|| WriterRow::new(key.clone()));
            self.writers.insert(key.clone(), row);
        }
        Ok(self.writers.entry(key.clone()).or_insert_with(|| WriterRow::new(key)))
    }

    async fn asked(&mut self, request: &RequestKey) -> Result<Option<Arc<Asked>>, StoreError> {
        let key = (request.operation_network_id.clone(), request.dynamic_data_request_id.to_string());
        if let Some(known) = self.asked.get(&key) {
            return Ok(known.clone());
        }
        let asked = match self.work.fields().asked(&key.0, &key.1).await? {
            None => None,
            Some((factory_id, operation_id, fields)) => Some(Arc::new(Asked {
                factory_id,
                operation_id,
                fields: fields.into_iter().collect(),
                recipients: self.work.recipients().of_request(&key.0, &key.1).await?,
                tools: self.work.tools().of_request(&key.0, &key.1).await?,
            })),
        };
        self.asked.insert(key, asked.clone());
        Ok(asked)
    }
}

/// Messages whose repeats are discarded by id: all that have a lasting effect.
const fn is_kept(content: &Content) -> bool {
    match content {
        Content::Reports { reports, .. } => !reports.is_empty(),
        Content::MetaData(..) | Content::Factory(_) | Content::DataRequest(_) => true,
        Content::Status(_) | Content::Unknown | Content::Dead(_) => false,
    }
}

fn kept(message: &Incoming) -> NewInboxMessage {
    NewInboxMessage {
        message_id: message.message_id.clone(),
        message_type: message.message_type.clone(),
        received_at: message.received_at,
        body: message.body.clone(),
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

fn current_value(key: FieldKey, value: &DataValue, incoming: &Incoming, report: &IncomingReport) -> CurrentValue {
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
