//! Descriptions of data by factories: metadata of writers, and offered assets.

use asi_model::{DateTime, FactoryId, messages::AssetOffer};

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, document},
};

/// Repository of metadata and offers.
pub struct MetaData<'w>(pub(super) &'w mut Connection);

impl MetaData<'_> {
    /// Stores the newest metadata message of a writer.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put(
        &mut self,
        factory: &FactoryId,
        writer: u16,
        now: DateTime,
        body: &str,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO writer_meta_data (factory_id, data_set_writer_id, received_at, body)
                   VALUES ($1, $2, $3, $4) ON CONFLICT (factory_id, data_set_writer_id) DO UPDATE SET
                       received_at = excluded.received_at, body = excluded.body";
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(i64::from(writer))
            .bind(now.ticks())
            .bind(body)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store metadata"))?;
        Ok(())
    }

    /// Returns the metadata messages of all writers, as they came.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(&mut self) -> Result<Vec<(FactoryId, String)>, StoreError> {
        let rows = sqlx::query("SELECT factory_id, body FROM writer_meta_data")
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list metadata"))?;
        rows.iter().map(|row| Ok((row.parsed("factory_id")?, row.column("body")?))).collect()
    }

    /// Stores what a factory says could be asked of an asset.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn put_offer(&mut self, offer: &AssetOffer, now: DateTime) -> Result<(), StoreError> {
        let sql =
            "INSERT INTO asset_offer (factory_id, asset_id, kind_list, description, received_at)
                   VALUES ($1, $2, $3, $4, $5) ON CONFLICT (factory_id, asset_id) DO UPDATE SET
                       kind_list = excluded.kind_list, description = excluded.description,
                       received_at = excluded.received_at";
        sqlx::query(sql)
            .bind(offer.factory_id.as_str())
            .bind(offer.asset_id.as_str())
            .bind(document(&offer.kind_list))
            .bind(&offer.description)
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store an offer"))?;
        Ok(())
    }
}
