//! Entries of who changed what. They are added and read; only retention removes the oldest.

mod facts;

use std::{fmt, str::FromStr};

use asi_model::{DateTime, OrganisationId};
pub use facts::{AuditFact, AuditFactKind};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
    scope::Scope,
};
use crate::opaque_id::OpaqueId;

/// Kind of person or program that makes a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AuditAgentKind {
    /// A person, with its user account.
    User,
    /// A program of a partner, over the broker.
    Tool,
    /// A connector that enrols, or whose messages change what others see.
    Factory,
    /// A command on the platform's machine, or its configuration.
    Command,
}

impl AuditAgentKind {
    const ALL: [Self; 4] = [Self::User, Self::Tool, Self::Factory, Self::Command];

    const fn as_str(self) -> &'static str {
        match self {
            Self::User => "USER",
            Self::Tool => "TOOL",
            Self::Factory => "FACTORY",
            Self::Command => "COMMAND",
        }
    }
}

impl FromStr for AuditAgentKind {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.as_str() == text);
        found.ok_or_else(|| format!("{text:?} is no kind of agent"))
    }
}

/// Outcome of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum AuditOutcome {
    Done,
    /// All was as wanted before.
    Unchanged,
}

impl AuditOutcome {
    /// Returns the outcome of an operation that says whether it changed anything.
    #[must_use]
    pub const fn of(is_changed: bool) -> Self {
        if is_changed { Self::Done } else { Self::Unchanged }
    }

    const fn as_str(self) -> &'static str {
        match self {
            Self::Done => "DONE",
            Self::Unchanged => "UNCHANGED",
        }
    }
}

impl FromStr for AuditOutcome {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let found = [Self::Done, Self::Unchanged].into_iter().find(|each| each.as_str() == text);
        found.ok_or_else(|| format!("{text:?} is no outcome"))
    }
}

/// Person or program that changes something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AuditAgent {
    pub kind: AuditAgentKind,
    /// Name of the user, id of the tool or factory, or name of the command.
    pub name: String,
    /// The organisation for which it acts.
    pub organisation_id: Option<OrganisationId>,
    /// True for a person who ran the platform when the change began, who may have ended its own account with it.
    pub is_administrator: bool,
}

impl AuditAgent {
    /// Returns the organisation in whose share its entries are: what an administrator does is in none.
    fn share(&self) -> Option<&str> {
        let organisation = self.organisation_id.as_ref().filter(|_| !self.is_administrator);
        organisation.map(OrganisationId::as_str)
    }
}

/// Thing that an operation was about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AuditSubject {
    /// Its place in the API, as `factories/FOR_MUC`.
    pub path: String,
    /// The organisation whose people, factory or tool it is; none for what is of several.
    pub concerned: Option<OrganisationId>,
}

impl AuditSubject {
    /// Names what belongs to no single organisation.
    #[must_use]
    pub fn shared(path: impl fmt::Display) -> Self {
        Self { path: path.to_string(), concerned: None }
    }

    /// Names what belongs to an organisation.
    #[must_use]
    pub fn of(organisation: &OrganisationId, path: impl fmt::Display) -> Self {
        Self { path: path.to_string(), concerned: Some(organisation.clone()) }
    }
}

/// An entry to add.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewAuditEntry<'a> {
    pub entry_id: OpaqueId,
    pub recorded_at: DateTime,
    pub agent: &'a AuditAgent,
    /// The operation's id in the description of the API.
    pub operation: &'a str,
    pub subject: &'a AuditSubject,
    pub outcome: AuditOutcome,
    /// Ids, roles and numbers that operation and subject do not say.
    pub facts: &'a [AuditFact],
}

/// An entry as a viewer may see it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AuditEntry {
    /// Number of the entry in the order of all, which nobody is shown.
    #[serde(skip)]
    pub number: u64,
    pub entry_id: OpaqueId,
    pub recorded_at: DateTime,
    pub agent_kind: AuditAgentKind,
    /// Name of the person or program, for its own organisation and administrators.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agent_name: Option<String>,
    /// The organisation for which it acted; absent for who runs the platform.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub organisation_id: Option<OrganisationId>,
    /// Id of the operation in the description of the API, as `putUser`, or name of what a connector did, as
    /// `decideField`.
    pub operation: String,
    /// Place of what it was about, as `factories/FOR_MUC`.
    pub subject: String,
    pub outcome: AuditOutcome,
    /// Ids, roles and numbers that operation and subject do not say, for who acted and whom it concerns.
    pub detail: Vec<AuditFact>,
}

