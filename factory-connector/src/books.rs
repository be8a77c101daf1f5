//! The books: everything the connector knows about networks, decisions and values, in memory.
//!
//! The books are pure. A method takes an input and the time, changes what is in memory, notes what
//! the store must write in the same transaction ([`Changes`]) and what is to be done once that is
//! committed ([`Aftermath`]). If the commit fails, the desk throws the books away and loads them
//! from the store again.

mod aftermath;
mod decisions;
mod field;
mod fields;
mod mappings;
mod operator;
mod policies;
#[cfg(test)]
mod policy_tests;
mod requests;
mod revocation;
mod rules;
mod sharing;
mod spool;
#[cfg(test)]
pub(crate) mod tests;
mod traffic;
mod validity;
mod values;
mod wanted;
mod withholding;
mod writer;

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

use asi_model::{
    DateTime, FactoryId, FieldKey, MessageId, OperationNetworkId, OrganisationId, RequestKey,
    messages::{FactoryMessage, OperationNetworkMessage},
    pubsub::json::Encoding,
};
use uuid::Uuid;

pub use aftermath::{Aftermath, ConnectorEvent, Decisions, FieldNews, MappingWork, TwinWork};
pub use decisions::{DecisionError, Verdict};
pub use field::{Field, FieldDecision, Marks};
pub use fields::Fields;
pub use mappings::{Misfit, Placed, Placing, Shadow, Shelf};
pub use operator::EntryOutcome;
pub use policies::{DocumentError, RecipientPolicy};
pub(crate) use revocation::Progress;
pub use rules::RuleOffer;
pub use traffic::Traffic;
pub use validity::Validity;
pub use writer::Writer;

use crate::{
    operator::{Journal, OperationKey},
    store::{Changes, ControlRow, Snapshot, StoreError, WaitingRow},
};
use disclosure::{DocumentId, NamedPolicy, Rule, Versioned};
use ledger::{Event, Heads, SequenceRange};

/// A network as it stands.
#[derive(Debug, Clone)]
pub struct Network {
    /// Its revision, or that of its withdrawal.
    pub revision: u64,
    /// As received; `None` once withdrawn.
    pub message: Option<Arc<OperationNetworkMessage>>,
    /// When.
    pub received_at: DateTime,
}

/// How the books are kept.
#[derive(Debug, Clone)]
pub struct BooksConfig {
    /// Whose they are.
    pub factory_id: FactoryId,
    /// How reports are written.
    pub encoding: Encoding,
}

/// Everything in memory.
pub struct Books {
    pub(crate) config: BooksConfig,
    pub(crate) networks: BTreeMap<OperationNetworkId, Network>,
    pub(crate) fields: Fields,
    pub(crate) writers: BTreeMap<u16, Writer>,
    pub(crate) writer_of: HashMap<RequestKey, u16>,
    /// What people entered, per operation.
    pub(crate) journals: HashMap<OperationKey, Journal>,
    pub(crate) heads: Heads,
    pub(crate) checkpoint: Option<(u64, DateTime)>,
    /// Writers whose data set has news.
    pub(crate) dirty_writers: BTreeSet<u16>,
    /// Writers about whose fields something was decided in this transaction, and when.
    pub(crate) changed_writers: BTreeMap<u16, DateTime>,
    /// Fields whose gate or transform state has to be written, by number; each has a mark of it, so
    /// that it stands here once.
    pub(crate) dirty_fields: Vec<i64>,
    /// When gates want to be asked again, by the fields' numbers.
    pub(crate) due: BTreeSet<(DateTime, i64)>,
    /// Which fields' gates look at a field's state.
    pub(crate) watchers: HashMap<FieldKey, BTreeSet<FieldKey>>,
    /// Named policies in their newest version.
    pub(crate) policies: BTreeMap<DocumentId, Versioned<NamedPolicy>>,
    /// Standing rules in their newest version.
    pub(crate) rules: BTreeMap<DocumentId, Versioned<Rule>>,
    /// The policies set for recipients.
    pub(crate) recipient_policies: BTreeMap<OrganisationId, RecipientPolicy>,
    pub(crate) last_rule_decision: i64,
    /// When the next mapped field's request ends, at the earliest.
    pub(crate) next_expiry: Option<DateTime>,
    /// Fields with a value that came before their request asks for it, by when it does.
    pub(crate) beginnings: BTreeSet<(DateTime, FieldKey)>,
    pub(crate) shared: sharing::Shared,
    pub(crate) last_row: i64,
    pub(crate) last_field: i64,
    pub(crate) changes: Changes,
    pub(crate) aftermath: Aftermath,
    /// Consents that ended in this transaction.
    pub(crate) ended: Vec<revocation::EndedConsents>,
    /// Several consents are being ended with one receipt.
    is_ending_together: bool,
    /// Writers whose waiting reports have to be taken back before the commit, and why.
    pub(crate) purges: BTreeMap<u16, asi_model::messages::GapCause>,
}

