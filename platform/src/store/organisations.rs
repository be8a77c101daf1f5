//! Organisations.

use asi_model::{DateTime, OrganisationId};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
    scope::Scope,
};

/// A company, institute or person that takes part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Organisation {
    pub organisation_id: OrganisationId,
    /// Name for people.
    pub name: String,
    /// Addition, by the platform's clock.
    pub created_at: DateTime,
}

/// Repository of organisations.
pub struct Organisations<'w>(pub(super) &'w mut Connection);

impl Organisations<'_> {
    /// Adds one; returns false if the id is in use.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(&mut self, organisation: &Organisation) -> Result<bool, StoreError> {
        let sql = "INSERT INTO organisation (organisation_id, name, created_at) VALUES ($1, $2, $3)
                   ON CONFLICT (organisation_id) DO NOTHING";
        let result = sqlx::query(sql)
            .bind(organisation.organisation_id.as_str())
            .bind(&organisation.name)
            .bind(organisation.created_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add an organisation"))?;
        Ok(result.rows_affected() == 1)
    }

    /// Lists those the viewer shares a collaboration with, itself included, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self, scope: &Scope) -> Result<Vec<Organisation>, StoreError> {
        let sql = "SELECT organisation_id, name, created_at FROM organisation o
                   WHERE o.removed_at IS NULL AND (CAST($1 AS TEXT) IS NULL OR o.organisation_id = $1 OR EXISTS (
                       SELECT 1 FROM collaboration_member mine
                       JOIN collaboration_member theirs ON theirs.collaboration_id = mine.collaboration_id
                       WHERE mine.organisation_id = $1 AND theirs.organisation_id = o.organisation_id))
                   ORDER BY organisation_id";
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list organisations"))?;
        rows.iter().map(read).collect()
    }

    /// Looks one up for the platform's own checks.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn exists(&mut self, id: &OrganisationId) -> Result<bool, StoreError> {
        let found: Option<i64> = sqlx::query_scalar(
            "SELECT 1 FROM organisation WHERE organisation_id = $1 AND removed_at IS NULL",
        )
        .bind(id.as_str())
        .fetch_optional(&mut *self.0)
        .await
        .map_err(StoreError::during("look an organisation up"))?;
        Ok(found.is_some())
    }
}

fn read(row: &DatabaseRow) -> Result<Organisation, StoreError> {
    Ok(Organisation {
        organisation_id: row.parsed("organisation_id")?,
        name: row.column("name")?,
        created_at: row.time("created_at")?,
    })
}