/// Condition on a row `e` of `audit_entry`: an agent of the organisation `$1` made it, or it is about what
/// belongs to it alone.
macro_rules! own {
    () => {
        "(CAST($1 AS TEXT) IS NULL OR e.organisation_id = $1 OR e.concerned_id = $1)"
    };
}

/// Entries that are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AuditKept {
    /// Time of the oldest.
    pub since: DateTime,
    /// Most entries in the share of an organisation.
    pub count: u64,
}

/// Repository of entries.
pub struct AuditEntries<'w>(pub(super) &'w mut Connection);

impl AuditEntries<'_> {
    /// Adds an entry.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, entry: &NewAuditEntry<'_>) -> Result<(), StoreError> {
        let sql = "INSERT INTO audit_entry (recorded_at, agent_kind, agent_name, organisation_id, operation, subject,
                       concerned_id, outcome, opaque_id, detail, share)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)";
        sqlx::query(sql)
            .bind(entry.recorded_at.ticks())
            .bind(entry.agent.kind.as_str())
            .bind(&entry.agent.name)
            .bind(entry.agent.organisation_id.as_ref().map(OrganisationId::as_str))
            .bind(entry.operation)
            .bind(&entry.subject.path)
            .bind(entry.subject.concerned.as_ref().map(OrganisationId::as_str))
            .bind(entry.outcome.as_str())
            .bind(entry.entry_id.as_str())
            .bind(facts::stored(entry.facts))
            .bind(entry.agent.share())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("record who changed what"))?;
        Ok(())
    }

    /// Lists entries that the viewer may see, newest first, those from before the entry `before`. Where
    /// retention removed that one, it removed all before it.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        before: Option<&OpaqueId>,
        limit: u32,
    ) -> Result<Vec<AuditEntry>, StoreError> {
        let sql = concat!(
            "SELECT e.* FROM audit_entry e WHERE ",
            own!(),
            " AND (CAST($2 AS TEXT) IS NULL OR e.audit_entry_id <
                  (SELECT e.audit_entry_id FROM audit_entry e WHERE e.opaque_id = $2 AND ",
            own!(),
            ")) ORDER BY e.audit_entry_id DESC LIMIT $3"
        );
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .bind(before.map(OpaqueId::as_str))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who changed what"))?;
        rows.iter().map(|row| read(row, scope)).collect()
    }

    /// Lists entries that the viewer may see, oldest first, with greater numbers than `after`.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list_after(
        &mut self,
        scope: &Scope,
        after: u64,
        limit: u32,
    ) -> Result<Vec<AuditEntry>, StoreError> {
        let sql = concat!(
            "SELECT e.* FROM audit_entry e WHERE ",
            own!(),
            " AND e.audit_entry_id > $2 ORDER BY e.audit_entry_id LIMIT $3"
        );
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .bind(signed(after))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who changed what"))?;
        rows.iter().map(|row| read(row, scope)).collect()
    }

    /// Forgets the oldest entries: those of before a time, and of each organisation those beyond its share; not
    /// more than `rows` in all. What one organisation does pushes out nothing of another, and of what administrators
    /// and commands did nothing goes before its time. Returns the number, and the organisations beyond their shares.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn forget(
        &mut self,
        kept: AuditKept,
        rows: u32,
    ) -> Result<(u64, Vec<OrganisationId>), StoreError> {
        let (mut forgotten, mut beyond) = (0, Vec::new());
        for share in self.shares().await? {
            let left = |forgotten| u64::from(rows).saturating_sub(forgotten);
            forgotten += self.forget_old(share.as_ref(), kept.since, left(forgotten)).await?;
            let Some(organisation) = share else { continue };
            let number = self.forget_beyond(&organisation, kept.count, left(forgotten)).await?;
            forgotten += number;
            if number > 0 {
                beyond.push(organisation);
            }
        }
        Ok((forgotten, beyond))
    }

    /// Returns the time of the newest entry that says that entries of an organisation were forgotten.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn forgotten_at(
        &mut self,
        organisation: &OrganisationId,
    ) -> Result<Option<DateTime>, StoreError> {
        let sql = "SELECT MAX(recorded_at) AS recorded_at FROM audit_entry
                   WHERE operation = 'forgetAuditEntries' AND concerned_id = $1";
        let row = sqlx::query(sql)
            .bind(organisation.as_str())
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("look up what was forgotten of the audit"))?;
        row.time_option("recorded_at")
    }

    /// Returns the organisations with a share; `None` among them for what is in none.
    async fn shares(&mut self) -> Result<Vec<Option<OrganisationId>>, StoreError> {
        // From one to the next in the index, however many entries there are of each.
        let sql = "WITH RECURSIVE known(id) AS (
                       SELECT MIN(share) FROM audit_entry
                       UNION ALL
                       SELECT (SELECT MIN(share) FROM audit_entry WHERE share > known.id)
                       FROM known WHERE known.id IS NOT NULL)
                   SELECT id FROM known WHERE id IS NOT NULL UNION ALL SELECT NULL";
        let rows = sqlx::query(sql)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list whose entries of the audit there are"))?;
        rows.iter().map(|row| row.parsed_option("id")).collect()
    }

    async fn forget_old(
        &mut self,
        share: Option<&OrganisationId>,
        since: DateTime,
        rows: u64,
    ) -> Result<u64, StoreError> {
        // In the order of the numbers: one that is older than its predecessor waits for it.
        let sql = "DELETE FROM audit_entry WHERE audit_entry_id IN (
                       SELECT e.audit_entry_id FROM audit_entry e
                       WHERE e.share IS $1 AND e.audit_entry_id <
                           COALESCE((SELECT y.audit_entry_id FROM audit_entry y
                                     WHERE y.share IS $1 AND y.recorded_at >= $2
                                     ORDER BY y.audit_entry_id LIMIT 1),
                                    (SELECT MAX(l.audit_entry_id) + 1 FROM audit_entry l))
                       ORDER BY e.audit_entry_id LIMIT $3)";
        let result = sqlx::query(sql)
            .bind(share.map(OrganisationId::as_str))
            .bind(since.ticks())
            .bind(signed(rows))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget old entries of the audit"))?;
        Ok(result.rows_affected())
    }

    async fn forget_beyond(
        &mut self,
        share: &OrganisationId,
        count: u64,
        rows: u64,
    ) -> Result<u64, StoreError> {
        let sql = "DELETE FROM audit_entry WHERE audit_entry_id IN (
                       SELECT e.audit_entry_id FROM audit_entry e
                       WHERE e.share = $1 AND e.audit_entry_id <= (
                           SELECT n.audit_entry_id FROM audit_entry n WHERE n.share = $1
                           ORDER BY n.audit_entry_id DESC LIMIT 1 OFFSET $2)
                       ORDER BY e.audit_entry_id LIMIT $3)";
        let result = sqlx::query(sql)
            .bind(share.as_str())
            .bind(signed(count))
            .bind(signed(rows))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget entries of the audit beyond a share"))?;
        Ok(result.rows_affected())
    }
}

fn read(row: &DatabaseRow, scope: &Scope) -> Result<AuditEntry, StoreError> {
    let organisation_id: Option<OrganisationId> = row.parsed_option("organisation_id")?;
    let agent_name: String = row.column("agent_name")?;
    let viewer = scope.member();
    let is_own = viewer.is_none() || viewer == organisation_id.as_ref().map(OrganisationId::as_str);
    Ok(AuditEntry {
        number: row.unsigned("audit_entry_id")?,
        entry_id: row.parsed("opaque_id")?,
        recorded_at: row.time("recorded_at")?,
        agent_kind: row.parsed("agent_kind")?,
        agent_name: Some(agent_name).filter(|_| is_own),
        organisation_id,
        operation: row.column("operation")?,
        subject: row.column("subject")?,
        outcome: row.parsed("outcome")?,
        detail: facts::shown(row, viewer)?,
    })
}
