//! Collaborations: agreements under which networks are exchanged.

use std::{collections::HashMap, fmt::Display, str::FromStr};

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
    pub collaboration_id: CollaborationId,
    /// Name for people.
    pub name: String,
    /// Addition, by the platform's clock.
    pub created_at: DateTime,
    /// The organisations that take part, by id.
    pub members: Vec<OrganisationId>,
    /// The factories that take part, by id.
    pub factories: Vec<FactoryId>,
}

/// Condition on a table `c` with a collaboration's id: visible to `$1`, and the one with the id `$2`
/// where that is given.
macro_rules! visible {
    () => {
        "(CAST($2 AS TEXT) IS NULL OR c.collaboration_id = $2)
         AND (CAST($1 AS TEXT) IS NULL OR EXISTS (
             SELECT 1 FROM collaboration_member m
             WHERE m.collaboration_id = c.collaboration_id AND m.organisation_id = $1))"
    };
}

/// Repository of collaborations.
pub struct Collaborations<'w>(pub(super) &'w mut Connection);

impl Collaborations<'_> {
    /// Adds one with members and factories; returns false if the id is in use.
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

    /// Adds a member; has no effect if it is one.
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

    /// Adds a factory; has no effect if it takes part.
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

    /// Lists those the viewer's organisation belongs to, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self, scope: &Scope) -> Result<Vec<Collaboration>, StoreError> {
        self.select(scope, None).await
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
        Ok(self.select(scope, Some(id)).await?.pop())
    }

    /// Reads all visible collaborations, or the one with this id, in three statements.
    async fn select(
        &mut self,
        scope: &Scope,
        id: Option<&CollaborationId>,
    ) -> Result<Vec<Collaboration>, StoreError> {
        let sql = concat!(
            "SELECT c.collaboration_id, c.name, c.created_at FROM collaboration c
             WHERE c.removed_at IS NULL AND ",
            visible!(),
            " ORDER BY c.collaboration_id"
        );
        let rows = self.rows(sql, scope, id, "list collaborations").await?;
        let sql = concat!(
            "SELECT c.collaboration_id, c.organisation_id FROM collaboration_member c WHERE ",
            visible!(),
            " ORDER BY c.organisation_id"
        );
        let members = self.rows(sql, scope, id, "list members").await?;
        let mut members = grouped(&members, "organisation_id")?;
        let sql = concat!(
            "SELECT c.collaboration_id, c.factory_id FROM collaboration_factory c WHERE ",
            visible!(),
            " ORDER BY c.factory_id"
        );
        let factories = self.rows(sql, scope, id, "list a collaboration's factories").await?;
        let mut factories = grouped(&factories, "factory_id")?;
        rows.iter()
            .map(|row| {
                let collaboration_id: CollaborationId = row.parsed("collaboration_id")?;
                Ok(Collaboration {
                    name: row.column("name")?,
                    created_at: row.time("created_at")?,
                    members: members.remove(&collaboration_id).unwrap_or_default(),
                    factories: factories.remove(&collaboration_id).unwrap_or_default(),
                    collaboration_id,
                })
            })
            .collect()
    }

    async fn rows(
        &mut self,
        sql: &'static str,
        scope: &Scope,
        id: Option<&CollaborationId>,
        action: &'static str,
    ) -> Result<Vec<DatabaseRow>, StoreError> {
        sqlx::query(sql)
            .bind(scope.member())
            .bind(id.map(CollaborationId::as_str))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during(action))
    }
}

/// Groups the values of a column by collaboration, in the order of the rows.
fn grouped<T: FromStr<Err: Display>>(
    rows: &[DatabaseRow],
    column: &'static str,
) -> Result<HashMap<CollaborationId, Vec<T>>, StoreError> {
    let mut groups: HashMap<CollaborationId, Vec<T>> = HashMap::new();
    for row in rows {
        groups.entry(row.parsed("collaboration_id")?).or_default().push(row.parsed(column)?);
    }
    Ok(groups)
}
