//! Record of who changed what, written in the transaction of the change.
//!
//! What a person or program changes it changes in a [`RecordedWork`], which commits together with its
//! entry or not at all. The API has a [`RecordingStore`] and no other way to write.
//!
//! An operation that changed nothing is recorded once an hour for each person, operation and subject:
//! with more, a person could push the record of what was changed out by repeating what changes nothing.

use std::{
    collections::HashMap,
    ops::{Deref, DerefMut},
    sync::Arc,
};

use asi_model::DateTime;
use parking_lot::Mutex;

use crate::{
    clock::{Clock, new_opaque_id},
    principal::Principal,
    store::{
        AuditAgent, AuditAgentKind, AuditFact, AuditOutcome, AuditSubject, NewAuditEntry, Store,
        StoreError, StoreReader, Work,
    },
};

/// The platform's database for changes by people and programs. Clones share the connections.
#[derive(Debug, Clone)]
pub struct RecordingStore {
    store: Store,
    clock: Clock,
    repeats: Arc<Mutex<Repeats>>,
}

/// Time within which an operation that changes nothing is recorded once, in steps of 100 ns.
const REPEAT_TICKS: i64 = 3600 * 10_000_000;
/// Most operations that are remembered. Beyond, all are forgotten, and recorded once more.
const REPEATS_MAX: usize = 10_000;

/// Operations that changed nothing, with the times of their entries, by agent, operation and subject.
#[derive(Debug, Default)]
struct Repeats(HashMap<(String, &'static str, String), DateTime>);

impl Repeats {
    /// Returns true where the same is on record of the last hour.
    fn is_on_record(&self, key: &(String, &'static str, String), now: DateTime) -> bool {
        let passed = self.0.get(key).map(|at| now.ticks().saturating_sub(at.ticks()));
        // A clock that was set back is no reason to record less.
        passed.is_some_and(|passed| (0..REPEAT_TICKS).contains(&passed))
    }

    fn put(&mut self, key: (String, &'static str, String), now: DateTime) {
        if self.0.len() >= REPEATS_MAX {
            self.0.clear();
        }
        self.0.insert(key, now);
    }
}

impl RecordingStore {
    /// Records what is changed in this store.
    #[must_use]
    pub fn new(store: Store, clock: Clock) -> Self {
        Self { store, clock, repeats: Arc::default() }
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
        let (agent, clock) = (agent.into(), self.clock.clone());
        let repeats = Arc::clone(&self.repeats);
        Ok(RecordedWork { work, agent, operation, facts: Vec::new(), clock, repeats })
    }

    /// Begins a unit of work of a page, which only reads, on one consistent state and within some seconds.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn read(&self) -> Result<Work, StoreError> {
        self.store.page_reader().read().await
    }

    /// Returns what reads the store and cannot change it.
    #[must_use]
    pub fn reader(&self) -> StoreReader {
        self.store.reader()
    }

    /// Returns what reads for enrolments and for the users of the broker: it waits for no reads of pages.
    #[must_use]
    pub fn reserved_reader(&self) -> StoreReader {
        self.store.reserved_reader()
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
    facts: Vec<AuditFact>,
    clock: Clock,
    repeats: Arc<Mutex<Repeats>>,
}

impl RecordedWork {
    /// Makes the work permanent, with the entry of who did it to what. Of what changed nothing an entry of
    /// the last hour is enough.
    ///
    /// # Errors
    /// [`StoreError::Statement`]; then neither has happened.
    pub async fn commit(
        mut self,
        subject: AuditSubject,
        outcome: AuditOutcome,
    ) -> Result<(), StoreError> {
        let now = self.clock.now();
        let key = (self.agent.name.clone(), self.operation, subject.path.clone());
        let is_unchanged = outcome == AuditOutcome::Unchanged;
        if is_unchanged && self.repeats.lock().is_on_record(&key, now) {
            return self.work.commit().await;
        }
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: now,
            agent: &self.agent,
            operation: self.operation,
            subject: &subject,
            outcome,
            facts: &self.facts,
        };
        self.work.audit().add(&entry).await?;
        self.work.commit().await?;
        if is_unchanged {
            self.repeats.lock().put(key, now);
        }
        Ok(())
    }

    /// Adds facts to the entry: ids, roles and numbers that operation and subject do not say.
    pub fn describe(&mut self, facts: impl IntoIterator<Item = AuditFact>) {
        self.facts.extend(facts);
    }

    /// Adds a further entry about what was done, as for the organisation from which a person was taken.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn record_also(
        &mut self,
        subject: &AuditSubject,
        facts: &[AuditFact],
    ) -> Result<(), StoreError> {
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: self.clock.now(),
            agent: &self.agent,
            operation: self.operation,
            subject,
            outcome: AuditOutcome::Done,
            facts,
        };
        self.work.audit().add(&entry).await
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
            is_administrator: principal.is_administrator(),
        }
    }
}

