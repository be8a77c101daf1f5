//! One unit of ingest: a transaction, its effects, and what all kinds of messages write.

use std::{
    collections::{HashMap, HashSet},
    fmt::Display,
    time::Duration,
};

use access_log::{AccessKind, AgentKind};
use asi_model::{
    DateTime, FactoryId, MessageId, OperationNetworkId, OrganisationId, ToolId,
    messages::{LedgerCosignature, PlatformMessage},
    pubsub::DataSetMetaData,
};
use messaging::LogicalAddress;

use super::{
    dead_letter::dead_letter,
    decode::{Incoming, IncomingReport},
};
use crate::{
    accesses::{Contents, Reader, Reading},
    clock::new_opaque_id,
    live::Notification,
    store::{
        AuditAgent, AuditAgentKind, AuditFact, AuditOutcome, AuditSubject, Heard, Holder,
        NewAuditEntry, NewDeadLetter, NewOutgoing, Scope, StoreError, Work, WriterKey, WriterRow,
    },
    tools::ToolAcknowledgement,
};

/// Share of a factory or tool in the dead letters.
const DEAD_LETTERS: &str = "dead_letters";
/// Step of the times at which other members learn that a factory lives.
const SIGN_STEP: Duration = Duration::from_secs(60);

/// Effects of a unit, to be published after its commit.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// Events for pages.
    pub(super) notifications: Vec<Notification>,
    /// True when messages wait to be sent.
    pub(super) has_outgoing: bool,
    /// Metadata that decoding needs from now on.
    pub(super) meta_data: Vec<((FactoryId, u16), DataSetMetaData)>,
    /// Factories from which something arrived.
    pub(super) heard: HashMap<FactoryId, Heard>,
    /// Networks whose progress may have changed.
    pub(super) networks: HashSet<OperationNetworkId>,
    /// Number of reports stored.
    pub(super) reports: u64,
    /// Number of repeats discarded.
    pub(super) duplicates: u64,
    /// Values that leave for tools by messages of this unit.
    pub(super) forwarded: Vec<Reading>,
    /// Code of each dead letter.
    pub(super) dead_letters: Vec<&'static str>,
    /// Shares that were used up, each with the factory or tool whose it was.
    pub(super) refusals: Vec<(&'static str, Holder)>,
}

impl Effects {
    /// Notes that a share of a factory or tool was used up.
    pub(super) fn refused(&mut self, share: &'static str, sender: impl Into<Option<Holder>>) {
        self.refusals.extend(sender.into().map(|sender| (share, sender)));
    }
}

/// A transaction with the rows that several messages change; those are written once, at the end.
pub(super) struct IngestUnit<'w> {
    pub(super) work: &'w mut Work,
    pub(super) now: DateTime,
    pub(super) effects: Effects,
    writers: HashMap<WriterKey, WriterRow>,
    heard: HashMap<FactoryId, Heard>,
    /// Factories that were asked about, each true if it says to whom it releases its reports.
    naming: HashMap<FactoryId, bool>,
    /// Organisations of factories that changed something.
    organisations: HashMap<FactoryId, Option<OrganisationId>>,
}

impl<'w> IngestUnit<'w> {
    pub(super) fn new(work: &'w mut Work, now: DateTime) -> Self {
        Self {
            work,
            now,
            effects: Effects::default(),
            writers: HashMap::new(),
            heard: HashMap::new(),
            naming: HashMap::new(),
            organisations: HashMap::new(),
        }
    }

    /// Writes the collected rows and returns the effects.
    pub(super) async fn finish(mut self) -> Result<Effects, StoreError> {
        for writer in self.writers.values() {
            self.work.writers().put(writer).await?;
        }
        for (factory, heard) in &self.heard {
            self.work.factories().heard(factory, heard).await?;
        }
        self.effects.heard = self.heard;
        Ok(self.effects)
    }

    /// Returns the evidence of life of a factory, to be updated.
    pub(super) fn heard(&mut self, factory: &FactoryId) -> &mut Heard {
        self.heard.entry(factory.clone()).or_default()
    }

