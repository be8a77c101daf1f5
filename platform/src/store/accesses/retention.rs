//! Removal of the oldest accesses, each time with a statement of it in the log.

use access_log::{
    AccessLog, AccessRetention, AccessRetentionEntry, AccessRetentionRule, RemovedEntries,
};
use asi_model::{DateTime, FactoryId};

use super::{Accesses, INSERT_ENTRY, StoredAccessLog, read};
use crate::store::{
    error::StoreError,
    row::{Columns, signed},
};

/// Viewer in the row of a statement, which nobody has.
const NO_VIEWER: &str = "";

/// Entries that are kept: the newest, and those from a time on.
#[derive(Debug, Clone, Copy)]
pub struct AccessesKept {
    /// Time from which on they are kept.
    pub since: DateTime,
    /// Most entries of a factory.
    pub count: u64,
}

impl Accesses<'_> {
    /// Removes the oldest entries, at most `limit` of each factory at once, and states in its log
    /// that it did. What a former version removed without a statement is stated, too. Returns how
    /// many were removed.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn forget(
        &mut self,
        kept: AccessesKept,
        limit: u32,
        now: DateTime,
    ) -> Result<u64, StoreError> {
        let logs = sqlx::query("SELECT * FROM access_log WHERE last_number > 0")
            .fetch_all(&mut *self.0)
            .await
            .map_err(StoreError::during("list access logs"))?;
        let mut count = 0;
        for row in &logs {
            count += self.forget_of(read(row)?, kept, limit, now).await?;
        }
        Ok(count)
    }

    /// Looks up the newest statement of what was removed from a factory's log; `None` before the
    /// first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_retention(
        &mut self,
        factory: &FactoryId,
    ) -> Result<Option<AccessRetentionEntry>, StoreError> {
        let sql = "SELECT content FROM access_entry WHERE factory_id = $1 AND viewer_id = $2
                   ORDER BY number DESC LIMIT 1";
        let row = sqlx::query(sql)
            .bind(factory.as_str())
            .bind(NO_VIEWER)
            .fetch_optional(&mut *self.0)
            .await
            .map_err(StoreError::during("look the retention of accesses up"))?;
        row.map(|row| row.json("content")).transpose()
    }

    async fn forget_of(
        &mut self,
        stored: StoredAccessLog,
        kept: AccessesKept,
        limit: u32,
        now: DateTime,
    ) -> Result<u64, StoreError> {
        let StoredAccessLog { mut log, mut removed, .. } = stored;
        let factory = log.start().factory_id.clone();
        let first = removed.last_number();
        if first > 0 && self.newest_retention(&factory).await?.is_none() {
            let rule = AccessRetentionRule::FormerVersion;
            let stated = AccessRetention { rule, before: None, kept: None, removed_through: first };
            self.state(&mut log, stated, now).await?;
        }
        let rows = sqlx::query(
            "SELECT number, recorded_at, viewer_id, content FROM access_entry
             WHERE factory_id = $1 ORDER BY number LIMIT $2",
        )
        .bind(factory.as_str())
        .bind(i64::from(limit))
        .fetch_all(&mut *self.0)
        .await
        .map_err(StoreError::during("find old accesses"))?;
        // The statement counts, too: otherwise each would make room for itself by a further one.
        let surplus = (log.last_number() - first).checked_sub(kept.count);
        let surplus =
            surplus.filter(|surplus| *surplus > 0).map_or(0, |surplus| first + surplus + 1);
        let (mut has_accesses, mut rule) = (false, AccessRetentionRule::Count);
        for row in &rows {
            // From the oldest on and no further, for what stays has to follow what is gone.
            if row.unsigned::<u64>("number")? > surplus {
                if row.time("recorded_at")? >= kept.since {
                    break;
                }
                rule = AccessRetentionRule::Age;
            }
            has_accesses |= row.column::<String>("viewer_id")? != NO_VIEWER;
            removed.append_text(&row.column::<String>("content")?);
        }
        // Statements alone are not removed: that would only be stated once more.
        if !has_accesses {
            return Ok(0);
        }
        let last = removed.last_number();
        let by_age = rule == AccessRetentionRule::Age;
        let stated = AccessRetention {
            rule,
            before: by_age.then_some(kept.since),
            kept: (!by_age).then_some(kept.count),
            removed_through: last,
        };
        self.remove_through(&factory, &removed).await?;
        self.state(&mut log, stated, now).await?;
        Ok(last - first)
    }

    async fn state(
        &mut self,
        log: &mut AccessLog,
        stated: AccessRetention,
        now: DateTime,
    ) -> Result<(), StoreError> {
        let entry = log.append_retention(stated, now);
        sqlx::query(INSERT_ENTRY)
            .bind(entry.factory_id.as_str())
            .bind(signed(entry.number))
            .bind(entry.recorded_at.ticks())
            .bind(NO_VIEWER)
            .bind("")
            .bind("")
            .bind("")
            .bind(entry.canonical())
            .execute(&mut *self.0)
            .await
            .map_err(StoreError::during("state the retention of accesses"))?;
        self.put_edge(log).await
    }

    async fn remove_through(
        &mut self,
        factory: &FactoryId,
        removed: &RemovedEntries,
    ) -> Result<(), StoreError> {
        let (factory, last) = (factory.as_str(), signed(removed.last_number()));
        let failed = StoreError::during("remove old accesses");
        let sql =
            "UPDATE access_log SET removed_number = $2, removed_edge = $3 WHERE factory_id = $1";
        let update = sqlx::query(sql).bind(factory).bind(last).bind(removed.edge());
        update.execute(&mut *self.0).await.map_err(&failed)?;
        let sql = "DELETE FROM access_entry WHERE factory_id = $1 AND number <= $2";
        let delete = sqlx::query(sql).bind(factory).bind(last);
        delete.execute(&mut *self.0).await.map_err(&failed)?;
        // A name is kept no longer than what it stands for.
        let sql = "DELETE FROM access_agent WHERE factory_id = $1 AND NOT EXISTS (
                       SELECT 1 FROM access_entry e
                       WHERE e.factory_id = access_agent.factory_id AND e.agent_id = access_agent.agent_id)";
        sqlx::query(sql).bind(factory).execute(&mut *self.0).await.map_err(&failed)?;
        Ok(())
    }
}
