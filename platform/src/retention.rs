//! Deletion of raw messages, of accesses and of entries of the audit after their retention periods, and of what was left
//! behind by those who have left, in small portions.

use std::time::Duration;

use asi_model::{DateTime, OrganisationId};
use daemon::web::shares::{ShareOwner, count_refusal};
use tokio_util::sync::CancellationToken;

use crate::{
    audit::CommandLine,
    clock::{Clock, new_opaque_id},
    config::RetentionConfig,
    store::{
        AccessesKept, AuditKept, AuditOutcome, AuditSubject, NewAuditEntry, Store, StoreError, Work,
    },
};

/// The service; [`run`](Self::run) it.
#[derive(Debug)]
pub struct Retention {
    store: Store,
    clock: Clock,
    inbox_retention: Duration,
    access_retention: Duration,
    audit_retention: Duration,
}

/// Pause between portions, in which others get the writer.
const PAUSE: Duration = Duration::from_millis(20);
/// Time between two rounds.
const INTERVAL: Duration = Duration::from_secs(60);
/// Entries of a factory's access log that are kept at most; some hundred bytes each.
const ACCESSES_RETAINED_MAX: u64 = 2_000_000;
/// Entries of who changed what that are kept of one organisation's people and programs at most; some hundred bytes
/// each. Those of administrators and commands are kept their whole time.
const AUDIT_ENTRIES_RETAINED_MAX: u64 = 1_000_000;
/// Share of an organisation in these entries.
const AUDIT: &str = "audit";
/// Operation of the entry that says that entries beyond a share were forgotten.
const FORGET: &str = "forgetAuditEntries";
const DAY: Duration = Duration::from_secs(86_400);
/// Rows forgotten in one transaction, so that nobody waits long for the writer.
const ROWS_PER_WORK_MAX: u32 = 2_000;

/// Numbers of rows that were forgotten at once.
struct Portion {
    messages: u64,
    accesses: u64,
    entries: u64,
    left_behind: u64,
}

impl Portion {
    /// Returns true where there may be more.
    fn is_full(&self) -> bool {
        let Self { messages, accesses, entries, left_behind } = *self;
        let mut all = [messages, accesses, entries, left_behind].into_iter();
        all.any(|rows| rows >= u64::from(ROWS_PER_WORK_MAX))
    }
}

impl Retention {
    /// Keeps messages and accesses as long as configured.
    #[must_use]
    pub fn new(store: Store, clock: Clock, config: &RetentionConfig) -> Self {
        let days = |count: u32| Duration::from_secs(u64::from(count) * 86_400);
        let (inbox_retention, access_retention) =
            (days(config.inbox_days), days(config.access_days));
        let audit_retention = days(config.audit_days);
        Self { store, clock, inbox_retention, access_retention, audit_retention }
    }

    /// Runs until shutdown.
    ///
    /// # Errors
    /// Never; a failing store is logged and asked again in the next round.
    pub async fn run(self, shutdown: CancellationToken) -> Result<(), StoreError> {
        let mut rounds = tokio::time::interval(INTERVAL);
        while shutdown.run_until_cancelled(rounds.tick()).await.is_some() {
            if let Some(Err(error)) = shutdown.run_until_cancelled(self.round()).await {
                tracing::warn!(%error, "Old messages, accesses and entries of the audit could not be forgotten.");
            }
        }
        Ok(())
    }

