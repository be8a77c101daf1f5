//! Recipients of requests.

use asi_model::{OperationNetworkId, OrganisationId, network::DynamicDataRequest};

use super::{database::Connection, error::StoreError, row::Columns};

/// Repository of recipients of requests.
pub struct Recipients<'w>(pub(super) &'w mut Connection);

impl Recipients<'_> {
    /// Makes the request's list the one in effect. Those of requests that are gone stay, for the
    /// reports of their time.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn replace(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequest,
    ) -> Result<(), StoreError> {
        let id = request.dynamic_data_request_id.as_str();
        let sql = "DELETE FROM request_recipient WHERE operation_network_id = $1 AND dynamic_data_request_id = $2";
        sqlx::query(sql)
            .bind(network.as_str())
            .bind(id)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget recipients"))?;
        for recipient in &request.recipient_list {
            let sql = "INSERT INTO request_recipient (operation_network_id, dynamic_data_request_id, organisation_id)
                       VALUES ($1, $2, $3) ON CONFLICT DO NOTHING";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(id)
                .bind(recipient.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a recipient"))?;
        }
        Ok(())
    }

    /// Lists the organisations that may see the answers of a request, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_request(
        &mut self,
        network: &OperationNetworkId,
        request: &str,
    ) -> Result<Vec<OrganisationId>, StoreError> {
        let sql = "SELECT organisation_id FROM request_recipient
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 ORDER BY organisation_id";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list recipients"))?;
        rows.iter().map(|row| row.parsed("organisation_id")).collect()
    }
}
