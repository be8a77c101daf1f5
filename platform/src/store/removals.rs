//! Removals: people, tools, factories, organisations and collaborations leave the platform, members and factories a
//! collaboration. Nothing leaves while something of it is in force.

mod left_behind;
mod queries;

use asi_model::{CollaborationId, DateTime, FactoryId, OrganisationId, ToolId};
pub use left_behind::RemainingRecords;
use queries::{
    ALL_ADMINISTRATORS, ASKED, COLLABORATIONS, CREDENTIALS, DRAWN, FACTORIES, LAST_ADMINISTRATOR,
    MEMBERSHIPS, OWN_FACTORIES, PEOPLE, PERFORMED, RECEIVED, REQUESTS_OF_TOOL, SESSIONS_OF_PEOPLE,
    SESSIONS_OF_USER, STANDING, TOOLS,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    audit::AuditSubject, credentials::Credentials, database::Connection, error::StoreError,
    holder::Holder, row::Columns,
};

/// Things that are listed of each kind; who wants to leave ends them one by one anyway.
const LISTED_MAX: i64 = 100;

/// Person, program, plant, organisation or collaboration that leaves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Leaver {
    User(String),
    Tool(ToolId),
    Factory(FactoryId),
    Organisation(OrganisationId),
    Collaboration(CollaborationId),
    Member(CollaborationId, OrganisationId),
    CollaborationFactory(CollaborationId, FactoryId),
}

impl Leaver {
    /// Returns its place in the API.
    #[must_use]
    pub fn path(&self) -> String {
        match self {
            Self::User(name) => format!("users/{name}"),
            Self::Tool(id) => format!("tools/{id}"),
            Self::Factory(id) => format!("factories/{id}"),
            Self::Organisation(id) => format!("organisations/{id}"),
            Self::Collaboration(id) => format!("collaborations/{id}"),
            Self::Member(of, id) => format!("collaborations/{of}/members/{id}"),
            Self::CollaborationFactory(of, id) => format!("collaborations/{of}/factories/{id}"),
        }
    }

    /// Returns what stays of it.
    #[must_use]
    pub fn remaining_records(&self) -> Vec<RemainingRecords> {
        use RemainingRecords::{
            Accesses, Audit, Comments, LedgerLogs, Networks, Reports, Revocations,
        };
        match self {
            Self::User(_) => vec![Networks, Comments, Accesses, Audit],
            Self::Tool(_) => vec![Networks, Accesses, Audit],
            Self::Factory(_)
            | Self::Organisation(_)
            | Self::Collaboration(_)
            | Self::Member(..)
            | Self::CollaborationFactory(..) => {
                vec![Reports, Networks, Comments, Revocations, LedgerLogs, Accesses, Audit]
            }
        }
    }

    /// Returns the holder of broker credentials that it is.
    #[must_use]
    pub fn holder(&self) -> Option<Holder> {
        match self {
            Self::Tool(id) => Some(Holder::Tool(id.clone())),
            Self::Factory(id) => Some(Holder::Factory(id.clone())),
            _ => None,
        }
    }
}

/// Effects of a removal, and what is in its way.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
#[schema(as = Removal)]
pub struct RemovalEffects {
    /// True once it has left.
    pub is_done: bool,
    /// Places of what is in force and has to be ended first, at most a hundred of a kind.
    pub in_force: Vec<String>,
    /// People whose accounts end.
    pub people: Vec<String>,
    /// Number of sessions that end.
    pub sessions: u64,
    /// Number of broker credentials that end, with the connections that use them.
    pub credentials: u64,
    /// Places of requests whose reports no tool gets any more, at most a hundred.
    pub requests: Vec<String>,
    /// Records that stay, since others have a right to them. All else goes, large amounts within minutes.
    pub remains: Vec<RemainingRecords>,
}

/// Repository of removals.
pub struct Removals<'w>(pub(super) &'w mut Connection);

