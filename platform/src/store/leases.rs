//! Leases of factories' identities.

use asi_model::FactoryId;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, document, signed},
};
use crate::leases::FactoryLease;

/// Repository of leases on factories' identities.
pub struct Leases<'w>(pub(super) &'w mut Connection);

impl Leases<'_> {
    /// Looks up a factory's lease; none when no connector has requested it yet.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        factory: &FactoryId,
    ) -> Result<Option<FactoryLease>, StoreError> {
        let row =
            sqlx::query("SELECT lease_number, holder, contenders FROM lease WHERE factory_id = $1")
                .bind(factory.as_str())
                .fetch_optional(&mut *self.0)
                .await
                .map_err(StoreError::during("look a lease up"))?;
        row.map(|row| {
            Ok(FactoryLease {
                number: row.unsigned("lease_number")?,
                holder: row.json("holder")?,
                contenders: row.json("contenders")?,
            })
        })
        .transpose()
    }

    /// Stores a factory's lease.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown factory.
    pub async fn put(
        &mut self,
        factory: &FactoryId,
        lease: &FactoryLease,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO lease (factory_id, lease_number, holder, contenders) VALUES ($1, $2, $3, $4)
                   ON CONFLICT (factory_id) DO UPDATE SET lease_number = excluded.lease_number,
                       holder = excluded.holder, contenders = excluded.contenders";
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(signed(lease.number))
            .bind(document(&lease.holder))
            .bind(document(&lease.contenders))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a lease"))?;
        Ok(())
    }
}