    /// Records that something of the factory arrived.
    pub(super) fn record_arrival(&mut self, factory: &FactoryId, received_at: DateTime) {
        let heard = self.heard(factory);
        heard.at = heard.at.max(Some(received_at));
    }

    /// Records a sign of the factory's life that does not follow values, so that it may be known to
    /// members that receive none.
    pub(super) fn record_sign(&mut self, factory: &FactoryId, received_at: DateTime) {
        self.record_arrival(factory, received_at);
        let heard = self.heard(factory);
        heard.sign_at = heard.sign_at.max(Some(received_at.floor_to(SIGN_STEP)));
    }

    /// Puts on record what a factory changed of what others see. Reports, which are kept themselves, are no such
    /// change, nor are their metadata, gaps and checkpoints.
    pub(super) async fn record_change(
        &mut self,
        factory: &FactoryId,
        operation: &'static str,
        path: String,
        facts: &[AuditFact],
    ) -> Result<(), StoreError> {
        let organisation_id = self.organisation_of(factory).await?;
        let subject = AuditSubject { path, concerned: organisation_id.clone() };
        let (kind, name) = (AuditAgentKind::Factory, factory.to_string());
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: self.now,
            agent: &AuditAgent { kind, name, organisation_id, is_administrator: false },
            operation,
            subject: &subject,
            outcome: AuditOutcome::Done,
            facts,
        };
        self.work.audit().add(&entry).await
    }

    async fn organisation_of(
        &mut self,
        factory: &FactoryId,
    ) -> Result<Option<OrganisationId>, StoreError> {
        if let Some(known) = self.organisations.get(factory) {
            return Ok(known.clone());
        }
        let known = self.work.factories().lookup(&Scope::Platform, factory).await?;
        let organisation = known.map(|known| known.organisation_id);
        self.organisations.insert(factory.clone(), organisation.clone());
        Ok(organisation)
    }

    /// Notes that a factory says to whom it releases its reports.
    pub(super) async fn record_naming(&mut self, factory: &FactoryId) -> Result<(), StoreError> {
        if !self.names_recipients(factory).await? {
            self.work.factories().named_recipients(factory, self.now).await?;
            self.naming.insert(factory.clone(), true);
        }
        Ok(())
    }

    async fn names_recipients(&mut self, factory: &FactoryId) -> Result<bool, StoreError> {
        if let Some(known) = self.naming.get(factory) {
            return Ok(*known);
        }
        let is_naming = self.work.factories().names_recipients(factory).await?;
        self.naming.insert(factory.clone(), is_naming);
        Ok(is_naming)
    }

    /// Returns to whom a factory released a report; `None` where it never says so. Once it did, a
    /// report that does not is for nobody: the list may have been taken out on the way.
    pub(super) async fn released_to<'r>(
        &mut self,
        factory: &FactoryId,
        report: &'r IncomingReport,
    ) -> Result<Option<&'r [OrganisationId]>, StoreError> {
        if let Some(named) = &report.released_to {
            self.record_naming(factory).await?;
            return Ok(Some(named));
        }
        Ok(self.names_recipients(factory).await?.then_some(&[]))
    }

    /// Returns the row of a data set writer, to be updated.
    pub(super) async fn writer(
        &mut self,
        factory: &FactoryId,
        id: u16,
        epoch: u32,
    ) -> Result<&mut WriterRow, StoreError> {
        let key = WriterKey { factory_id: factory.clone(), data_set_writer_id: id, epoch };
        if !self.writers.contains_key(&key) {
            let stored = self.work.writers().lookup(&key).await?;
            let row = stored.unwrap_or_else(|| WriterRow::new(key.clone()));
            self.writers.insert(key.clone(), row);
        }
        Ok(self.writers.entry(key.clone()).or_insert_with(|| WriterRow::new(key)))
    }

    /// Returns true for a data set writer of which a row is stored, or will be by this unit.
    pub(super) async fn knows_writer(
        &mut self,
        factory: &FactoryId,
        id: u16,
        epoch: u32,
    ) -> Result<bool, StoreError> {
        let key = WriterKey { factory_id: factory.clone(), data_set_writer_id: id, epoch };
        if self.writers.contains_key(&key) {
            return Ok(true);
        }
        let stored = self.work.writers().lookup(&key).await?;
        let is_known = stored.is_some();
        // Read once: a message that needs the writer changes this row.
        self.writers.extend(stored.map(|row| (key, row)));
        Ok(is_known)
    }

    /// Returns network and request of the last report of a writer's epoch; `None` before its first.
    pub(super) async fn reported_about(
        &mut self,
        key: &WriterKey,
    ) -> Result<Option<(String, String)>, StoreError> {
        let row = match self.writers.get(key) {
            Some(row) => Some(row.clone()),
            None => self.work.writers().lookup(key).await?,
        };
        Ok(row.and_then(|row| row.operation_network_id.zip(row.dynamic_data_request_id)))
    }

    /// Adds the answer to a tool's message.
    pub(super) async fn answer(&mut self, answer: &ToolAcknowledgement) -> Result<(), StoreError> {
        let body = serde_json::to_vec(answer).expect("an acknowledgement has text keys only");
        let address = LogicalAddress::ToolReports(answer.tool_id.clone());
        let (id, correlation) = (answer.message_id.clone(), Some(answer.correlation_id.clone()));
        self.send(address, id, "acknowledgement", correlation, body).await
    }

    /// Adds the answer to a checkpoint of a factory's ledger.
    pub(super) async fn cosign(&mut self, answer: LedgerCosignature) -> Result<(), StoreError> {
        let address = LogicalAddress::FactoryRequests(answer.factory_id.clone());
        let (id, correlation) = (answer.message_id.clone(), Some(answer.correlation_id.clone()));
        let answer = PlatformMessage::LedgerCosignature(answer);
        let body = serde_json::to_vec(&answer).expect("messages have text keys only");
        self.send(address, id, answer.message_type(), correlation, body).await
    }

    /// Adds a message that brings values to a tool of an organisation. Who commits the unit records
    /// them as forwarded in the same transaction.
    pub(super) async fn forward(
        &mut self,
        tool: ToolId,
        organisation: OrganisationId,
        contents: Vec<Contents>,
        message_id: MessageId,
        body: Vec<u8>,
    ) -> Result<(), StoreError> {
        let reader = Reader {
            organisation_id: organisation,
            kind: AgentKind::Tool,
            name: tool.to_string(),
            role: None,
        };
        self.effects.forwarded.extend(contents.into_iter().map(|contents| Reading {
            reader: reader.clone(),
            kind: AccessKind::Forwarded,
            contents,
            since: self.now,
        }));
        self.send(LogicalAddress::ToolReports(tool), message_id, "ua-data", None, body).await
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
        self.work.outgoing().add(&message).await
    }

    /// Makes a decoded message a dead letter.
    pub(super) async fn reject(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
        code: &'static str,
        reason: String,
    ) -> Result<(), StoreError> {
        let letter = NewDeadLetter {
            message_id: Some(incoming.message_id.to_string()),
            subject: incoming.message_type.clone(),
            ..dead_letter(address, &incoming.envelope, incoming.received_at, code, reason)
        };
        self.add_dead_letter(&letter).await
    }

    /// Makes a message a dead letter that writes under a request which was never the factory's.
    pub(super) async fn reject_foreign(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
        factory: &FactoryId,
        request: impl Display,
    ) -> Result<(), StoreError> {
        let reason = format!("{factory} was never asked for {request}.");
        self.reject(address, incoming, "FOREIGN_REQUEST", reason).await
    }

    pub(super) async fn add_dead_letter(
        &mut self,
        letter: &NewDeadLetter,
    ) -> Result<(), StoreError> {
        tracing::warn!(
            address = letter.address,
            code = letter.code,
            "A message is of no use and was set aside."
        );
        self.effects.dead_letters.push(letter.code);
        if self.work.dead_letters().add(letter).await? > 0 {
            let address: Option<LogicalAddress> = letter.address.parse().ok();
            self.effects.refused(DEAD_LETTERS, address.and_then(|address| Holder::of(&address)));
        }
        Ok(())
    }
}
