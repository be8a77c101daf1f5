//! Recipients of requests.

use asi_model::{
    DateTime, DynamicDataRequestId, FactoryId, OperationNetworkId, OrganisationId,
    network::DynamicDataRequest,
};

use super::{database::Connection, error::StoreError, row::Columns};

/// A recipient in effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recipient {
    pub organisation_id: OrganisationId,
    /// Time of the factory's first consent under which it was a recipient; absent before it.
    pub consented_at: Option<DateTime>,
}

/// Repository of recipients of requests.
pub struct Recipients<'w>(pub(super) &'w mut Connection);

impl Recipients<'_> {
    /// Makes the request's list the one in effect; those that stay keep the time of their consent.
    /// Those of requests that are gone stay, for the reports that are under way.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn replace(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequest,
    ) -> Result<(), StoreError> {
        let id = &request.dynamic_data_request_id;
        for known in self.of_request(network, id).await? {
            if request.recipient_list.contains(&known.organisation_id) {
                continue;
            }
            let sql = "DELETE FROM request_recipient WHERE operation_network_id = $1
                       AND dynamic_data_request_id = $2 AND organisation_id = $3";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(id.as_str())
                .bind(known.organisation_id.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("forget a recipient"))?;
        }
        for recipient in &request.recipient_list {
            let sql = "INSERT INTO request_recipient (operation_network_id, dynamic_data_request_id, organisation_id)
                       VALUES ($1, $2, $3) ON CONFLICT DO NOTHING";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(id.as_str())
                .bind(recipient.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a recipient"))?;
            let sql = "INSERT INTO named_recipient (operation_network_id, dynamic_data_request_id, organisation_id)
                       VALUES ($1, $2, $3) ON CONFLICT DO NOTHING";
            sqlx::query(sql)
                .bind(network.as_str())
                .bind(id.as_str())
                .bind(recipient.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("note that a recipient was named"))?;
        }
        Ok(())
    }

    /// Notes that the factory opened a field of a request to its recipients. Nothing is noted while
    /// the factory has not answered the newest revision: the consent may be to an older one.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn consent(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
        factory: &FactoryId,
        consented_at: DateTime,
    ) -> Result<(), StoreError> {
        let sql = "UPDATE request_recipient SET consented_at = $4
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 AND consented_at IS NULL
                     AND EXISTS (SELECT 1 FROM network_part p WHERE p.operation_network_id = $1
                         AND p.factory_id = $3 AND p.state IN ('ACCEPTED', 'UNCHANGED'))";
        sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .bind(factory.as_str())
            .bind(consented_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note a consent"))?;
        Ok(())
    }

    /// Notes the consents under which a factory answered the newest revision: a field that is open
    /// then was opened to the recipients in effect.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn consent_where_open(
        &mut self,
        network: &OperationNetworkId,
        factory: &FactoryId,
    ) -> Result<(), StoreError> {
        let sql = "UPDATE request_recipient SET consented_at = (SELECT MIN(f.decided_at) FROM request_field f
                       WHERE f.operation_network_id = request_recipient.operation_network_id
                         AND f.dynamic_data_request_id = request_recipient.dynamic_data_request_id
                         AND f.factory_id = $2 AND f.mapping_state = 'MAPPED')
                   WHERE operation_network_id = $1 AND consented_at IS NULL";
        sqlx::query(sql)
            .bind(network.as_str())
            .bind(factory.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note the consents of a revision"))?;
        Ok(())
    }

    /// Lists the organisations that may see the answers of a request, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_request(
        &mut self,
        network: &OperationNetworkId,
        request: &DynamicDataRequestId,
    ) -> Result<Vec<Recipient>, StoreError> {
        let sql = "SELECT organisation_id, consented_at FROM request_recipient
                   WHERE operation_network_id = $1 AND dynamic_data_request_id = $2 ORDER BY organisation_id";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .bind(request.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list recipients"))?;
        rows.iter()
            .map(|row| {
                Ok(Recipient {
                    organisation_id: row.parsed("organisation_id")?,
                    consented_at: row.time_option("consented_at")?,
                })
            })
            .collect()
    }
}
