//! What others ask of the desk.

use asi_model::{
    DataValue, DateTime, FieldKey, StatusCode,
    messages::{Comment, ValueSource},
};
use mapping_engine::Mapping;
use messaging::{Delivery, RowOutcome, Settlement};
use tokio::sync::{mpsc, oneshot};
use uuid::Uuid;

use crate::{
    books::{Books, DecisionError, EntryOutcome, Placing, Verdict},
    operator::OperatorEntry,
    outbox::Departure,
    store::{SourceRow, TemplateRow},
};
use disclosure::GateOutcome;

/// Why the desk did not do what was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeskError {
    /// The decision cannot be taken.
    #[error(transparent)]
    Decision(#[from] DecisionError),
    /// Nothing was changed since it could not be written.
    #[error("it could not be written to disk; nothing was changed")]
    NotWritten,
    /// The connector is stopping.
    #[error("the connector is stopping")]
    Stopped,
}

/// What became of a value that a person or an OPC UA client brought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Taken {
    /// It went through the gate.
    Through(GateOutcome),
    /// It was not taken.
    Not(StatusCode),
}

pub(crate) type Reading = Box<dyn FnOnce(&Books) + Send>;
/// Tells whoever asked, once it is known whether the change was written.
pub(crate) type Told = Box<dyn FnOnce(bool) + Send>;
pub(crate) type Changing = Box<dyn FnOnce(&mut Books, DateTime) -> Told + Send>;

/// Asks the desk.
pub enum Command {
    #[doc(hidden)]
    Deliver(Vec<Delivery>, oneshot::Sender<Vec<Settlement>>),
    #[doc(hidden)]
    Outcomes(Vec<RowOutcome>, Vec<Departure>, oneshot::Sender<bool>),
    #[doc(hidden)]
    Value(FieldKey, ValueSource, DataValue, oneshot::Sender<Result<Taken, DeskError>>),
    #[doc(hidden)]
    Decide(Box<DecideCommand>, oneshot::Sender<Result<(), DeskError>>),
    #[doc(hidden)]
    Enter(Vec<OperatorEntry>, oneshot::Sender<Result<Vec<EntryOutcome>, DeskError>>),
    #[doc(hidden)]
    Revoke(Box<RevokeCommand>, oneshot::Sender<Result<Uuid, DeskError>>),
    #[doc(hidden)]
    Comment(Comment, oneshot::Sender<bool>),
    #[doc(hidden)]
    PutSource(SourceRow, oneshot::Sender<bool>),
    #[doc(hidden)]
    RemoveSource(String, oneshot::Sender<bool>),
    #[doc(hidden)]
    Place(Vec<Placing>, oneshot::Sender<bool>),
    #[doc(hidden)]
    Shadow(Box<ShadowCommand>, oneshot::Sender<Result<(), DeskError>>),
    #[doc(hidden)]
    PutTemplate(TemplateRow, oneshot::Sender<bool>),
    #[doc(hidden)]
    RemoveTemplate(String, oneshot::Sender<bool>),
    #[doc(hidden)]
    Read(Reading),
    #[doc(hidden)]
    Change(Changing),
}

pub struct RevokeCommand {
    pub(super) fields: Vec<FieldKey>,
    pub(super) verdict: Verdict,
    pub(super) reason: Option<String>,
    pub(super) revoked_by: String,
}

pub struct DecideCommand {
    pub(super) field: FieldKey,
    pub(super) verdict: Verdict,
    pub(super) reason: Option<String>,
    pub(super) decided_by: String,
}

pub struct ShadowCommand {
    pub(super) field: FieldKey,
    pub(super) mapping: Option<Mapping>,
    pub(super) author: String,
}

/// An answer that is given when the transaction is committed, or has failed.
pub(super) enum Reply {
    Settle(Vec<Settlement>, oneshot::Sender<Vec<Settlement>>),
    Value(Taken, oneshot::Sender<Result<Taken, DeskError>>),
    Entered(Vec<EntryOutcome>, oneshot::Sender<Result<Vec<EntryOutcome>, DeskError>>),
    Revoked(Uuid, oneshot::Sender<Result<Uuid, DeskError>>),
    Decided(oneshot::Sender<Result<(), DeskError>>),
    Done(oneshot::Sender<bool>),
    Then(Told),
}

impl Reply {
    /// Who asked may have gone meanwhile; that is no concern of ours.
    pub(super) fn give(self, is_written: bool) {
        match self {
            Self::Settle(settlements, reply) => {
                let settlements = if is_written {
                    settlements
                } else {
                    vec![Settlement::Release; settlements.len()]
                };
                reply.send(settlements).ok();
            }
            Self::Value(taken, reply) => {
                reply.send(if is_written { Ok(taken) } else { Err(DeskError::NotWritten) }).ok();
            }
            Self::Entered(outcomes, reply) => {
                reply.send(if is_written { Ok(outcomes) } else { Err(DeskError::NotWritten) }).ok();
            }
            Self::Revoked(id, reply) => {
                reply.send(if is_written { Ok(id) } else { Err(DeskError::NotWritten) }).ok();
            }
            Self::Decided(reply) => {
                reply.send(if is_written { Ok(()) } else { Err(DeskError::NotWritten) }).ok();
            }
            Self::Done(reply) => {
                reply.send(is_written).ok();
            }
            Self::Then(tell) => tell(is_written),
        }
    }
}