    /// Forgets all that is too old or too much, portion by portion; how many messages.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn round(&self) -> Result<u64, StoreError> {
        let mut count = 0;
        loop {
            let portion = self.portion().await?;
            count += portion.messages;
            if !portion.is_full() {
                return Ok(count);
            }
            tokio::time::sleep(PAUSE).await;
        }
    }

    /// Forgets one portion of each.
    async fn portion(&self) -> Result<Portion, StoreError> {
        let mut work = self.store.begin().await?;
        let before = self.before(self.inbox_retention);
        let messages = work.inbox().forget(before, ROWS_PER_WORK_MAX).await?;
        work.commit().await?;
        let mut work = self.store.begin().await?;
        // Whole days: each removal is stated in the log, and one a day is enough.
        let since = self.before(self.access_retention).floor_to(DAY);
        let kept = AccessesKept { since, count: ACCESSES_RETAINED_MAX };
        let accesses = work.accesses().forget(kept, ROWS_PER_WORK_MAX, self.clock.now()).await?;
        work.commit().await?;
        let kept = AuditKept {
            since: self.before(self.audit_retention),
            count: AUDIT_ENTRIES_RETAINED_MAX,
        };
        let entries = self.forget_entries(kept).await?;
        let mut work = self.store.begin().await?;
        let left_behind = work.removals().clear(ROWS_PER_WORK_MAX).await?;
        work.commit().await?;
        Ok(Portion { messages, accesses, entries, left_behind })
    }

    /// Forgets a portion of the entries of who changed what, and says so where a share was too small.
    async fn forget_entries(&self, kept: AuditKept) -> Result<u64, StoreError> {
        let mut work = self.store.begin().await?;
        let (forgotten, beyond) = work.audit().forget(kept, ROWS_PER_WORK_MAX).await?;
        for organisation in &beyond {
            count_refusal(AUDIT, ShareOwner::Organisation(organisation.as_str()));
            self.state(&mut work, organisation).await?;
        }
        work.commit().await?;
        Ok(forgotten)
    }

    /// Adds the entry that older ones of an organisation were forgotten before their time; one a day says enough.
    async fn state(
        &self,
        work: &mut Work,
        organisation: &OrganisationId,
    ) -> Result<(), StoreError> {
        let now = self.clock.now();
        let is_stated = |at: DateTime| at > self.before(DAY) && at <= now;
        if work.audit().forgotten_at(organisation).await?.is_some_and(is_stated) {
            return Ok(());
        }
        tracing::warn!(
            organisation.id = %organisation,
            "An organisation changed so much that its oldest entries of the audit are forgotten before their time."
        );
        let path = format!("organisations/{organisation}/audit-entries");
        let entry = NewAuditEntry {
            entry_id: new_opaque_id(),
            recorded_at: now,
            agent: &CommandLine.into(),
            operation: FORGET,
            subject: &AuditSubject::of(organisation, path),
            outcome: AuditOutcome::Done,
            facts: &[],
        };
        work.audit().add(&entry).await
    }

    /// Returns the time before which nothing is kept.
    fn before(&self, period: Duration) -> DateTime {
        let ticks = i64::try_from(period.as_nanos() / 100).unwrap_or(i64::MAX);
        DateTime::from_ticks(self.clock.now().ticks().saturating_sub(ticks))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        audit::RecordingStore,
        store::{AuditAgent, AuditAgentKind, AuditEntry, Scope},
    };

    #[tokio::test]
    async fn what_is_forgotten_beyond_a_share_is_said_once_a_day() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(&folder.path().join("store.sqlite")).await.expect("it opens");
        let recording = RecordingStore::new(store.clone(), Clock::system());
        let retention = Retention::new(store.clone(), Clock::system(), &RetentionConfig::default());
        let kept = AuditKept { since: DateTime::from_ticks(0), count: 3 };
        let mut number = 0;
        for round in 0..3 {
            for _ in 0..5 {
                number += 1;
                let agent = AuditAgent {
                    kind: AuditAgentKind::User,
                    name: "p".to_owned(),
                    organisation_id: Some("busy".parse().expect("an id")),
                    is_administrator: false,
                };
                let work = recording.begin(agent, "putNetwork").await.expect("begun");
                let subject = AuditSubject::shared(format!("networks/{number}"));
                work.commit(subject, AuditOutcome::Done).await.expect("committed");
            }
            retention.forget_entries(kept).await.expect("forgotten");
            let mut work = store.read().await.expect("begun");
            let all = work.audit().list_after(&Scope::Platform, 0, 100).await.expect("listed");
            let (stated, others): (Vec<AuditEntry>, Vec<AuditEntry>) =
                all.into_iter().partition(|entry| entry.operation == FORGET);
            assert_eq!(others.len(), 3, "round {round}");
            let subjects: Vec<String> = stated.into_iter().map(|entry| entry.subject).collect();
            assert_eq!(subjects, ["organisations/busy/audit-entries"], "round {round}");
            let own = Scope::Organisation("busy".parse().expect("an id"));
            let seen = work.audit().list_after(&own, 0, 100).await.expect("listed");
            assert!(
                seen.iter().any(|entry| entry.operation == FORGET),
                "it is said to whose it is"
            );
        }
    }
}
