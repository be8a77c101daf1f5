//! Collaborations: under whose agreement networks are exchanged.

use asi_model::{CollaborationId, DateTime, FactoryId, OrganisationId};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
    scope::Scope,
};

/// A collaboration with its members and factories.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Collaboration {
    /// Its id.
    #[schema(value_type = String)]
    pub collaboration_id: CollaborationId,
    /// What people call it.
    pub name: String,
    /// Since when it is here.
    #[schema(value_type = String, format = DateTime)]
    pub created_at: DateTime,
    /// The organisations that take part, by id.
    #[schema(value_type = Vec<String>)]
    pub members: Vec<OrganisationId>,
    /// The factories that take part, by id.
    #[schema(value_type = Vec<String>)]
    pub factories: Vec<FactoryId>,
}

/// Repository of collaborations.
pub struct Collaborations<'w>(pub(super) &'w mut Connection);

impl Collaborations<'_> {
    /// Adds one with members and factories. Says false where the id is taken.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for unknown members.
    pub async fn add(&mut self, collaboration: &Collaboration) -> Result<bool, StoreError> {
        let sql =
            "INSERT INTO collaboration (collaboration_id, name, created_at) VALUES ($1, $2, $3)
                   ON CONFLICT (collaboration_id) DO NOTHING";
        let result = sqlx::query(sql)
            .bind(collaboration.collaboration_id.as_str())
            .bind(&collaboration.name)
            .bind(collaboration.created_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a collaboration"))?;
        if result.rows_affected() == 0 {
            return Ok(false);
        }
        for member in &collaboration.members {
            self.add_member(&collaboration.collaboration_id, member).await?;
        }
        for factory in &collaboration.factories {
            self.add_factory(&collaboration.collaboration_id, factory).await?;
        }
        Ok(true)
    }

    /// Adds a member; nothing happens where it is one.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown organisation.
    pub async fn add_member(
        &mut self,
        id: &CollaborationId,
        member: &OrganisationId,
    ) -> Result<(), StoreError> {
        let sql =
            "INSERT INTO collaboration_member (collaboration_id, organisation_id) VALUES ($1, $2)
                   ON CONFLICT DO NOTHING";
        sqlx::query(sql)
            .bind(id.as_str())
            .bind(member.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a member"))?;
        Ok(())
    }

    /// Adds a factory; nothing happens where it takes part.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown factory.
    pub async fn add_factory(
        &mut self,
        id: &CollaborationId,
        factory: &FactoryId,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO collaboration_factory (collaboration_id, factory_id) VALUES ($1, $2)
                   ON CONFLICT DO NOTHING";
        sqlx::query(sql)
            .bind(id.as_str())
            .bind(factory.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a factory to a collaboration"))?;
        Ok(())
    }

    /// Those the viewer's organisation belongs to; by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self, scope: &Scope) -> Result<Vec<Collaboration>, StoreError> {
        let sql = "SELECT c.* FROM collaboration c
                   WHERE CAST($1 AS TEXT) IS NULL OR EXISTS (
                       SELECT 1 FROM collaboration_member m
                       WHERE m.collaboration_id = c.collaboration_id AND m.organisation_id = $1)
                   ORDER BY c.collaboration_id";
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list collaborations"))?;
        let mut collaborations = Vec::with_capacity(rows.len());
        for row in &rows {
            collaborations.push(self.complete(row).await?);
        }
        Ok(collaborations)
    }

    /// Looks one up that the viewer's organisation belongs to.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        scope: &Scope,
        id: &CollaborationId,
    ) -> Result<Option<Collaboration>, StoreError> {
        let sql = "SELECT c.* FROM collaboration c
                   WHERE c.collaboration_id = $2 AND (CAST($1 AS TEXT) IS NULL OR EXISTS (
                       SELECT 1 FROM collaboration_member m
                       WHERE m.collaboration_id = c.collaboration_id AND m.organisation_id = $1))";
        let row = sqlx::query(sql)
            .bind(scope.member())
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a collaboration up"))?;
        match row {
            Some(row) => Ok(Some(self.complete(&row).await?)),
            None => Ok(None),
        }
    }

    async fn complete(&mut self, row: &DatabaseRow) -> Result<Collaboration, StoreError> {
        let collaboration_id: CollaborationId = row.parsed("collaboration_id")?;
        let sql = "SELECT organisation_id FROM collaboration_member WHERE collaboration_id = $1
                   ORDER BY organisation_id";
        let members = sqlx::query(sql)
            .bind(collaboration_id.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list members"))?;
        let sql = "SELECT factory_id FROM collaboration_factory WHERE collaboration_id = $1 ORDER BY factory_id";
        let factories = sqlx::query(sql)
            .bind(collaboration_id.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list a collaboration's factories"))?;
        Ok(Collaboration {
            name: row.column("name")?,
            created_at: row.time("created_at")?,
            members: members
                .iter()
                .map(|row| row.parsed("organisation_id"))
                .collect::<Result<_, _>>()?,
            factories: factories
                .iter()
                .map(|row| row.parsed("factory_id"))
                .collect::<Result<_, _>>()?,
            collaboration_id,
        })
    }
}
