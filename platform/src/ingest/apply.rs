//! What received messages do to the store, within one unit of work.

mod from_factories;
mod from_tools;
mod reports;

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use asi_model::{
    DateTime, FactoryId, FieldKey, FieldName, MessageId, OperationId, OperationNetworkId,
    OrganisationId, RequestKey, ToolId, pubsub::DataSetMetaData,
};
use messaging::LogicalAddress;

use super::{
    decode::{Content, Incoming},
    leases::Signs,
};
use crate::{
    leases::FactoryLease,
    live::News,
    store::{
        CurrentValue, Heard, NewDeadLetter, NewInboxMessage, NewOutgoing, NewReport, Scope,
        StoreError, Work, WriterKey, WriterRow,
    },
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

/// Applies batches of messages to the store; what it has read it remembers until the end of the
/// work.
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
    pub(super) fn new(
        work: &'w mut Work,
        now: DateTime,
        resend_after: std::time::Duration,
        signs: &'w Signs,
    ) -> Self {
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
    pub(super) async fn batch(
        &mut self,
        address: &LogicalAddress,
        batch: &[Incoming],
    ) -> Result<(), StoreError> {
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
            // The first of several with one id takes it out, so that repeats within the batch are
            // discarded, too.
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

    /// A message that was stored before: its reports are receipted again, for the receipt may have
    /// been lost.
    async fn repeat(
        &mut self,
        address: &LogicalAddress,
        message: &Incoming,
    ) -> Result<(), StoreError> {
        self.effects.duplicates += 1;
        if let (Some(factory), Content::Reports { reports, .. }) =
            (address.factory_id(), &message.content)
        {
            for report in reports {
                let writer = self.writer(factory, report.data_set_writer_id, report.epoch).await?;
                writer.duplicates += 1;
                writer.needs_receipt = true;
            }
        }
        Ok(())
    }

    async fn message(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<(), StoreError> {
        match (&incoming.content, address.factory_id()) {
            (Content::Reports { reports, keep_alives, message }, Some(factory)) => {
                for (writer, epoch) in keep_alives {
                    self.writer(factory, *writer, *epoch).await?.last_keep_alive_at =
                        Some(incoming.received_at);
                }
                self.reports_of(factory, incoming, reports, message).await
            }
            (Content::MetaData(writer, meta_data), Some(factory)) => {
                let key = (factory.clone(), *writer);
                self.work
                    .meta_data()
                    .put(factory, *writer, incoming.received_at, &incoming.body)
                    .await?;
                self.effects.meta_data.push((key, (**meta_data).clone()));
                Ok(())
            }
            (Content::Status(state), Some(factory)) => {
                self.heard.entry(factory.clone()).or_default().publisher_state = Some(state.name());
                Ok(())
            }
            (Content::Factory(message), Some(_)) => {
                self.factory_message(address, incoming, message).await
            }
            (Content::DataRequest(request), _) => self.data_request(request).await,
            (Content::Dead(letter), _) => self.dead(letter).await,
            _ => Ok(()),
        }
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
        self.refuse_from(&LogicalAddress::FactoryIngress(factory.clone()), incoming, code, reason)
            .await
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
        tracing::warn!(
            address = letter.address,
            code = letter.code,
            "A message is of no use and was set aside."
        );
        self.effects.dead_letters.push(letter.code);
        self.work.dead_letters().add(letter).await
    }

    async fn members(
        &mut self,
        id: &asi_model::CollaborationId,
    ) -> Result<Vec<OrganisationId>, StoreError> {
        let collaboration = self.work.collaborations().lookup(&Scope::Platform, id).await?;
        Ok(collaboration.map(|collaboration| collaboration.members).unwrap_or_default())
    }

    async fn writer(
        &mut self,
        factory: &FactoryId,
        id: u16,
        epoch: u32,
    ) -> Result<&mut WriterRow, StoreError> {
        let key = WriterKey { factory_id: factory.clone(), data_set_writer_id: id, epoch };
        if !self.writers.contains_key(&key) {
            let row = self
                .work
                .writers()
                .lookup(&key)
                .await?
                .unwrap_or_else(|| WriterRow::new(key.clone()));
            self.writers.insert(key.clone(), row);
        }
        Ok(self.writers.entry(key.clone()).or_insert_with(|| WriterRow::new(key)))
    }

    async fn asked(&mut self, request: &RequestKey) -> Result<Option<Arc<Asked>>, StoreError> {
        let key =
            (request.operation_network_id.clone(), request.dynamic_data_request_id.to_string());
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
