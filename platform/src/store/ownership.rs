//! Owners of networks, of their operations and of request ids, and who may read a network.

use std::collections::{HashMap, HashSet};

use asi_model::{
    CollaborationId, DynamicDataRequestId, OperationId, OperationNetworkId, OrganisationId,
    network::OperationNetwork,
};

use super::{
    database::Connection,
    error::StoreError,
    row::Columns,
    visibility::{NetworkOwners, viewers},
};

/// Repository of owners.
pub struct Ownership<'w>(pub(super) &'w mut Connection);

impl Ownership<'_> {
    /// Returns the owners of a network that `drawn_by` drew, and of what is in it.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_network(
        &mut self,
        id: &OperationNetworkId,
        collaboration: &CollaborationId,
        drawn_by: Option<&OrganisationId>,
    ) -> Result<NetworkOwners, StoreError> {
        let sql = "SELECT f.factory_id, f.organisation_id FROM collaboration_factory c
                   JOIN factory f ON f.factory_id = c.factory_id WHERE c.collaboration_id = $1";
        let factories = sqlx::query(sql)
            .bind(collaboration.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the owners of factories"))?;
        let sql = "SELECT operation_id, organisation_id FROM operation_drawer
                   WHERE operation_network_id = $1";
        let drawers = sqlx::query(sql)
            .bind(id.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list who drew operations"))?;
        Ok(NetworkOwners {
            drawn_by: drawn_by.cloned(),
            factories: factories
                .iter()
                .map(|row| Ok((row.parsed("factory_id")?, row.parsed("organisation_id")?)))
                .collect::<Result<_, StoreError>>()?,
            drawers: drawers
                .iter()
                .map(|row| Ok((row.parsed("operation_id")?, row.parsed("organisation_id")?)))
                .collect::<Result<_, StoreError>>()?,
            consents: self.consents(id).await?,
        })
    }

    /// Lists the requests of which a field is open, with the requester and the recipients to whom the
    /// factory consented.
    async fn consents(
        &mut self,
        id: &OperationNetworkId,
    ) -> Result<HashSet<(DynamicDataRequestId, OrganisationId)>, StoreError> {
        let sql = "WITH open AS (SELECT DISTINCT dynamic_data_request_id FROM request_field
                       WHERE operation_network_id = $1 AND mapping_state = 'MAPPED')
                   SELECT o.dynamic_data_request_id, q.requester_id AS organisation_id FROM open o
                   JOIN request_requester q ON q.operation_network_id = $1
                       AND q.dynamic_data_request_id = o.dynamic_data_request_id
                   UNION SELECT o.dynamic_data_request_id, r.organisation_id FROM open o
                   JOIN request_recipient r ON r.operation_network_id = $1
                       AND r.dynamic_data_request_id = o.dynamic_data_request_id
                       AND r.consented_at IS NOT NULL";
        let rows = sqlx::query(sql)
            .bind(id.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list to whom fields are open"))?;
        rows.iter()
            .map(|row| Ok((row.parsed("dynamic_data_request_id")?, row.parsed("organisation_id")?)))
            .collect()
    }

    /// Stores who drew the operations of a revision, who sees anything of it, and who uses its
    /// request ids from now on.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown network.
    pub async fn put(
        &mut self,
        network: &OperationNetwork,
        owners: &NetworkOwners,
    ) -> Result<(), StoreError> {
        let id = &network.operation_network_id;
        self.put_drawers(network, owners).await?;
        self.clear("DELETE FROM network_viewer WHERE operation_network_id = $1", id).await?;
        for (organisation, factory) in viewers(network, owners) {
            let sql =
                "INSERT INTO network_viewer (operation_network_id, organisation_id, factory_id)
                       VALUES ($1, $2, $3)";
            self.insert(sql, id, organisation.as_str(), factory.as_str()).await?;
        }
        for (key, _, request) in network.requests() {
            let sql = "INSERT INTO request_requester (operation_network_id, dynamic_data_request_id, requester_id)
                       VALUES ($1, $2, $3) ON CONFLICT DO NOTHING";
            let request_id = key.dynamic_data_request_id.as_str();
            self.insert(sql, id, request_id, request.requester_id.as_str()).await?;
        }
        Ok(())
    }

    async fn put_drawers(
        &mut self,
        network: &OperationNetwork,
        owners: &NetworkOwners,
    ) -> Result<(), StoreError> {
        let id = &network.operation_network_id;
        let known: HashSet<&OperationId> =
            network.operation_list.iter().map(|operation| &operation.operation_id).collect();
        self.clear("DELETE FROM operation_drawer WHERE operation_network_id = $1", id).await?;
        for (operation, organisation) in &owners.drawers {
            if known.contains(operation) {
                let sql = "INSERT INTO operation_drawer (operation_network_id, operation_id, organisation_id)
                           VALUES ($1, $2, $3)";
                self.insert(sql, id, operation.as_str(), organisation.as_str()).await?;
            }
        }
        Ok(())
    }

    /// Returns the first requester of each request id that was ever used in a network.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn requesters(
        &mut self,
        network: &OperationNetworkId,
    ) -> Result<HashMap<DynamicDataRequestId, OrganisationId>, StoreError> {
        let sql = "SELECT dynamic_data_request_id, requester_id FROM request_requester
                   WHERE operation_network_id = $1";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the users of request ids"))?;
        rows.iter()
            .map(|row| Ok((row.parsed("dynamic_data_request_id")?, row.parsed("requester_id")?)))
            .collect()
    }

    /// Lists the organisations that may read anything of a network, by id.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn readers(
        &mut self,
        network: &OperationNetworkId,
    ) -> Result<Vec<OrganisationId>, StoreError> {
        let sql = "SELECT organisation_id FROM network_reader WHERE operation_network_id = $1
                   ORDER BY organisation_id";
        let rows = sqlx::query(sql)
            .bind(network.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the readers of a network"))?;
        rows.iter().map(|row| row.parsed("organisation_id")).collect()
    }

    /// Returns the stored viewers of a network, ordered.
    #[cfg(test)]
    pub(super) async fn stored_viewers(
        &mut self,
        network: &OperationNetworkId,
    ) -> Vec<(String, String)> {
        let sql = "SELECT organisation_id, factory_id FROM network_viewer
                   WHERE operation_network_id = $1 ORDER BY organisation_id, factory_id";
        let rows = sqlx::query_as(sql).bind(network.as_str()).fetch_all(&mut *self.0).await;
        rows.expect("read")
    }

    async fn clear(
        &mut self,
        sql: &'static str,
        network: &OperationNetworkId,
    ) -> Result<(), StoreError> {
        sqlx::query(sql)
            .bind(network.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget the owners of a revision"))?;
        Ok(())
    }

    async fn insert(
        &mut self,
        sql: &'static str,
        network: &OperationNetworkId,
        first: &str,
        second: &str,
    ) -> Result<(), StoreError> {
        sqlx::query(sql)
            .bind(network.as_str())
            .bind(first)
            .bind(second)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store the owners of a revision"))?;
        Ok(())
    }
}
