//! Enrolment tokens and the credentials of connectors and tools at the broker: hashes only.

use asi_model::{DateTime, FactoryId, OrganisationId};

use super::{
    database::Connection, error::StoreError, holder::Holder, revoked_access::RevokedAccess,
    row::Columns,
};

/// A credential that is alive.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrokerCredential {
    /// Holder of the credential.
    pub holder: Holder,
    /// The SHA-256 of its secret.
    pub secret_hash: [u8; 32],
}

/// Valid credentials of one holder: the one in use and the one being rotated in.
const ALIVE_MAX: i64 = 2;

/// Repository of enrolment tokens and broker credentials.
pub struct Credentials<'w>(pub(super) &'w mut Connection);

impl Credentials<'_> {
    /// Stores a new token; tokens that have ended are forgotten.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add_token(
        &mut self,
        hash: &[u8; 32],
        factory: &FactoryId,
        now: DateTime,
        expires_at: DateTime,
    ) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM enrolment_token WHERE expires_at <= $1")
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("forget ended enrolment tokens"))?;
        let sql = "INSERT INTO enrolment_token (token_hash, factory_id, created_at, expires_at)
                   VALUES ($1, $2, $3, $4)";
        sqlx::query(sql)
            .bind(&hash[..])
            .bind(factory.as_str())
            .bind(now.ticks())
            .bind(expires_at.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store an enrolment token"))?;
        Ok(())
    }

    /// Returns true for a token that is unused and alive.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn is_usable(&mut self, hash: &[u8; 32], now: DateTime) -> Result<bool, StoreError> {
        let sql = "SELECT 1 FROM enrolment_token
                   WHERE token_hash = $1 AND used_at IS NULL AND expires_at > $2";
        let found = sqlx::query(sql)
            .bind(&hash[..])
            .bind(now.ticks())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look an enrolment token up"))?;
        Ok(found.is_some())
    }

    /// Uses a token up: whose it was, if it was unused and alive.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn use_token(
        &mut self,
        hash: &[u8; 32],
        now: DateTime,
    ) -> Result<Option<FactoryId>, StoreError> {
        let sql = "UPDATE enrolment_token SET used_at = $2
                   WHERE token_hash = $1 AND used_at IS NULL AND expires_at > $2 RETURNING factory_id";
        let row = sqlx::query(sql)
            .bind(&hash[..])
            .bind(now.ticks())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("use an enrolment token"))?;
        row.map(|row| row.parsed("factory_id")).transpose()
    }

    /// Adds a credential; of several only the newest two stay alive.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn add(
        &mut self,
        credential: &BrokerCredential,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO broker_credential (holder_kind, holder_id, secret_hash, created_at)
                   VALUES ($1, $2, $3, $4)";
        sqlx::query(sql)
            .bind(credential.holder.kind())
            .bind(credential.holder.id())
            .bind(&credential.secret_hash[..])
            .bind(now.ticks())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a credential"))?;
        let sql = "DELETE FROM broker_credential WHERE holder_kind = $1 AND holder_id = $2 AND credential_id NOT IN (
                       SELECT credential_id FROM broker_credential WHERE holder_kind = $1 AND holder_id = $2
                       ORDER BY credential_id DESC LIMIT $3)";
        sqlx::query(sql)
            .bind(credential.holder.kind())
            .bind(credential.holder.id())
            .bind(ALIVE_MAX)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("retire older credentials"))?;
        Ok(())
    }

    /// Takes all credentials and unused tokens of a holder away; how many credentials there were. Until it enrols
    /// again it has no access, whatever a broker of another make says.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn revoke(&mut self, holder: &Holder, now: DateTime) -> Result<u64, StoreError> {
        RevokedAccess(&mut *self.0).revoke(holder, now).await?;
        if let Holder::Factory(factory) = holder {
            sqlx::query("DELETE FROM enrolment_token WHERE factory_id = $1 AND used_at IS NULL")
                .bind(factory.as_str())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("revoke enrolment tokens"))?;
        }
        let result =
            sqlx::query("DELETE FROM broker_credential WHERE holder_kind = $1 AND holder_id = $2")
                .bind(holder.kind())
                .bind(holder.id())
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("revoke credentials"))?;
        Ok(result.rows_affected())
    }

    /// Returns all credentials that are not revoked.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn list(
        &mut self,
    ) -> Result<Vec<(BrokerCredential, Option<OrganisationId>)>, StoreError> {
        let sql = "SELECT c.*, COALESCE(f.organisation_id, t.organisation_id) AS organisation_id
                   FROM broker_credential c
                   LEFT JOIN factory f ON c.holder_kind = 'FACTORY' AND f.factory_id = c.holder_id
                   LEFT JOIN tool t ON c.holder_kind = 'TOOL' AND t.tool_id = c.holder_id
                   ORDER BY c.credential_id";
        let rows = sqlx::query(sql)
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list credentials"))?;
        rows.iter()
            .map(|row| {
                let kind: String = row.column("holder_kind")?;
                let holder = if kind == "FACTORY" {
                    Holder::Factory(row.parsed("holder_id")?)
                } else {
                    Holder::Tool(row.parsed("holder_id")?)
                };
                let hash: Vec<u8> = row.column("secret_hash")?;
                let secret_hash = hash.try_into().map_err(|_| StoreError::Corrupt {
                    column: "secret_hash",
                    reason: "it does not have 32 bytes".to_owned(),
                })?;
                let organisation = row.parsed_option("organisation_id")?;
                Ok((BrokerCredential { holder, secret_hash }, organisation))
            })
            .collect()
    }
}
