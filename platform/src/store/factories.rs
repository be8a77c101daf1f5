//! Factories and when they were heard last.

use asi_model::{DateTime, FactoryId, OrganisationId};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
    scope::Scope,
};

/// A factory: one connector, with the evidence of its life.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Factory {
    /// Its id, also its PublisherId and part of its addresses.
    pub factory_id: FactoryId,
    pub organisation_id: OrganisationId,
    /// Name for people.
    pub name: String,
    /// Addition, by the platform's clock.
    pub created_at: DateTime,
    /// Last enrolment of its connector; absent before the first.
    pub enrolled_at: Option<DateTime>,
    /// Last arrival from it, keep-alives included, for its own organisation. For others the minute
    /// of the last sign that does not follow values: a renewal of its lease, or a status.
    pub last_seen_at: Option<DateTime>,
    /// Arrival of its last report, for its own organisation.
    pub last_report_at: Option<DateTime>,
    /// State that its publisher reported last (`ua-status`), for example `Operational`.
    pub publisher_state: Option<String>,
}

/// Evidence of a factory's life.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Heard {
    /// Last arrival of any message.
    pub at: Option<DateTime>,
    /// Arrival of the last report.
    pub report_at: Option<DateTime>,
    /// Minute of the last sign that does not follow values.
    pub sign_at: Option<DateTime>,
    /// State that the publisher reported.
    pub publisher_state: Option<&'static str>,
}

/// Repository of factories.
pub struct Factories<'w>(pub(super) &'w mut Connection);

/// Factories visible to the organisation `$1`, or the one with the id `$2` where that is given. The
/// organisation `$3` sees when its own were heard.
const SELECT: &str = "SELECT f.factory_id, f.organisation_id, f.name, f.created_at, f.enrolled_at, f.publisher_state,
        CASE WHEN CAST($3 AS TEXT) IS NULL OR f.organisation_id = $3 THEN f.last_heard_at
            ELSE f.last_sign_at END AS last_heard_at,
        CASE WHEN CAST($3 AS TEXT) IS NULL OR f.organisation_id = $3 THEN f.last_report_at END AS last_report_at
    FROM factory f
    WHERE f.removed_at IS NULL AND (CAST($2 AS TEXT) IS NULL OR f.factory_id = $2)
      AND (CAST($1 AS TEXT) IS NULL OR f.organisation_id = $1 OR EXISTS (
        SELECT 1 FROM collaboration_factory cf
        JOIN collaboration_member m ON m.collaboration_id = cf.collaboration_id
        WHERE cf.factory_id = f.factory_id AND m.organisation_id = $1))
    ORDER BY f.factory_id";

