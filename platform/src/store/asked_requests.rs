//! Requests with the factories that are asked for them, or ever were. No row is ever removed.

use asi_model::{DynamicDataRequestId, FactoryId, OperationId, OperationNetworkId, RequestKey};

use super::{database::Connection, error::StoreError, row::Columns};

/// Repository of the factories that were asked.
pub struct AskedRequests<'w>(pub(super) &'w mut Connection);

impl AskedRequests<'_> {
    /// Records that a factory is asked for a request.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(
        &mut self,
        request: &RequestKey,
        factory: &FactoryId,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO asked_request (operation_network_id, dynamic_data_request_id, factory_id, operation_id)
                   VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING";
        sqlx::query(sql)
            .bind(request.operation_network_id.as_str())
            .bind(request.dynamic_data_request_id.as_str())
            .bind(factory.as_str())
            .bind(request.operation_id.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note who is asked"))?;
        Ok(())
    }

    /// Lists the factories that were ever asked for a request, each with the operation that it was
    /// about.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_request(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
    ) -> Result<Vec<(FactoryId, OperationId)>, StoreError> {
        let sql = "SELECT factory_id, operation_id FROM asked_request
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who was asked"))?;
        rows.iter()
            .map(|row| Ok((row.parsed("factory_id")?, row.parsed("operation_id")?)))
            .collect()
    }

    /// Returns true where a factory is asked for a request, or ever was.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn is_asked(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
        factory: &FactoryId,
    ) -> Result<bool, StoreError> {
        Ok(self.of_request(network, request).await?.iter().any(|(asked, _)| asked == factory))
    }
}
