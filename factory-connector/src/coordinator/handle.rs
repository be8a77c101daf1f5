//! Handle: the way to the coordinator, the same for production and tests.

use asi_model::{DataValue, DateTime, FieldKey, StatusCode, messages::ValueSource};
use connector_state::{
    ChangeSet, ConnectorState, IntoChanges,
    use_cases::{values::write_value, witness::NewLogDecision},
};
use disclosure::GateOutcome;
use messaging::{Delivery, RowOutcome, Settlement};
use tokio::sync::{mpsc, oneshot};

use crate::in_flight::SentMessage;

/// Failure of the coordinator to do what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CoordinatorError {
    /// The transaction failed, so nothing was changed.
    #[error("it could not be written to disk; nothing was changed")]
    NotWritten,
    /// The connector is stopping.
    #[error("the connector is stopping")]
    Stopped,
}

/// Outcome of writing a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WriteOutcome {
    /// The gate took it.
    Accepted(GateOutcome),
    /// The field does not accept it.
    Rejected(StatusCode),
}

/// Function that reads the state between two transactions and keeps its own reply channel.
pub(super) type StateQuery = Box<dyn FnOnce(&ConnectorState) + Send>;
/// Answers the caller, once it is known whether the transaction was committed.
pub(super) type Reply = Box<dyn FnOnce(bool) + Send>;
/// Runs a use case; one that failed has no changes.
pub(super) type UseCase =
    Box<dyn FnOnce(&mut ConnectorState, DateTime) -> (Option<ChangeSet>, Reply) + Send>;

/// Command in the coordinator's queue; only [`CoordinatorHandle`] makes them.
pub struct CoordinatorCommand(pub(super) CommandKind);

/// Kinds of commands, each with the channel of its reply where there is one.
pub(super) enum CommandKind {
    /// Messages of the platform, in order.
    Deliver(Vec<Delivery>, oneshot::Sender<Vec<Settlement>>),
    /// Outcomes of sending, and the messages that were sent.
    RecordOutcomes(Vec<RowOutcome>, Vec<SentMessage>, oneshot::Sender<bool>),
    /// A new log in place of one about which the platform is in conflict. No use case for
    /// `Execute`: it is made of all entries of a chain, which are read from the store.
    BeginLog(NewLogDecision, oneshot::Sender<Option<bool>>),
    /// A question about the state.
    Read(StateQuery),
    Execute(UseCase),
}

/// Sender of commands; clones share one queue.
#[derive(Clone)]
pub struct CoordinatorHandle {
    commands: mpsc::Sender<CoordinatorCommand>,
}

impl CoordinatorHandle {
    pub(super) const fn new(commands: mpsc::Sender<CoordinatorCommand>) -> Self {
        Self { commands }
    }

    /// Delivers messages of the platform, in order. Returns when their effects are committed.
    pub async fn deliver(&self, deliveries: Vec<Delivery>) -> Vec<Settlement> {
        let count = deliveries.len();
        let settlements = self.ask(|reply| CommandKind::Deliver(deliveries, reply)).await;
        settlements.unwrap_or_else(|_| vec![Settlement::Release; count])
    }

    /// Records outcomes of sending, and the messages that were sent.
    ///
    /// # Errors
    /// [`CoordinatorError`].
    pub async fn record_outcomes(
        &self,
        outcomes: Vec<RowOutcome>,
        sent: Vec<SentMessage>,
    ) -> Result<(), CoordinatorError> {
        let is_written =
            self.ask(|reply| CommandKind::RecordOutcomes(outcomes, sent, reply)).await?;
        if is_written { Ok(()) } else { Err(CoordinatorError::NotWritten) }
    }

    /// Writes a value of a person or an OPC UA client. Returns when it is committed.
    ///
    /// # Errors
    /// [`CoordinatorError`].
    pub async fn write_value(
        &self,
        field: FieldKey,
        source: ValueSource,
        value: DataValue,
    ) -> Result<WriteOutcome, CoordinatorError> {
        self.execute(move |state, now| {
            let written = write_value(state, &field, source, value, now);
            let outcome = written.map_or_else(WriteOutcome::Rejected, WriteOutcome::Accepted);
            // The transaction collects what the gate released. A rejected value waits for it, too:
            // one that came before its request is valid is kept in the field.
            (outcome, ChangeSet::default())
        })
        .await
    }

    /// Begins a new log in place of one about which the platform is in conflict. Returns when it is
    /// committed; false where there is no conflict.
    ///
    /// # Errors
    /// [`CoordinatorError`].
    pub async fn begin_log(&self, decision: NewLogDecision) -> Result<bool, CoordinatorError> {
        let is_begun = self.ask(|reply| CommandKind::BeginLog(decision, reply)).await?;
        is_begun.ok_or(CoordinatorError::NotWritten)
    }

    /// Reads the state.
    ///
    /// # Errors
    /// [`CoordinatorError::Stopped`].
    pub async fn read<T: Send + 'static>(
        &self,
        query: impl FnOnce(&ConnectorState) -> T + Send + 'static,
    ) -> Result<T, CoordinatorError> {
        self.ask(|reply| CommandKind::Read(Box::new(move |state| drop(reply.send(query(state))))))
            .await
    }

    /// Executes a use case. Returns its result when its changes are committed.
    ///
    /// # Errors
    /// [`CoordinatorError`]; then nothing was changed.
    pub async fn execute<R: IntoChanges>(
        &self,
        use_case: impl FnOnce(&mut ConnectorState, DateTime) -> R + Send + 'static,
    ) -> Result<R::Value, CoordinatorError>
    where
        R::Value: Send + 'static,
    {
        let answer = self.ask(|reply| {
            CommandKind::Execute(Box::new(move |state, now| {
                let (value, changes) = use_case(state, now).into_changes();
                // The caller may have dropped its receiver.
                let reply: Reply =
                    Box::new(move |is_written| drop(reply.send(is_written.then_some(value))));
                (changes, reply)
            }))
        });
        answer.await?.ok_or(CoordinatorError::NotWritten)
    }

    async fn ask<T>(
        &self,
        command: impl FnOnce(oneshot::Sender<T>) -> CommandKind,
    ) -> Result<T, CoordinatorError> {
        let (reply, answer) = oneshot::channel();
        let command = CoordinatorCommand(command(reply));
        self.commands.send(command).await.map_err(|_| CoordinatorError::Stopped)?;
        answer.await.map_err(|_| CoordinatorError::Stopped)
    }
}