impl Removals<'_> {
    /// Returns who leaves as the subject of a change; none where there is no such.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn subject(&mut self, leaver: &Leaver) -> Result<Option<AuditSubject>, StoreError> {
        let (sql, first, second) = match leaver {
            Leaver::User(name) => (
                "SELECT organisation_id FROM user_account WHERE user_name = $1 AND $2 = ''",
                name.as_str(),
                "",
            ),
            Leaver::Tool(id) => (
                "SELECT organisation_id FROM tool WHERE tool_id = $1 AND $2 = '' AND removed_at IS NULL",
                id.as_str(),
                "",
            ),
            Leaver::Factory(id) => (
                "SELECT organisation_id FROM factory WHERE factory_id = $1 AND $2 = '' AND removed_at IS NULL",
                id.as_str(),
                "",
            ),
            Leaver::Organisation(id) => (
                "SELECT organisation_id FROM organisation
                 WHERE organisation_id = $1 AND $2 = '' AND removed_at IS NULL",
                id.as_str(),
                "",
            ),
            Leaver::Collaboration(id) => (
                // It belongs to no single organisation.
                "SELECT CAST(NULL AS TEXT) AS organisation_id FROM collaboration
                 WHERE collaboration_id = $1 AND $2 = '' AND removed_at IS NULL",
                id.as_str(),
                "",
            ),
            Leaver::Member(of, id) => (
                "SELECT organisation_id FROM collaboration_member
                 WHERE organisation_id = $1 AND collaboration_id = $2",
                id.as_str(),
                of.as_str(),
            ),
            Leaver::CollaborationFactory(of, id) => (
                "SELECT f.organisation_id FROM collaboration_factory c
                 JOIN factory f ON f.factory_id = c.factory_id
                 WHERE c.factory_id = $1 AND c.collaboration_id = $2",
                id.as_str(),
                of.as_str(),
            ),
        };
        let row = sqlx::query(sql)
            .bind(first)
            .bind(second)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look up who leaves"))?;
        let Some(row) = row else { return Ok(None) };
        let concerned = row.parsed_option("organisation_id")?;
        Ok(Some(AuditSubject { path: leaver.path(), concerned }))
    }

    /// Returns what a removal would end, and what is in its way.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn preview(&mut self, leaver: &Leaver) -> Result<RemovalEffects, StoreError> {
        let remains = leaver.remaining_records();
        let mut removal = RemovalEffects { remains, ..RemovalEffects::default() };
        match leaver {
            Leaver::User(name) => {
                removal.people.push(name.clone());
                removal.in_force = self.list(LAST_ADMINISTRATOR, name, "").await?;
                removal.sessions = self.count(SESSIONS_OF_USER, name, "").await?;
            }
            Leaver::Tool(id) => {
                removal.requests = self.list(REQUESTS_OF_TOOL, id.as_str(), "").await?;
                removal.credentials = self.count(CREDENTIALS, "TOOL", id.as_str()).await?;
            }
            Leaver::Factory(id) => {
                removal.in_force = self.list(PERFORMED, id.as_str(), "").await?;
                removal.in_force.extend(self.list(COLLABORATIONS, id.as_str(), "").await?);
                removal.credentials = self.count(CREDENTIALS, "FACTORY", id.as_str()).await?;
            }
            Leaver::Organisation(id) => {
                for sql in [MEMBERSHIPS, FACTORIES, TOOLS] {
                    removal.in_force.extend(self.list(sql, id.as_str(), "").await?);
                }
                removal.in_force.extend(self.list(ALL_ADMINISTRATORS, id.as_str(), "").await?);
                removal.people = self.list(PEOPLE, id.as_str(), "").await?;
                removal.sessions = self.count(SESSIONS_OF_PEOPLE, id.as_str(), "").await?;
            }
            Leaver::Collaboration(id) => {
                removal.in_force = self.list(STANDING, id.as_str(), "").await?;
            }
            Leaver::Member(of, id) => {
                for sql in [DRAWN, ASKED, RECEIVED, OWN_FACTORIES] {
                    removal.in_force.extend(self.list(sql, id.as_str(), of.as_str()).await?);
                }
            }
            Leaver::CollaborationFactory(of, id) => {
                removal.in_force = self.list(PERFORMED, id.as_str(), of.as_str()).await?;
            }
        }
        Ok(removal)
    }

    /// Lets a person, program, plant or organisation leave. What others have a right to stays; it is hidden from now
    /// on, and its id or name is never given again.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn leave(&mut self, leaver: &Leaver, now: DateTime) -> Result<(), StoreError> {
        if let Some(holder) = leaver.holder() {
            Credentials(&mut *self.0).revoke(&holder, now).await?;
        }
        self.hide(leaver, now).await?;
        left_behind::clear_at_once(self.0).await
    }

    /// Removes rows of those who have left that nobody has a right to, of kinds of which there may be many: at most
    /// `rows` of each. Returns the largest number of them.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn clear(&mut self, rows: u32) -> Result<u64, StoreError> {
        left_behind::clear(self.0, rows).await
    }

    /// Returns true where a factory or tool has left.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn has_left(&mut self, holder: &Holder) -> Result<bool, StoreError> {
        let sql = match holder {
            Holder::Factory(_) => {
                "SELECT 1 FROM factory WHERE factory_id = $1 AND removed_at IS NOT NULL"
            }
            Holder::Tool(_) => "SELECT 1 FROM tool WHERE tool_id = $1 AND removed_at IS NOT NULL",
        };
        let found = sqlx::query(sql)
            .bind(holder.id())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("ask who has left"))?;
        Ok(found.is_some())
    }

    async fn hide(&mut self, leaver: &Leaver, now: DateTime) -> Result<(), StoreError> {
        match leaver {
            // The sessions go with the account.
            Leaver::User(name) => {
                self.run("DELETE FROM user_account WHERE user_name = $1 AND $2 = ''", name, "")
                    .await
            }
            Leaver::Tool(id) => {
                self.remove("UPDATE tool SET removed_at = $2 WHERE tool_id = $1", id.as_str(), now)
                    .await
            }
            Leaver::Factory(id) => {
                let sql = "UPDATE factory SET removed_at = $2 WHERE factory_id = $1";
                self.remove(sql, id.as_str(), now).await
            }
            Leaver::Organisation(id) => {
                let sql = "DELETE FROM user_account WHERE organisation_id = $1 AND $2 = ''";
                self.run(sql, id.as_str(), "").await?;
                let sql = "UPDATE organisation SET removed_at = $2 WHERE organisation_id = $1";
                self.remove(sql, id.as_str(), now).await
            }
            Leaver::Collaboration(id) => {
                let sql =
                    "DELETE FROM collaboration_factory WHERE collaboration_id = $1 AND $2 = ''";
                self.run(sql, id.as_str(), "").await?;
                let sql =
                    "DELETE FROM collaboration_member WHERE collaboration_id = $1 AND $2 = ''";
                self.run(sql, id.as_str(), "").await?;
                let sql = "UPDATE collaboration SET removed_at = $2 WHERE collaboration_id = $1";
                self.remove(sql, id.as_str(), now).await
            }
            Leaver::Member(of, id) => {
                let sql = "DELETE FROM collaboration_member
                           WHERE organisation_id = $1 AND collaboration_id = $2";
                self.run(sql, id.as_str(), of.as_str()).await
            }
            Leaver::CollaborationFactory(of, id) => {
                let sql = "DELETE FROM collaboration_factory
                           WHERE factory_id = $1 AND collaboration_id = $2";
                self.run(sql, id.as_str(), of.as_str()).await
            }
        }
    }

    async fn list(
        &mut self,
        sql: &'static str,
        first: &str,
        second: &str,
    ) -> Result<Vec<String>, StoreError> {
        let rows = sqlx::query(sql)
            .bind(first)
            .bind(second)
            .bind(LISTED_MAX)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list what is in force"))?;
        rows.iter().map(|row| row.column("path")).collect()
    }

    async fn count(
        &mut self,
        sql: &'static str,
        first: &str,
        second: &str,
    ) -> Result<u64, StoreError> {
        let count: i64 = sqlx::query_scalar(sql)
            .bind(first)
            .bind(second)
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("count what ends"))?;
        Ok(u64::try_from(count).unwrap_or_default())
    }

    async fn run(
        &mut self,
        sql: &'static str,
        first: &str,
        second: &str,
    ) -> Result<(), StoreError> {
        sqlx::query(sql)
            .bind(first)
            .bind(second)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("let a person or partner leave"))?;
        Ok(())
    }

    async fn remove(
        &mut self,
        sql: &'static str,
        id: &str,
        now: DateTime,
    ) -> Result<(), StoreError> {
        sqlx::query(sql)
            .bind(id)
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("remove what leaves"))?;
        Ok(())
    }
}
