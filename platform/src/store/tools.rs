//! Tools: partners' programs that post data requests and receive reports over the broker.

use asi_model::{
    DateTime, DynamicDataRequestId, OperationNetworkId, OrganisationId, ToolId,
    network::DynamicDataRequest,
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
    scope::Scope,
};

/// A tool of an organisation; it may do what a planner of that organisation may do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Tool {
    /// Its id, also part of its addresses.
    pub tool_id: ToolId,
    pub organisation_id: OrganisationId,
    /// Name for people.
    pub name: String,
    /// Addition, by the platform's clock.
    pub created_at: DateTime,
}

/// Repository of tools.
pub struct Tools<'w>(pub(super) &'w mut Connection);

impl Tools<'_> {
    /// Adds one; returns false if the id is in use.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown organisation.
    pub async fn add(&mut self, tool: &Tool) -> Result<bool, StoreError> {
        let sql =
            "INSERT INTO tool (tool_id, organisation_id, name, created_at) VALUES ($1, $2, $3, $4)
                   ON CONFLICT (tool_id) DO NOTHING";
        let result = sqlx::query(sql)
            .bind(tool.tool_id.as_str())
            .bind(tool.organisation_id.as_str())
            .bind(&tool.name)
            .bind(tool.created_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("add a tool"))?;
        Ok(result.rows_affected() == 1)
    }

    /// Lists the ids of those that have left, which are never given again.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn removed(&mut self) -> Result<Vec<ToolId>, StoreError> {
        let sql = "SELECT tool_id FROM tool WHERE removed_at IS NOT NULL ORDER BY tool_id";
        let rows = sqlx::query(sql)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list tools that have left"))?;
        rows.iter().map(|row| row.parsed("tool_id")).collect()
    }

    /// Lists those of the viewer's organisation, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self, scope: &Scope) -> Result<Vec<Tool>, StoreError> {
        let sql = "SELECT * FROM tool WHERE removed_at IS NULL
                   AND (CAST($1 AS TEXT) IS NULL OR organisation_id = $1) ORDER BY tool_id";
        let rows = sqlx::query(sql)
            .bind(scope.member())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list tools"))?;
        rows.iter().map(read).collect()
    }

    /// Looks one up; none when it does not exist.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(&mut self, scope: &Scope, id: &ToolId) -> Result<Option<Tool>, StoreError> {
        let sql = "SELECT * FROM tool WHERE tool_id = $2 AND removed_at IS NULL
                   AND (CAST($1 AS TEXT) IS NULL OR organisation_id = $1)";
        let row = sqlx::query(sql)
            .bind(scope.member())
            .bind(id.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a tool up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Makes the tool that a request names as its publisher the one that receives its reports.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn publish(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequest,
    ) -> Result<(), StoreError> {
        let sql = "DELETE FROM request_tool WHERE operation_network_id = $1 AND dynamic_data_request_id = $2";
        sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.dynamic_data_request_id.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget a request's tool"))?;
        if let Some(tool) = &request.dynamic_data_request_publisher_id {
            let sql =
                "INSERT INTO request_tool (operation_network_id, dynamic_data_request_id, tool_id)
                       VALUES ($1, $2, $3)";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(request.dynamic_data_request_id.as_str())
                .bind(tool.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("let a tool receive reports"))?;
        }
        Ok(())
    }

    /// Returns the tools that receive a request's reports, each with its organisation: the one that
    /// the request names, where it is known and its organisation a recipient.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_request(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
    ) -> Result<Vec<(ToolId, OrganisationId)>, StoreError> {
        let sql = "SELECT t.tool_id, t.organisation_id FROM request_tool rt
                   JOIN tool t ON t.tool_id = rt.tool_id AND t.removed_at IS NULL
                   JOIN request_recipient r ON r.operation_network_id = rt.operation_network_id
                       AND r.dynamic_data_request_id = rt.dynamic_data_request_id
                       AND r.organisation_id = t.organisation_id
                   WHERE rt.operation_network_id = $1 AND rt.dynamic_data_request_id = $2 ORDER BY t.tool_id";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list a request's tools"))?;
        rows.iter()
            .map(|row| Ok((row.parsed("tool_id")?, row.parsed("organisation_id")?)))
            .collect()
    }
}

fn read(row: &DatabaseRow) -> Result<Tool, StoreError> {
    Ok(Tool {
        tool_id: row.parsed("tool_id")?,
        organisation_id: row.parsed("organisation_id")?,
        name: row.column("name")?,
        created_at: row.time("created_at")?,
    })
}