/// Speaks to the desk.
#[derive(Clone)]
pub struct DeskHandle {
    commands: mpsc::Sender<Command>,
}

impl DeskHandle {
    pub(super) const fn new(commands: mpsc::Sender<Command>) -> Self {
        Self { commands }
    }

    /// Messages of the platform, in order; answered when their effects are stored.
    pub async fn deliver(&self, deliveries: Vec<Delivery>) -> Vec<Settlement> {
        let count = deliveries.len();
        let answer = self.ask(|reply| Command::Deliver(deliveries, reply)).await;
        answer.unwrap_or_else(|_| vec![Settlement::Release; count])
    }

    /// What became of messages in the spool, and what was in those that left.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn outcomes(
        &self,
        outcomes: Vec<RowOutcome>,
        departures: Vec<Departure>,
    ) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::Outcomes(outcomes, departures, reply)).await?)
    }

    /// A value for a field from a person or an OPC UA client; answered when it is committed.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn value(
        &self,
        field: FieldKey,
        source: ValueSource,
        value: DataValue,
    ) -> Result<Taken, DeskError> {
        self.ask(|reply| Command::Value(field, source, value, reply)).await?
    }

    /// What people entered about operations, in any order; answered when it is committed.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn enter(&self, entries: Vec<OperatorEntry>) -> Result<Vec<EntryOutcome>, DeskError> {
        self.ask(|reply| Command::Enter(entries, reply)).await?
    }

    /// Decides about a field; answered when the decision is committed.
    ///
    /// # Errors
    /// [`DeskError`].
    pub async fn decide(
        &self,
        field: FieldKey,
        verdict: Verdict,
        reason: Option<String>,
        decided_by: &str,
    ) -> Result<(), DeskError> {
        let command =
            Box::new(DecideCommand { field, verdict, reason, decided_by: decided_by.to_owned() });
        self.ask(|reply| Command::Decide(command, reply)).await?
    }

    /// Ends the consent to fields, all or none; answered with the receipt's id when it is
    /// committed.
    ///
    /// # Errors
    /// [`DeskError`].
    pub async fn revoke(
        &self,
        fields: Vec<FieldKey>,
        verdict: Verdict,
        reason: Option<String>,
        revoked_by: &str,
    ) -> Result<Uuid, DeskError> {
        let command =
            Box::new(RevokeCommand { fields, verdict, reason, revoked_by: revoked_by.to_owned() });
        self.ask(|reply| Command::Revoke(command, reply)).await?
    }

    /// Says something to the partners.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn comment(&self, comment: Comment) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::Comment(comment, reply)).await?)
    }

    /// Keeps a source.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn put_source(&self, row: SourceRow) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::PutSource(row, reply)).await?)
    }

    /// Forgets a source.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn remove_source(&self, source_id: String) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::RemoveSource(source_id, reply)).await?)
    }

    /// Places mappings, all or none: see [`Books::place`].
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn place(&self, placings: Vec<Placing>) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::Place(placings, reply)).await?)
    }

    /// Starts, replaces or (without a mapping) ends a field's shadow.
    ///
    /// # Errors
    /// [`DeskError`].
    pub async fn shadow(
        &self,
        field: FieldKey,
        mapping: Option<Mapping>,
        author: &str,
    ) -> Result<(), DeskError> {
        let command = Box::new(ShadowCommand { field, mapping, author: author.to_owned() });
        self.ask(|reply| Command::Shadow(command, reply)).await?
    }

    /// Keeps a template.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn put_template(&self, row: TemplateRow) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::PutTemplate(row, reply)).await?)
    }

    /// Forgets a template.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn remove_template(&self, template_id: String) -> Result<(), DeskError> {
        written(self.ask(|reply| Command::RemoveTemplate(template_id, reply)).await?)
    }

    /// Looks into the books.
    ///
    /// # Errors
    /// [`DeskError::Stopped`].
    pub async fn read<T: Send + 'static>(
        &self,
        look: impl FnOnce(&Books) -> T + Send + 'static,
    ) -> Result<T, DeskError> {
        self.ask(|reply| {
            Command::Read(Box::new(move |books| {
                reply.send(look(books)).ok();
            }))
        })
        .await
    }

    /// Changes the books; answered when everything that follows is committed.
    ///
    /// # Errors
    /// [`DeskError::NotWritten`], [`DeskError::Stopped`].
    pub async fn change<T: Send + 'static>(
        &self,
        change: impl FnOnce(&mut Books, DateTime) -> T + Send + 'static,
    ) -> Result<T, DeskError> {
        let answer = self.ask(|reply| {
            Command::Change(Box::new(move |books, now| {
                let result = change(books, now);
                Box::new(move |is_written| drop(reply.send(is_written.then_some(result))))
            }))
        });
        answer.await?.ok_or(DeskError::NotWritten)
    }

    async fn ask<T>(
        &self,
        command: impl FnOnce(oneshot::Sender<T>) -> Command,
    ) -> Result<T, DeskError> {
        let (reply, answer) = oneshot::channel();
        self.commands.send(command(reply)).await.map_err(|_| DeskError::Stopped)?;
        answer.await.map_err(|_| DeskError::Stopped)
    }
}

fn written(is_written: bool) -> Result<(), DeskError> {
    if is_written { Ok(()) } else { Err(DeskError::NotWritten) }
}
