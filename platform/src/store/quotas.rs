//! Rows and bytes that are kept of a factory, a person or an organisation, to hold them against quotas.

use asi_model::{AssetId, FactoryId, OperationNetworkId, OrganisationId};
use messaging::LogicalAddress;
use sqlx::sqlite::SqliteArguments;

use super::{
    database::{Connection, Database},
    error::StoreError,
    row::Columns,
};

/// Rows and their bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Kept {
    pub rows: u64,
    /// Bytes of the documents in them.
    pub bytes: u64,
}

/// Repository of what is kept, over several nouns.
pub struct Quotas<'w>(pub(super) &'w mut Connection);

impl Quotas<'_> {
    /// Returns what is kept of the messages and reports of a factory or tool, by its address.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_sender(&mut self, address: &LogicalAddress) -> Result<Kept, StoreError> {
        // A sum, so that there is a row for a sender of which nothing is kept.
        let sql = "SELECT COALESCE(SUM(number), 0) AS number, COALESCE(SUM(bytes), 0) AS bytes
                   FROM kept_of_sender WHERE address = $1";
        self.kept(sqlx::query(sql).bind(address.to_string()), "count what is kept").await
    }

    /// Returns the number of senders of which something is kept, and the bytes of all together.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_all_senders(&mut self) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number, COALESCE(SUM(bytes), 0) AS bytes FROM kept_of_sender";
        self.kept(sqlx::query(sql), "count what is kept of all").await
    }

    /// Returns what is kept of the metadata of a factory's writers other than this one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn meta_data(
        &mut self,
        factory: &FactoryId,
        except: u16,
    ) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number, COALESCE(SUM(octet_length(body)), 0) AS bytes
                   FROM writer_meta_data WHERE factory_id = $1 AND data_set_writer_id <> $2";
        let query = sqlx::query(sql).bind(factory.as_str()).bind(i64::from(except));
        self.kept(query, "count metadata").await
    }

    /// Returns what is kept of a factory's offers of other assets than this one.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn offers(
        &mut self,
        factory: &FactoryId,
        except: &AssetId,
    ) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number,
                       COALESCE(SUM(octet_length(description) + octet_length(kind_list)), 0) AS bytes
                   FROM asset_offer WHERE factory_id = $1 AND asset_id <> $2";
        let query = sqlx::query(sql).bind(factory.as_str()).bind(except.as_str());
        self.kept(query, "count offers").await
    }

    /// Returns the number of ranges of the past that a factory released.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn past_releases(&mut self, factory: &FactoryId) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number, 0 AS bytes FROM past_release WHERE factory_id = $1";
        self.kept(sqlx::query(sql).bind(factory.as_str()), "count releases of the past").await
    }

    /// Returns what is kept of a factory's receipts of revocations.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn revocations(&mut self, factory: &FactoryId) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number, COALESCE(SUM(octet_length(signed_text)), 0) AS bytes
                   FROM revocation WHERE factory_id = $1";
        self.kept(sqlx::query(sql).bind(factory.as_str()), "count revocations").await
    }

    /// Returns what is kept of a factory's logs other than the one for this recipient in this epoch.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn ledger_logs(
        &mut self,
        factory: &FactoryId,
        (recipient, epoch): (&OrganisationId, u32),
    ) -> Result<Kept, StoreError> {
        let sql = "SELECT COUNT(*) AS number, COALESCE(SUM(octet_length(checkpoint)
                       + COALESCE(octet_length(refused_checkpoint), 0)), 0) AS bytes
                   FROM ledger_log WHERE factory_id = $1 AND NOT (organisation_id = $2 AND epoch = $3)";
        let query =
            sqlx::query(sql).bind(factory.as_str()).bind(recipient.as_str()).bind(i64::from(epoch));
        self.kept(query, "count the logs of a ledger").await
    }

    /// Returns what is kept of a factory's comments on a network.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn comments_of_factory(
        &mut self,
        network: &OperationNetworkId,
        factory: &FactoryId,
    ) -> Result<Kept, StoreError> {
        let sql =
            "SELECT COUNT(*) AS number, COALESCE(SUM(octet_length(text)), 0) AS bytes FROM comment
                   WHERE operation_network_id = $1 AND factory_id = $2 AND is_from_factory = 1";
        let query = sqlx::query(sql).bind(network.as_str()).bind(factory.as_str());
        self.kept(query, "count comments").await
    }

    /// Returns what is kept of a person's comments on a network.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn comments_of_person(
        &mut self,
        network: &OperationNetworkId,
        person: &str,
    ) -> Result<Kept, StoreError> {
        let sql =
            "SELECT COUNT(*) AS number, COALESCE(SUM(octet_length(text)), 0) AS bytes FROM comment
                   WHERE operation_network_id = $1 AND author_id = $2 AND is_from_factory = 0";
        let query = sqlx::query(sql).bind(network.as_str()).bind(person);
        self.kept(query, "count comments").await
    }

    /// Returns the number of networks that an organisation drew, withdrawn ones included: these stay.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn networks(&mut self, drawn_by: &OrganisationId) -> Result<u64, StoreError> {
        let sql =
            "SELECT COUNT(*) AS number, 0 AS bytes FROM operation_network WHERE drawn_by = $1";
        let query = sqlx::query(sql).bind(drawn_by.as_str());
        Ok(self.kept(query, "count networks").await?.rows)
    }

    async fn kept(
        &mut self,
        query: sqlx::query::Query<'_, Database, SqliteArguments>,
        action: &'static str,
    ) -> Result<Kept, StoreError> {
        let row = query.fetch_one(&mut *self.0).await.map_err(StoreError::during(action))?;
        Ok(Kept { rows: row.unsigned("number")?, bytes: row.unsigned("bytes")? })
    }
}