impl Books {
    /// The books as stored.
    ///
    /// # Errors
    /// [`StoreError::Unreadable`] where a stored document cannot be understood.
    pub fn new(
        config: BooksConfig,
        snapshot: Snapshot,
        is_restored: bool,
        now: DateTime,
    ) -> Result<Self, StoreError> {
        let mut books = Self {
            config,
            networks: BTreeMap::new(),
            fields: Fields::default(),
            writers: BTreeMap::new(),
            writer_of: HashMap::new(),
            journals: HashMap::new(),
            heads: snapshot.heads,
            checkpoint: snapshot.last_checkpoint,
            dirty_writers: BTreeSet::new(),
            changed_writers: BTreeMap::new(),
            dirty_fields: Vec::new(),
            due: BTreeSet::new(),
            watchers: HashMap::new(),
            policies: keyed(snapshot.policies),
            rules: keyed(snapshot.rules),
            recipient_policies: snapshot.recipient_policies.into_iter().collect(),
            last_rule_decision: snapshot.last_rule_decision,
            next_expiry: None,
            beginnings: BTreeSet::new(),
            shared: sharing::Shared::default(),
            last_row: snapshot.last_row,
            last_field: 0,
            changes: Changes::default(),
            aftermath: Aftermath::default(),
            ended: Vec::new(),
            is_ending_together: false,
            purges: BTreeMap::new(),
        };
        for stored in snapshot.networks {
            let network = Network {
                revision: stored.revision,
                message: stored.message.map(Arc::new),
                received_at: stored.received_at,
            };
            books.networks.insert(stored.operation_network_id, network);
        }
        for entry in snapshot.operator_entries {
            books.journals.entry(entry.operation.clone()).or_default().insert(entry);
        }
        for (id, row) in snapshot.writers {
            books.load_writer(id, row);
        }
        let mut shelf = snapshot.mappings;
        for (row, value) in snapshot.fields {
            let (newest, shadow) = (shelf.versions.remove(&row.id), shelf.shadows.remove(&row.id));
            let key = row.key.clone();
            books.load_field(row, value, now)?;
            if let Some(field) = books.fields.get_mut(&key) {
                field.shelf = Self::load_shelf(newest, field.decision.mapping.as_deref(), shadow)?;
            }
        }
        books.watch_after_load(now);
        if is_restored {
            tracing::warn!(
                "The store was restored, moved or copied; every data set writer begins a new epoch."
            );
            books.changes.are_epochs_begun = true;
            let writers: Vec<u16> = books.writer_of.values().copied().collect();
            for writer in writers {
                books.begin_epoch(writer, now);
            }
        }
        books.show_everything();
        Ok(books)
    }

    /// What the store has to write, and what is to be done after it.
    pub fn take(&mut self) -> (Changes, Aftermath) {
        self.refresh_writers();
        let mut aftermath = std::mem::take(&mut self.aftermath);
        if aftermath.decisions.count > 0 {
            aftermath.events.push(ConnectorEvent::Decisions(aftermath.decisions));
        }
        (std::mem::take(&mut self.changes), aftermath)
    }