impl Factories<'_> {
    /// Adds one; returns false if the id is in use.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown organisation.
    pub async fn add(
        &mut self,
        factory_id: &FactoryId,
        organisation_id: &OrganisationId,
        name: &str,
        now: DateTime,
    ) -> Result<bool, StoreError> {
        let sql = "INSERT INTO factory (factory_id, organisation_id, name, created_at) VALUES ($1, $2, $3, $4)
                   ON CONFLICT (factory_id) DO NOTHING";
        let result = sqlx::query(sql)
            .bind(factory_id.as_str())
            .bind(organisation_id.as_str())
            .bind(name)
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a factory"))?;
        Ok(result.rows_affected() == 1)
    }

    /// Lists the ids of those that have left, which are never given again.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn removed(&mut self) -> Result<Vec<FactoryId>, StoreError> {
        let sql = "SELECT factory_id FROM factory WHERE removed_at IS NOT NULL ORDER BY factory_id";
        let rows = sqlx::query(sql)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list factories that have left"))?;
        rows.iter().map(|row| row.parsed("factory_id")).collect()
    }

    /// Lists those of the viewer's organisation and of its collaborations, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self, scope: &Scope) -> Result<Vec<Factory>, StoreError> {
        let rows = sqlx::query(SELECT)
            .bind(scope.member())
            .bind(None::<&str>)
            .bind(scope.recipient())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list factories"))?;
        rows.iter().map(read).collect()
    }

    /// Looks one up that the viewer may know of.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        scope: &Scope,
        id: &FactoryId,
    ) -> Result<Option<Factory>, StoreError> {
        let row = sqlx::query(SELECT)
            .bind(scope.member())
            .bind(id.as_str())
            .bind(scope.recipient())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a factory up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Lists the organisations that may know of a factory: its own, and the other members of its
    /// collaborations by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn concerned(
        &mut self,
        id: &FactoryId,
    ) -> Result<(Vec<OrganisationId>, Vec<OrganisationId>), StoreError> {
        let sql = "SELECT organisation_id, 1 AS is_own FROM factory WHERE factory_id = $1
                   UNION SELECT m.organisation_id, 0 FROM collaboration_factory cf
                   JOIN collaboration_member m ON m.collaboration_id = cf.collaboration_id
                   JOIN factory f ON f.factory_id = cf.factory_id
                   WHERE cf.factory_id = $1 AND m.organisation_id <> f.organisation_id
                   ORDER BY 1";
        let rows = sqlx::query(sql)
            .bind(id.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who may know of a factory"))?;
        let (mut own, mut others) = (Vec::new(), Vec::new());
        for row in &rows {
            let is_own = row.unsigned::<u8>("is_own")? != 0;
            if is_own { &mut own } else { &mut others }.push(row.parsed("organisation_id")?);
        }
        Ok((own, others))
    }

    /// Notes that the connector enrolled.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn enrolled(&mut self, id: &FactoryId, now: DateTime) -> Result<(), StoreError> {
        sqlx::query("UPDATE factory SET enrolled_at = $2 WHERE factory_id = $1")
            .bind(id.as_str())
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note an enrolment"))?;
        Ok(())
    }

    /// Notes that the factory says to whom it releases its reports; for good.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn named_recipients(
        &mut self,
        id: &FactoryId,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let sql = "UPDATE factory SET names_recipients_since = $2
                   WHERE factory_id = $1 AND names_recipients_since IS NULL";
        sqlx::query(sql)
            .bind(id.as_str())
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note that a factory names recipients"))?;
        Ok(())
    }

    /// Returns true where the factory has ever said to whom it releases its reports.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn names_recipients(&mut self, id: &FactoryId) -> Result<bool, StoreError> {
        let sql = "SELECT 1 FROM factory
                   WHERE factory_id = $1 AND names_recipients_since IS NOT NULL";
        let found = sqlx::query(sql)
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("ask whether a factory names recipients"))?;
        Ok(found.is_some())
    }

    /// Notes what arrived of a factory.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn heard(&mut self, id: &FactoryId, heard: &Heard) -> Result<(), StoreError> {
        let sql = "UPDATE factory SET last_heard_at = COALESCE($2, last_heard_at),
                       last_report_at = COALESCE($3, last_report_at),
                       publisher_state = COALESCE($4, publisher_state),
                       last_sign_at = COALESCE($5, last_sign_at)
                   WHERE factory_id = $1";
        sqlx::query(sql)
            .bind(id.as_str())
            .bind(heard.at.map(DateTime::ticks))
            .bind(heard.report_at.map(DateTime::ticks))
            .bind(heard.publisher_state)
            .bind(heard.sign_at.map(DateTime::ticks))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note that a factory was heard"))?;
        Ok(())
    }
}

fn read(row: &DatabaseRow) -> Result<Factory, StoreError> {
    Ok(Factory {
        factory_id: row.parsed("factory_id")?,
        organisation_id: row.parsed("organisation_id")?,
        name: row.column("name")?,
        created_at: row.time("created_at")?,
        enrolled_at: row.time_option("enrolled_at")?,
        last_seen_at: row.time_option("last_heard_at")?,
        last_report_at: row.time_option("last_report_at")?,
        publisher_state: row.column("publisher_state")?,
    })
}