/// The platform itself: what it does by its configuration.
#[derive(Debug, Clone, Copy)]
pub struct CommandLine;

impl From<CommandLine> for AuditAgent {
    fn from(_: CommandLine) -> Self {
        command(COMMAND.to_owned())
    }
}

/// Name of all agents that are commands.
const COMMAND: &str = "platform";

fn command(name: String) -> AuditAgent {
    let kind = AuditAgentKind::Command;
    AuditAgent { kind, name, organisation_id: None, is_administrator: false }
}

/// A user of the platform's machine, who runs a command.
#[derive(Debug, Clone, Copy)]
pub struct MachineUser {
    uid: u32,
    /// The user who became another one with `sudo`, by its word: who may set variables may set this one.
    sudo_uid: Option<u32>,
}

impl MachineUser {
    /// Returns the user of this process.
    #[must_use]
    pub fn of_process() -> Self {
        let sudo_uid = std::env::var("SUDO_UID").ok();
        Self::new(rustix::process::getuid().as_raw(), sudo_uid.as_deref())
    }

    fn new(uid: u32, sudo_uid: Option<&str>) -> Self {
        Self { uid, sudo_uid: sudo_uid.and_then(|text| text.parse().ok()) }
    }
}

impl From<MachineUser> for AuditAgent {
    fn from(user: MachineUser) -> Self {
        let by = user.sudo_uid.map(|uid| format!(", SUDO_UID {uid}")).unwrap_or_default();
        command(format!("{COMMAND}, uid {}{by}", user.uid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: i64) -> DateTime {
        DateTime::from_unix_micros(seconds * 1_000_000)
    }

    #[test]
    fn a_command_names_the_user_of_the_machine() {
        let name = |uid, sudo_uid| AuditAgent::from(MachineUser::new(uid, sudo_uid)).name;
        assert_eq!(name(998, None), "platform, uid 998");
        assert_eq!(name(0, Some("1000")), "platform, uid 0, SUDO_UID 1000");
        assert_eq!(name(0, Some("anna, uid 7")), "platform, uid 0", "a number alone");
    }

    #[test]
    fn what_changed_nothing_is_recorded_once_an_hour() {
        let mut repeats = Repeats::default();
        let key = |path: &str| ("ann".to_owned(), "putNetwork", path.to_owned());
        assert!(!repeats.is_on_record(&key("a"), at(0)));
        repeats.put(key("a"), at(0));
        assert!(repeats.is_on_record(&key("a"), at(3599)));
        assert!(!repeats.is_on_record(&key("b"), at(1)), "another subject");
        assert!(!repeats.is_on_record(&key("a"), at(3600)));
        assert!(!repeats.is_on_record(&key("a"), at(-1)), "the clock was set back");
        for number in 0..=REPEATS_MAX {
            repeats.put(key(&number.to_string()), at(0));
        }
        assert!(repeats.0.len() <= REPEATS_MAX);
    }
}