    /// There is something to write that must not wait for the publishing interval.
    #[must_use]
    pub fn has_urgent_changes(&self) -> bool {
        !self.changes.is_empty() || !self.purges.is_empty() || !self.changed_writers.is_empty()
    }

    /// The next number in the spool.
    pub(crate) const fn next_row(&mut self) -> i64 {
        self.last_row += 1;
        self.last_row
    }

    /// A request's document, while its network is active.
    #[must_use]
    pub fn request(
        &self,
        key: &RequestKey,
    ) -> Option<(&Arc<OperationNetworkMessage>, &asi_model::network::DynamicDataRequest)> {
        let message = self.networks.get(&key.operation_network_id)?.message.as_ref()?;
        let operation = message
            .operation_network
            .operation_list
            .iter()
            .find(|operation| operation.operation_id == key.operation_id)?;
        let request = operation
            .dynamic_data_request_list
            .iter()
            .find(|request| request.dynamic_data_request_id == key.dynamic_data_request_id)?;
        Some((message, request))
    }

    /// Queues a control message.
    pub(crate) fn send(
        &mut self,
        message: &FactoryMessage,
        correlation_id: Option<MessageId>,
        now: DateTime,
    ) {
        let body =
            serde_json::to_string(message).expect("messages have text keys and finite numbers");
        let row = ControlRow {
            id: self.next_row(),
            message_id: message.message_id().clone(),
            subject: message.message_type().to_owned(),
            correlation_id,
            body,
            created_at: now,
            ttl_ms: None,
        };
        self.changes.controls.push(row);
        self.aftermath.is_spool_filled = true;
    }

    /// Writes an event into the chains of all recipients.
    pub(crate) fn record(
        &mut self,
        recipients: &[OrganisationId],
        now: DateTime,
        report: Option<i64>,
        event: &Event,
    ) {
        for recipient in recipients {
            let entry = self.heads.append(recipient, now, event.clone());
            self.changes.ledger.push((entry, report));
        }
    }

    /// Writes what became of reports into the chains of their recipients, neighbouring sequence
    /// numbers in one entry.
    pub(crate) fn record_outcome(
        &mut self,
        rows: &[WaitingRow],
        now: DateTime,
        outcome: impl Fn(SequenceRange) -> Event,
    ) {
        let mut sorted: Vec<&WaitingRow> = rows.iter().collect();
        sorted.sort_by_key(|kept| (kept.row.data_set_writer_id, kept.row.epoch, kept.row.sequence));
        let mut ranges: Vec<(SequenceRange, &[OrganisationId])> = Vec::new();
        for kept in sorted {
            let row = &kept.row;
            match ranges.last_mut() {
                Some((range, recipients))
                    if range.data_set_writer_id == row.data_set_writer_id
                        && range.epoch == row.epoch
                        && range.last_sequence.checked_add(1) == Some(row.sequence)
                        && *recipients == &kept.recipients[..] =>
                {
                    range.last_sequence = row.sequence;
                }
                _ => ranges.push((
                    range_of(row.data_set_writer_id, row.epoch, row.sequence),
                    &kept.recipients,
                )),
            }
        }
        for (range, recipients) in ranges {
            self.record(recipients, now, None, &outcome(range));
        }
    }
}

fn keyed<T>(documents: Vec<Versioned<T>>) -> BTreeMap<DocumentId, Versioned<T>> {
    documents.into_iter().map(|document| (document.key.id.clone(), document)).collect()
}

/// The range of a single sequence number.
pub(crate) const fn range_of(data_set_writer_id: u16, epoch: u32, sequence: u32) -> SequenceRange {
    SequenceRange { data_set_writer_id, epoch, first_sequence: sequence, last_sequence: sequence }
}

/// A message id of our own, ordered by time.
#[must_use]
pub fn new_message_id() -> MessageId {
    MessageId::from(Uuid::now_v7())
}
