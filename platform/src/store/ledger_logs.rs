//! Logs of factories' ledgers as far as the platform has countersigned them.

use asi_model::{FactoryId, OrganisationId};
use transparency_log::{SignedNote, TreeHead};

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
    scope::Scope,
};
use crate::witness::WitnessedLog;

/// Repository of countersigned logs.
pub struct LedgerLogs<'w>(pub(super) &'w mut Connection);

const COLUMNS: &str = "l.organisation_id, l.epoch, l.verifier_key, l.checkpoint, l.size, l.root,
    l.cosigned_at, l.first_size, l.first_seen_at, l.refused_checkpoint, l.refused_at";

impl LedgerLogs<'_> {
    /// Looks up the log with the highest epoch of what a factory discloses to an organisation.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest(
        &mut self,
        factory: &FactoryId,
        recipient: &OrganisationId,
    ) -> Result<Option<WitnessedLog>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM ledger_log l
             WHERE l.factory_id = $1 AND l.organisation_id = $2 ORDER BY l.epoch DESC LIMIT 1"
        );
        let row = sqlx::query(sqlx::AssertSqlSafe(sql))
            .bind(factory.as_str())
            .bind(recipient.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look a ledger's log up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Lists a factory's logs that the viewer may see: those about itself, and all of its own
    /// factory. By recipient, the newest epoch of each last; from behind the log of recipient and epoch `after`.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn of_factory(
        &mut self,
        scope: &Scope,
        factory: &FactoryId,
        after: Option<(&str, u32)>,
        limit: u32,
    ) -> Result<Vec<(OrganisationId, WitnessedLog)>, StoreError> {
        let sql = format!(
            "SELECT {COLUMNS} FROM ledger_log l JOIN factory f ON f.factory_id = l.factory_id
             WHERE l.factory_id = $1 AND (CAST($2 AS TEXT) IS NULL OR l.organisation_id = $2
                 OR f.organisation_id = $2)
               AND (l.organisation_id, l.epoch) > ($3, $4)
             ORDER BY l.organisation_id, l.epoch LIMIT $5"
        );
        let (after_recipient, after_epoch) = after.unwrap_or_default();
        let rows = sqlx::query(sqlx::AssertSqlSafe(sql))
            .bind(factory.as_str())
            .bind(scope.recipient())
            .bind(after_recipient)
            .bind(i64::from(after_epoch))
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list the logs of a ledger"))?;
        rows.iter().map(|row| Ok((row.parsed("organisation_id")?, read(row)?))).collect()
    }

    /// Stores a log.
    ///
    /// # Errors
    /// [`StoreError::Statement`], as for an unknown organisation.
    pub async fn put(
        &mut self,
        factory: &FactoryId,
        recipient: &OrganisationId,
        log: &WitnessedLog,
    ) -> Result<(), StoreError> {
        let sql = "INSERT INTO ledger_log (factory_id, organisation_id, epoch, verifier_key, checkpoint, size, root,
                       cosigned_at, first_size, first_seen_at, refused_checkpoint, refused_at)
                   VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)
                   ON CONFLICT (factory_id, organisation_id, epoch) DO UPDATE SET
                       checkpoint = excluded.checkpoint, size = excluded.size, root = excluded.root,
                       cosigned_at = excluded.cosigned_at, refused_checkpoint = excluded.refused_checkpoint,
                       refused_at = excluded.refused_at";
        let (refused, refused_at) = log.refused.clone().unzip();
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(recipient.as_str())
            .bind(i64::from(log.epoch))
            .bind(log.verifier_key.to_string())
            .bind(log.checkpoint.to_string())
            .bind(signed(log.head.size))
            .bind(log.head.root.to_vec())
            .bind(log.cosigned_at.ticks())
            .bind(signed(log.first_size))
            .bind(log.first_seen_at.ticks())
            .bind(refused)
            .bind(refused_at.map(asi_model::DateTime::ticks))
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store a ledger's log"))?;
        Ok(())
    }
}

fn read(row: &DatabaseRow) -> Result<WitnessedLog, StoreError> {
    let corrupt = |column, reason: &dyn std::fmt::Display| StoreError::Corrupt {
        column,
        reason: reason.to_string(),
    };
    let note: String = row.column("checkpoint")?;
    let root: Vec<u8> = row.column("root")?;
    let root = root.try_into().map_err(|_| corrupt("root", &"a root has 32 bytes"))?;
    let refused: Option<String> = row.column("refused_checkpoint")?;
    Ok(WitnessedLog {
        epoch: row.unsigned("epoch")?,
        verifier_key: row.parsed("verifier_key")?,
        head: TreeHead { size: row.unsigned("size")?, root },
        checkpoint: SignedNote::parse(&note).map_err(|error| corrupt("checkpoint", &error))?,
        cosigned_at: row.time("cosigned_at")?,
        first_size: row.unsigned("first_size")?,
        first_seen_at: row.time("first_seen_at")?,
        refused: refused.zip(row.time_option("refused_at")?),
    })
}
