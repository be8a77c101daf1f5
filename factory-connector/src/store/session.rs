//! Connections for reading, and the repositories that borrow them.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use parking_lot::Mutex;
use sqlx::{Sqlite, SqliteConnection, SqlitePool, pool::PoolConnection};

use super::{
    announced_gaps::AnnouncedGaps,
    comments::Comments,
    dead_letters::DeadLetters,
    enrolments::Enrolments,
    error::StoreError,
    fields::Fields,
    former_disclosures::FormerDisclosures,
    ledger::{Checkpoints, Ledger},
    mapping_templates::MappingTemplates,
    mapping_versions::StoredMappingVersions,
    networks::Networks,
    operator_entries::OperatorEntries,
    passkeys::Passkeys,
    past_decisions::PastDecisions,
    past_reports::PastReports,
    policy_documents::PolicyDocuments,
    received_messages::ReceivedMessages,
    recipient_policies::RecipientPolicies,
    reports::Reports,
    revocations::Revocations,
    rule_decisions::RuleDecisions,
    second_factors::SecondFactors,
    secrets::SecretRows,
    shadow_mappings::ShadowMappings,
    sources::Sources,
    spool::Spool,
    users::Users,
    writers::Writers,
};

/// Time within which all that a page reads has to be read: a page that asks for more gives its connection back to
/// others.
const PAGE_READS_MAX: Duration = Duration::from_secs(5);
/// Steps of SQLite's machine between two looks at the clock: a millisecond at most where a disk is fast.
const STEPS_PER_LOOK: i32 = 1_000;

/// Use that has reading connections of its own, so that nobody stops another by asking for much.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReaderUse {
    Pages,
    /// Sign-in, sessions, and the status.
    SignIn,
    /// Messages that the link is to send.
    Spool,
}

/// Reading connections of an open store; clones share them.
#[derive(Clone, Debug)]
pub struct Readers {
    pools: Arc<ReaderPools>,
    used_for: ReaderUse,
}

/// Connections by their use.
#[derive(Debug)]
pub(super) struct ReaderPools {
    pub(super) pages: SqlitePool,
    pub(super) sign_in: SqlitePool,
    pub(super) spool: SqlitePool,
}

impl Readers {
    /// Returns the connections of pages.
    pub(super) fn new(pools: ReaderPools) -> Self {
        Self { pools: Arc::new(pools), used_for: ReaderUse::Pages }
    }

    /// Returns the connections of another use.
    #[must_use]
    pub fn reserved_for(&self, used_for: ReaderUse) -> Self {
        Self { pools: Arc::clone(&self.pools), used_for }
    }

    fn pool(&self) -> &SqlitePool {
        match self.used_for {
            ReaderUse::Pages => &self.pools.pages,
            ReaderUse::SignIn => &self.pools.sign_in,
            ReaderUse::Spool => &self.pools.spool,
        }
    }

    /// Takes a connection, and waits for one while all are in use.
    ///
    /// # Errors
    /// [`StoreError::Database`], for instance when the store is closed.
    pub async fn session(&self) -> Result<StoreSession, StoreError> {
        let connection =
            self.pool().acquire().await.map_err(StoreError::while_doing("connect to the store"))?;
        Ok(StoreSession { connection: Connection::Pooled(connection), reads_end: None })
    }

    /// Takes a connection for what a page reads. A statement that takes too long fails with
    /// [`StoreError::TooExpensive`].
    ///
    /// # Errors
    /// [`StoreError::Database`], for instance when the store is closed.
    pub async fn page_session(&self) -> Result<StoreSession, StoreError> {
        self.session_within(PAGE_READS_MAX).await
    }

    async fn session_within(&self, reads_max: Duration) -> Result<StoreSession, StoreError> {
        let mut session = self.session().await?;
        let locked = session.connection().lock_handle().await;
        let mut handle = locked.map_err(StoreError::while_doing("connect to the store"))?;
        let end = Arc::new(Mutex::new(Instant::now() + reads_max));
        let looked_at = Arc::clone(&end);
        handle.set_progress_handler(STEPS_PER_LOOK, move || Instant::now() < *looked_at.lock());
        drop(handle);
        session.reads_end = Some(end);
        Ok(session)
    }

