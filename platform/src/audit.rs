//! Record of who changed what, written in the transaction of the change.
//!
//! What a person or program changes it changes in a [`RecordedWork`], which commits together with its
//! entry or not at all. The API has a [`RecordingStore`] and no other way to write.

use std::ops::{Deref, DerefMut};

use crate::{
    clock::{Clock, new_opaque_id},
    principal::Principal,
    store::{
        AuditAgent, AuditAgentKind, AuditOutcome, AuditSubject, NewAuditEntry, Store, StoreError,
        StoreReader, Work,
    },
};

/// The platform's database for changes by people and programs. Clones share the connections.
#[derive(Debug, Clone)]
pub struct RecordingStore {
    store: Store,
    clock: Clock,
}

impl RecordingStore {
    /// Records what is changed in this store.
    #[must_use]
    pub const fn new(store: Store, clock: Clock) -> Self {
        Self { store, clock }
    }

    /// Begins a unit of work for an operation of an agent. `operation` is its id in the description of
    /// the API.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn begin(
        &self,
        agent: impl Into<AuditAgent>,
        operation: &'static str,
    ) -> Result<RecordedWork, StoreError> {
        let work = self.store.begin().await?;
        Ok(RecordedWork { work, agent: agent.into(), operation, clock: self.clock.clone() })
    }

    /// Begins a unit of work that only reads, on one consistent state.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn read(&self) -> Result<Work, StoreError> {
        self.store.read().await
    }

    /// Returns what reads the store and cannot change it.
    #[must_use]
    pub fn reader(&self) -> StoreReader {
        self.store.reader()
    }

    /// Closes all connections; what is committed stays.
    pub async fn close(&self) {
        self.store.close().await;
    }
}

/// A unit of work of an operation. Dropped without [`RecordedWork::commit`], it has no effect.
///
/// There is no way to commit the work within it without an entry:
///
/// ```compile_fail,E0507
/// # async fn commit(work: platform::audit::RecordedWork) -> Result<(), platform::store::StoreError> {
/// platform::store::Work::commit(*work).await
/// # }
/// ```
#[derive(Debug)]
pub struct RecordedWork {
    work: Work,
    agent: AuditAgent,
    operation: &'static str,
    clock: Clock,
}

impl RecordedWork {
    /// Makes the work permanent, with the entry of who did it to what.
    ///
    /// # Errors
    /// [`StoreError::Statement`]; then neither has happened.
    pub async fn commit(
        mut self,
        subject: AuditSubject,
        outcome: AuditOutcome,
    ) -> Result<(), StoreError> {
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: self.clock.now(),
            agent: &self.agent,
            operation: self.operation,
            subject: &subject,
            outcome,
        };
        self.work.audit().add(&entry).await?;
        self.work.commit().await
    }

    /// Names the agent where it becomes known within the work, as the factory of a token.
    pub fn set_agent(&mut self, agent: AuditAgent) {
        self.agent = agent;
    }
}

impl Deref for RecordedWork {
    type Target = Work;
    fn deref(&self) -> &Work {
        &self.work
    }
}

impl DerefMut for RecordedWork {
    fn deref_mut(&mut self) -> &mut Work {
        &mut self.work
    }
}

impl From<&Principal> for AuditAgent {
    fn from(principal: &Principal) -> Self {
        Self {
            kind: AuditAgentKind::User,
            name: principal.user.user_name.clone(),
            organisation_id: principal.organisation().cloned(),
        }
    }
}

/// A command on the platform's machine, or its configuration.
#[derive(Debug, Clone, Copy)]
pub struct CommandLine;

impl From<CommandLine> for AuditAgent {
    fn from(_: CommandLine) -> Self {
        Self { kind: AuditAgentKind::Command, name: "platform".to_owned(), organisation_id: None }
    }
}
