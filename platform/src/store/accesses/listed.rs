//! Accesses as the factory's organisation reads them.

use access_log::AccessEntry;
use asi_model::{DynamicDataRequestId, FactoryId, OperationNetworkId, OrganisationId};

use super::Accesses;
use crate::store::{
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
    scope::Scope,
};

/// Filter and page of accesses, newest first.
#[derive(Debug, Clone, Default)]
pub struct AccessQuery {
    /// Restricts to this viewer.
    pub viewer: Option<OrganisationId>,
    /// Restricts to this network.
    pub network: Option<OperationNetworkId>,
    /// Restricts to this request.
    pub request: Option<DynamicDataRequestId>,
    /// Restricts to smaller numbers.
    pub before: Option<u64>,
    /// Most accesses to return.
    pub limit: u32,
}

/// An entry as the viewer may see it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedAccess {
    pub entry: AccessEntry,
    /// Name of the person or tool, where it is one of the viewer's own organisation.
    pub agent_name: Option<String>,
}

/// Condition on a row `e` of `access_entry`: its factory `$1` is one of the organisation `$2`.
macro_rules! own {
    () => {
        "e.factory_id = $1 AND (CAST($2 AS TEXT) IS NULL OR EXISTS (
             SELECT 1 FROM factory f WHERE f.factory_id = e.factory_id AND f.organisation_id = $2))"
    };
}

impl Accesses<'_> {
    /// Lists accesses to the values of a factory of the viewer's organisation.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
        scope: &Scope,
        factory: &FactoryId,
        query: &AccessQuery,
    ) -> Result<Vec<ListedAccess>, StoreError> {
        let sql = concat!(
            "SELECT e.content, a.name AS agent_name FROM access_entry e
             LEFT JOIN access_agent a ON a.factory_id = e.factory_id AND a.agent_id = e.agent_id
                 AND a.organisation_id = $2
             WHERE ",
            own!(),
            // Statements of retention have no viewer.
            " AND e.viewer_id <> '' AND (CAST($3 AS TEXT) IS NULL OR e.viewer_id = $3)
               AND (CAST($4 AS TEXT) IS NULL OR e.operation_network_id = $4)
               AND (CAST($5 AS TEXT) IS NULL OR e.dynamic_data_request_id = $5)
               AND (CAST($6 AS INTEGER) IS NULL OR e.number < $6)
             ORDER BY e.number DESC LIMIT $7"
        );
        let rows = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(scope.recipient())
            .bind(query.viewer.as_ref().map(OrganisationId::as_str))
            .bind(query.network.as_ref().map(OperationNetworkId::as_str))
            .bind(query.request.as_ref().map(DynamicDataRequestId::as_str))
            .bind(query.before.map(signed))
            .bind(i64::from(query.limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list accesses"))?;
        rows.iter().map(read).collect()
    }

    /// Returns the texts of entries with numbers after `after`, in their order, of a factory of the
    /// viewer's organisation.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn texts(
        &mut self,
        scope: &Scope,
        factory: &FactoryId,
        after: u64,
        limit: u32,
    ) -> Result<Vec<(u64, String)>, StoreError> {
        let sql = concat!(
            "SELECT e.number, e.content FROM access_entry e WHERE ",
            own!(),
            " AND e.number > $3 ORDER BY e.number LIMIT $4"
        );
        let rows = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(scope.recipient())
            .bind(signed(after))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("read accesses"))?;
        rows.iter().map(|row| Ok((row.unsigned("number")?, row.column("content")?))).collect()
    }
}

fn read(row: &DatabaseRow) -> Result<ListedAccess, StoreError> {
    Ok(ListedAccess { entry: row.json("content")?, agent_name: row.column("agent_name")? })
}
