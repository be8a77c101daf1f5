//! Keys with which factories' connectors sign their messages.

use asi_model::{DateTime, FactoryId};
use message_signature::PublicKey;
use transparency_log::VerifierKey;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow},
};
use crate::signing::SigningState;

/// Keys of one factory that count: the one in use and the one that comes with a new enrolment, as with
/// credentials.
const PINNED_MAX: i64 = 2;

/// Repository of the keys that sign for factories.
pub struct SigningKeys<'w>(pub(super) &'w mut Connection);

impl SigningKeys<'_> {
    /// Reads what is known of a factory's signatures.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_factory(&mut self, factory: &FactoryId) -> Result<SigningState, StoreError> {
        let sql = "SELECT f.signs_since, k.public_key FROM factory f
                   LEFT JOIN signing_key k ON k.factory_id = f.factory_id
                   WHERE f.factory_id = $1 ORDER BY k.signing_key_id";
        let rows = sqlx::query(sql)
            .bind(factory.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("read the keys that sign for a factory"))?;
        let mut state = SigningState::default();
        for row in &rows {
            state.must_sign = row.time_option("signs_since")?.is_some();
            state.pinned.extend(public_key(row)?);
        }
        if state.pinned.is_empty() {
            state.of_ledger = self.of_ledger(factory).await?;
        }
        Ok(state)
    }

    async fn of_ledger(&mut self, factory: &FactoryId) -> Result<Vec<PublicKey>, StoreError> {
        let sql = "SELECT DISTINCT verifier_key FROM ledger_log WHERE factory_id = $1";
        let rows = sqlx::query(sql)
            .bind(factory.as_str())
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("read the keys of a factory's ledger"))?;
        rows.iter()
            .map(|row| {
                let key: VerifierKey = row.parsed("verifier_key")?;
                read(key.public_key(), "verifier_key")
            })
            .collect()
    }

    /// Pins the key of a factory's first signed message.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown factory.
    pub async fn pin(
        &mut self,
        factory: &FactoryId,
        key: &PublicKey,
        now: DateTime,
    ) -> Result<(), StoreError> {
        // Removed and added again, so that it is the newest.
        sqlx::query("DELETE FROM signing_key WHERE factory_id = $1 AND public_key = $2")
            .bind(factory.as_str())
            .bind(&key.as_bytes()[..])
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("renew a key that signs for a factory"))?;
        sqlx::query(
            "INSERT INTO signing_key (factory_id, public_key, pinned_at) VALUES ($1, $2, $3)",
        )
        .bind(factory.as_str())
        .bind(&key.as_bytes()[..])
        .bind(now.ticks())
        .execute(&mut *self.0)
        .await
        .map_err(StoreError::during("pin a key that signs for a factory"))?;
        let sql = "DELETE FROM signing_key WHERE factory_id = $1 AND signing_key_id NOT IN (
                       SELECT signing_key_id FROM signing_key WHERE factory_id = $1
                       ORDER BY signing_key_id DESC LIMIT $2)";
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(PINNED_MAX)
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("retire older keys of a factory"))?;
        sqlx::query(
            "UPDATE factory SET signs_since = COALESCE(signs_since, $2) WHERE factory_id = $1",
        )
        .bind(factory.as_str())
        .bind(now.ticks())
        .execute(&mut *self.0)
        .await
        .map_err(StoreError::during("note that a factory signs"))?;
        Ok(())
    }

    /// Takes all keys of a factory away. It has to sign all the same, with any key: the first one is
    /// pinned again.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn forget(&mut self, factory: &FactoryId) -> Result<(), StoreError> {
        sqlx::query("DELETE FROM signing_key WHERE factory_id = $1")
            .bind(factory.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("take the keys of a factory away"))?;
        Ok(())
    }

    /// Notes that a connector enrolled which does not sign: as before the first signature.
    ///
    /// # Errors
    /// [`StoreError::Statement`].
    pub async fn begin_unsigned(&mut self, factory: &FactoryId) -> Result<(), StoreError> {
        self.forget(factory).await?;
        sqlx::query("UPDATE factory SET signs_since = NULL WHERE factory_id = $1")
            .bind(factory.as_str())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("note that a factory does not sign"))?;
        Ok(())
    }
}

fn public_key(row: &DatabaseRow) -> Result<Option<PublicKey>, StoreError> {
    let bytes: Option<Vec<u8>> = row.column("public_key")?;
    bytes.map(|bytes| read(&bytes, "public_key")).transpose()
}

fn read(bytes: &[u8], column: &'static str) -> Result<PublicKey, StoreError> {
    PublicKey::from_bytes(bytes)
        .map_err(|error| StoreError::Corrupt { column, reason: error.to_string() })
}
