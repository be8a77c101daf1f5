//! Access logs: who read the values of each factory.

mod listed;
mod retention;

use std::collections::BTreeMap;

use access_log::{Access, AccessLog, AccessLogKey, AccessLogStart, Agent, RemovedEntries};
use asi_model::{DateTime, FactoryId};
pub use listed::{AccessQuery, ListedAccess};
pub use retention::AccessesKept;

use super::{
    database::Connection,
    error::StoreError,
    row::{Columns, DatabaseRow, signed},
};
use crate::accesses::{Reader, Reading};

const INSERT_ENTRY: &str =
    "INSERT INTO access_entry (factory_id, number, recorded_at, viewer_id, agent_id,
         operation_network_id, dynamic_data_request_id, content)
     VALUES ($1, $2, $3, $4, $5, $6, $7, $8)";

/// Log of a factory as it is stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredAccessLog {
    /// The log with all its entries, those that retention removed included.
    pub log: AccessLog,
    /// The entries that retention removed.
    pub removed: RemovedEntries,
    /// The last checkpoint, a signed note, with the number of the last entry that it covers.
    pub checkpoint: Option<(u64, String)>,
}

/// Repository of access logs.
pub struct Accesses<'w>(pub(super) &'w mut Connection);

impl Accesses<'_> {
    /// Appends readings to the logs of their factories. `new_id` makes random ids.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn append(
        &mut self,
        readings: &[Reading],
        now: DateTime,
        new_id: fn() -> String,
    ) -> Result<(), StoreError> {
        let mut by_factory: BTreeMap<&FactoryId, Vec<&Reading>> = BTreeMap::new();
        for reading in readings {
            by_factory.entry(&reading.contents.factory_id).or_default().push(reading);
        }
        for (factory, readings) in by_factory {
            let stored = match self.lookup(factory).await? {
                Some(stored) => stored,
                None => self.begin(factory, new_id()).await?,
            };
            let mut log = stored.log;
            for reading in readings {
                let agent = self.agent(factory, &reading.reader, new_id).await?;
                self.add(&mut log, reading, agent, now).await?;
            }
            self.put_edge(&log).await?;
        }
        Ok(())
    }

    /// Looks a factory's log up; `None` before its first entry.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(
        &mut self,
        factory: &FactoryId,
    ) -> Result<Option<StoredAccessLog>, StoreError> {
        let row = sqlx::query("SELECT * FROM access_log WHERE factory_id = $1")
            .bind(factory.as_str())
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look an access log up"))?;
        row.as_ref().map(read).transpose()
    }

    /// Signs a checkpoint of each log that grew since its last one; at most `limit` logs.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn sign_checkpoints(
        &mut self,
        key: &AccessLogKey,
        limit: u32,
    ) -> Result<(), StoreError> {
        let sql = "SELECT * FROM access_log
                   WHERE checkpoint_number IS NULL OR checkpoint_number < last_number LIMIT $1";
        let rows = sqlx::query(sql)
            .bind(i64::from(limit))
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("find access logs that grew"))?;
        for row in &rows {
            let log = read(row)?.log;
            let sql = "UPDATE access_log SET checkpoint = $2, checkpoint_number = $3 WHERE factory_id = $1";
            sqlx::query(sql)
                .bind(log.start().factory_id.as_str())
                .bind(log.sign_checkpoint(key))
                .bind(signed(log.last_number()))
                .execute(&mut *self.0)
                .await
                .map_err(StoreError::during("store a checkpoint"))?;
        }
        Ok(())
    }

    async fn begin(
        &mut self,
        factory: &FactoryId,
        log_id: String,
    ) -> Result<StoredAccessLog, StoreError> {
        let log = AccessLog::new(AccessLogStart { factory_id: factory.clone(), log_id });
        let removed = RemovedEntries::none();
        let sql = "INSERT INTO access_log (factory_id, start, last_number, edge, removed_number, removed_edge)
                   VALUES ($1, $2, 0, $3, 0, $4)";
        sqlx::query(sql)
            .bind(factory.as_str())
            .bind(log.start().canonical())
            .bind(log.edge())
            .bind(removed.edge())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("begin an access log"))?;
        Ok(StoredAccessLog { log, removed, checkpoint: None })
    }

    /// Returns the pseudonym of a reader at a factory.
    async fn agent(
        &mut self,
        factory: &FactoryId,
        reader: &Reader,
        new_id: fn() -> String,
    ) -> Result<Agent, StoreError> {
        let sql = "INSERT INTO access_agent (factory_id, organisation_id, kind, name, agent_id)
                   VALUES ($1, $2, $3, $4, $5)
                   ON CONFLICT (factory_id, organisation_id, kind, name) DO UPDATE SET name = excluded.name
                   RETURNING agent_id";
        let row = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(reader.organisation_id.as_str())
            .bind(reader.kind.as_str())
            .bind(&reader.name)
            .bind(new_id())
            .fetch_one(&mut *self.0)
            .await
            .map_err(StoreError::during("name the agent of an access"))?;
        Ok(Agent {
            kind: reader.kind,
            id: row.column("agent_id")?,
            role: reader.role.map(str::to_owned),
        })
    }

    async fn add(
        &mut self,
        log: &mut AccessLog,
        reading: &Reading,
        agent: Agent,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let contents = &reading.contents;
        let access = Access {
            viewer: reading.reader.organisation_id.clone(),
            agent,
            kind: reading.kind,
            request: contents.request.clone(),
            fields: contents.fields.clone(),
            values_from: contents.span.map(|(from, _)| from),
            values_to: contents.span.map(|(_, to)| to),
            value_count: contents.value_count,
            since: reading.since,
        };
        let entry = log.append(access, now);
        sqlx::query(INSERT_ENTRY)
            .bind(entry.factory_id.as_str())
            .bind(signed(entry.number))
            .bind(entry.recorded_at.ticks())
            .bind(entry.access.viewer.as_str())
            .bind(&entry.access.agent.id)
            .bind(entry.access.request.operation_network_id.as_str())
            .bind(entry.access.request.dynamic_data_request_id.as_str())
            .bind(entry.canonical())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("store an access"))?;
        Ok(())
    }

    async fn put_edge(&mut self, log: &AccessLog) -> Result<(), StoreError> {
        sqlx::query("UPDATE access_log SET last_number = $2, edge = $3 WHERE factory_id = $1")
            .bind(log.start().factory_id.as_str())
            .bind(signed(log.last_number()))
            .bind(log.edge())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("extend an access log"))?;
        Ok(())
    }
}

fn read(row: &DatabaseRow) -> Result<StoredAccessLog, StoreError> {
    let corrupt = |column: &'static str| StoreError::Corrupt {
        column,
        reason: "it is not the edge of a tree of this size".to_owned(),
    };
    let edge = row.column::<Vec<u8>>("edge")?;
    let log = AccessLog::stored(row.json("start")?, row.unsigned("last_number")?, &edge);
    let removed_edge = row.column::<Vec<u8>>("removed_edge")?;
    let removed = RemovedEntries::stored(row.unsigned("removed_number")?, &removed_edge);
    let checkpoint: Option<String> = row.column("checkpoint")?;
    let covered = checkpoint.as_ref().map(|_| row.unsigned("checkpoint_number")).transpose()?;
    Ok(StoredAccessLog {
        log: log.ok_or_else(|| corrupt("edge"))?,
        removed: removed.ok_or_else(|| corrupt("removed_edge"))?,
        checkpoint: covered.zip(checkpoint),
    })
}