    pub(super) async fn close(&self) {
        let ReaderPools { pages, sign_in, spool } = &*self.pools;
        for pool in [pages, sign_in, spool] {
            pool.close().await;
        }
    }
}

/// One connection, which sees every transaction that was committed before its statement.
pub struct StoreSession {
    connection: Connection,
    /// Time at which all that a page reads has to be read; none where it may take its time.
    reads_end: Option<Arc<Mutex<Instant>>>,
}

enum Connection {
    Own(Box<SqliteConnection>),
    Pooled(PoolConnection<Sqlite>),
}

impl StoreSession {
    pub(super) fn new(connection: SqliteConnection) -> Self {
        Self { connection: Connection::Own(Box::new(connection)), reads_end: None }
    }

    /// Awaits something else than the store. The time that it takes is none of the page's reads.
    pub async fn aside<T>(&mut self, other: impl Future<Output = T>) -> T {
        let begun = Instant::now();
        let done = other.await;
        if let Some(end) = &self.reads_end {
            *end.lock() += begun.elapsed();
        }
        done
    }

    /// Begins a view: all that is read from here on is as of one time, while others go on writing.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn begin_view(&mut self) -> Result<(), StoreError> {
        let begun = sqlx::query("BEGIN").execute(self.connection()).await;
        begun.map(drop).map_err(StoreError::while_doing("begin a view of the store"))
    }

    /// Returns the repository of signed checkpoints.
    pub fn checkpoints(&mut self) -> Checkpoints<'_> {
        Checkpoints(self.connection())
    }

    /// Returns the repository of comments, those of partners included.
    pub fn comments(&mut self) -> Comments<'_> {
        Comments(self.connection())
    }

    /// Returns the repository of messages that were rejected.
    pub fn dead_letters(&mut self) -> DeadLetters<'_> {
        DeadLetters(self.connection())
    }

    /// Returns the repository of the enrolment.
    pub fn enrolments(&mut self) -> Enrolments<'_> {
        Enrolments(self.connection())
    }

    /// Requested fields with decisions and values.
    pub fn fields(&mut self) -> Fields<'_> {
        Fields(self.connection())
    }

    /// Chains of ledger entries.
    pub fn ledger(&mut self) -> Ledger<'_> {
        Ledger(self.connection())
    }

    /// Returns the repository of mapping templates.
    pub fn mapping_templates(&mut self) -> MappingTemplates<'_> {
        MappingTemplates(self.connection())
    }

    /// Published versions of mappings.
    pub fn mapping_versions(&mut self) -> StoredMappingVersions<'_> {
        StoredMappingVersions(self.connection())
    }

    /// Returns the repository of operation networks as received.
    pub fn networks(&mut self) -> Networks<'_> {
        Networks(self.connection())
    }

    /// Returns the repository of the operator journal.
    pub fn operator_entries(&mut self) -> OperatorEntries<'_> {
        OperatorEntries(self.connection())
    }

    /// Disclosures whose consents ended a short while ago.
    pub fn former_disclosures(&mut self) -> FormerDisclosures<'_> {
        FormerDisclosures(self.connection())
    }

    /// Returns the repository of secrets, sealed or not.
    pub fn secret_rows(&mut self) -> SecretRows<'_> {
        SecretRows(self.connection())
    }

    /// Passkeys of people.
    pub fn passkeys(&mut self) -> Passkeys<'_> {
        Passkeys(self.connection())
    }

    /// Gaps that were announced and that no receipt covered so far.
    pub fn announced_gaps(&mut self) -> AnnouncedGaps<'_> {
        AnnouncedGaps(self.connection())
    }

    /// Decisions whether recipients see the past.
    pub fn past_decisions(&mut self) -> PastDecisions<'_> {
        PastDecisions(self.connection())
    }

    /// Reports that left for others than a recipient.
    pub fn past_reports(&mut self) -> PastReports<'_> {
        PastReports(self.connection())
    }

    /// Named policies and standing rules.
    pub fn policy_documents(&mut self) -> PolicyDocuments<'_> {
        PolicyDocuments(self.connection())
    }

    /// Ids of received messages, for deduplication.
    pub fn received_messages(&mut self) -> ReceivedMessages<'_> {
        ReceivedMessages(self.connection())
    }

    /// Returns the repository of policies that apply to all fields of a recipient.
    pub fn recipient_policies(&mut self) -> RecipientPolicies<'_> {
        RecipientPolicies(self.connection())
    }

    /// Returns the repository of reports with their way to the platform.
    pub fn reports(&mut self) -> Reports<'_> {
        Reports(self.connection())
    }

    /// Receipts of ended consents.
    pub fn revocations(&mut self) -> Revocations<'_> {
        Revocations(self.connection())
    }

    /// Decisions of standing rules.
    pub fn rule_decisions(&mut self) -> RuleDecisions<'_> {
        RuleDecisions(self.connection())
    }

    /// Returns the repository of shadow mappings.
    pub fn shadow_mappings(&mut self) -> ShadowMappings<'_> {
        ShadowMappings(self.connection())
    }

    /// Returns the repository of configured OPC UA servers.
    pub fn sources(&mut self) -> Sources<'_> {
        Sources(self.connection())
    }

    /// Returns the reader of the spool: reports and control messages that wait or were sent.
    pub fn spool(&mut self) -> Spool<'_> {
        Spool(self.connection())
    }

    /// Second factors of people.
    pub fn second_factors(&mut self) -> SecondFactors<'_> {
        SecondFactors(self.connection())
    }

    /// People who may sign in.
    pub fn users(&mut self) -> Users<'_> {
        Users(self.connection())
    }

    /// Returns the repository of data set writers with epoch and last number.
    pub fn writers(&mut self) -> Writers<'_> {
        Writers(self.connection())
    }

    /// Ends the session and, unless it is one of a pool, its connection.
    pub(super) async fn close(self) {
        if let Connection::Own(connection) = self.connection {
            // A connection that does not close in good order is recovered at the next start.
            drop(sqlx::Connection::close(*connection).await);
        }
    }

    pub(crate) fn connection(&mut self) -> &mut SqliteConnection {
        match &mut self.connection {
            Connection::Own(connection) => connection,
            Connection::Pooled(connection) => connection,
        }
    }
}

#[cfg(test)]
mod tests {
    use asi_model::DateTime;

    use super::*;
    use crate::store::Store;

    /// Reads for seconds, in one statement.
    async fn reads_much(session: &mut StoreSession, numbers: i64) -> Result<(), StoreError> {
        let sql = "WITH RECURSIVE numbers (n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM numbers WHERE n < $1)
                   SELECT SUM(n) FROM numbers";
        let read = sqlx::query(sql).bind(numbers).fetch_all(session.connection());
        read.await.map(drop).map_err(StoreError::while_doing("count"))
    }

    #[tokio::test]
    async fn what_a_page_reads_for_too_long_ends_and_an_export_takes_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let factory = "F".parse().expect("an id");
        let now = DateTime::from_ticks(1);
        let store = Store::open(folder.path(), &factory, now).await.expect("it opens");
        let readers = store.readers();
        // As often as there are connections, so that each of them has been a page's.
        for _ in 0..4 {
            let within = Duration::from_millis(100);
            let mut session = readers.session_within(within).await.expect("a connection");
            let ended =
                tokio::time::timeout(Duration::from_secs(20), reads_much(&mut session, 1 << 60));
            let error = ended.await.expect("it ends").expect_err("too much");
            assert!(matches!(error, StoreError::TooExpensive { action: "count" }), "{error:?}");
            let problem = daemon::web::Problem::from(error);
            assert_eq!((problem.status, &*problem.code), (503, "TOO_EXPENSIVE"));
        }
        let mut held = Vec::new();
        for _ in 0..4 {
            let mut session = readers.session().await.expect("a connection");
            tokio::time::sleep(Duration::from_millis(120)).await;
            reads_much(&mut session, 100_000).await.expect("no page's limit is left");
            held.push(session);
        }
        drop(held);
        let within = Duration::from_millis(200);
        let mut session = readers.session_within(within).await.expect("a connection");
        session.aside(tokio::time::sleep(2 * within)).await;
        reads_much(&mut session, 10_000).await.expect("waiting for others is no reading");
        reads_much(&mut session, 1 << 60).await.expect_err("too much");
        drop(session);
        let mut session = readers.page_session().await.expect("a connection");
        let ended =
            tokio::time::timeout(Duration::from_secs(30), reads_much(&mut session, 1 << 60));
        ended.await.expect("it ends").expect_err("too much");
        drop(session);
        store.close().await;
    }
}
