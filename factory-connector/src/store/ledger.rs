//! Reading the ledger for people: pages of a chain, and everything in its order for an export.

mod checkpoints;
mod selection;

use std::collections::{BTreeMap, HashMap, VecDeque};

use asi_model::DateTime;
use serde_json::Value;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

pub use checkpoints::{StoredCheckpoint, ledger_checkpoints};
pub use selection::{LedgerFilter, LedgerSubject, ledger_fields};
use selection::{Place, selection};

use super::{StoreError, load::get};
use crate::ledger_export::ExportedEntry;
use disclosure::{DisclosurePolicy, Statement};

/// Entries read at once for an export.
const BLOCK: u32 = 1000;
/// Consents whose wording is remembered while reading.
const WORDINGS_MAX: usize = 100_000;

/// An entry with the values it commits to.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerRow {
    /// Its place in the recipient's chain.
    pub number: u64,
    /// The hashed text with everything that explains it.
    pub entry: ExportedEntry,
}

/// Reads entries and explains them.
#[derive(Default)]
pub struct LedgerReader {
    wordings: HashMap<(String, u64), Statement>,
    /// The chains that are still to be exported, and the last entry of the first of them that was.
    chains: Option<VecDeque<String>>,
    last: i64,
}

/// Every recipient that has a chain.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn ledger_recipients(
    connection: &mut SqliteConnection,
) -> Result<Vec<String>, StoreError> {
    super::load::all(connection, "SELECT recipient FROM ledger_head ORDER BY recipient", |row| {
        get(row, 0)
    })
    .await
}

impl LedgerReader {
    /// Entries of one chain, newest first, before a number.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn page(
        &mut self,
        connection: &mut SqliteConnection,
        recipient: &str,
        filter: &LedgerFilter,
        before: Option<u64>,
        limit: u32,
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let before = before.map_or(i64::MAX, |number| i64::try_from(number).unwrap_or(i64::MAX));
        let rows = read(connection, recipient, filter, Place::Before(before), limit).await?;
        self.explain(connection, &rows).await
    }

    /// The next entries in the order of the chains; empty at the end.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn next(
        &mut self,
        connection: &mut SqliteConnection,
        filter: &LedgerFilter,
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let chains = match (&mut self.chains, &filter.recipient) {
            (Some(chains), _) => chains,
            (unknown, Some(recipient)) => unknown.insert([recipient.to_string()].into()),
            (unknown, None) => unknown.insert(ledger_recipients(connection).await?.into()),
        };
        while let Some(recipient) = chains.front() {
            let rows = read(connection, recipient, filter, Place::After(self.last), BLOCK).await?;
            if let Some(row) = rows.last() {
                self.last = get(row, 1)?;
                return self.explain(connection, &rows).await;
            }
            self.last = 0;
            chains.pop_front();
        }
        Ok(Vec::new())
    }

    async fn explain(
        &mut self,
        connection: &mut SqliteConnection,
        rows: &[SqliteRow],
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let mut explained = Vec::with_capacity(rows.len());
        for row in rows {
            let content: String = get(row, 2)?;
            let hash: Vec<u8> = get(row, 3)?;
            let report: Option<String> = get(row, 4)?;
            let time = |column| -> Result<Option<String>, StoreError> {
                Ok(get::<Option<i64>>(row, column)?
                    .map(|micros| DateTime::from_unix_micros(micros).to_string()))
            };
            let mut precision = BTreeMap::new();
            for (name, field, version) in consents(&content, report.as_deref()) {
                if let Some(told) = self.told(connection, field, version).await? {
                    precision.insert(name, told);
                }
            }
            let entry = ExportedEntry {
                hash: hex::encode(hash),
                message_id: get(row, 5)?,
                sent_at: time(6)?,
                delivered_at: time(7)?,
                content,
                report,
                precision,
            };
            explained.push(LedgerRow { number: get::<i64>(row, 1)?.unsigned_abs(), entry });
        }
        Ok(explained)
    }

    /// What the partner was told of the precision under a consent.
    async fn told(
        &mut self,
        connection: &mut SqliteConnection,
        field: String,
        version: u64,
    ) -> Result<Option<Statement>, StoreError> {
        let key = (field, version);
        if let Some(known) = self.wordings.get(&key) {
            return Ok(Some(known.clone()));
        }
        let policy: Option<String> =
            sqlx::query_scalar("SELECT policy FROM consent WHERE field = ? AND version = ?")
                .bind(key.0.clone())
                .bind(i64::try_from(version).unwrap_or(i64::MAX))
                .fetch_optional(connection)
                .await
                .map_err(StoreError::while_doing("read a consent"))?;
        let policy =
            policy.and_then(|policy| serde_json::from_str::<DisclosurePolicy>(&policy).ok());
        let told = policy.map(|policy| Statement::of(&policy, None));
        if let Some(told) = told.clone().filter(|_| self.wordings.len() < WORDINGS_MAX) {
            self.wordings.insert(key, told);
        }
        Ok(told)
    }
}

async fn read(
    connection: &mut SqliteConnection,
    recipient: &str,
    filter: &LedgerFilter,
    place: Place,
    limit: u32,
) -> Result<Vec<SqliteRow>, StoreError> {
    let mut sql = selection(recipient, filter, place, limit);
    sql.build().fetch_all(connection).await.map_err(StoreError::while_doing("read the ledger"))
}

/// The consents that an entry names: field name, field's key as text, number.
fn consents(content: &str, report: Option<&str>) -> Vec<(String, String, u64)> {
    let entry: Value = serde_json::from_str(content).unwrap_or_default();
    let key = |of: &Value, name: &str| -> Option<String> {
        let part = |member: &str| {
            let value = &of[member];
            value
                .as_str()
                .or_else(|| value["Body"].as_str())
                .or_else(|| value["Value"].as_str())
                .map(str::to_owned)
        };
        Some(format!(
            "{}/{}/{}/{name}",
            part("operationNetworkId")?,
            part("operationId")?,
            part("dynamicDataRequestId")?
        ))
    };
    if let Some(name) = entry["field"]["fieldName"].as_str() {
        let field = key(&entry["field"], name);
        return field
            .zip(entry["version"].as_u64())
            .map(|(field, version)| (name.to_owned(), field, version))
            .into_iter()
            .collect();
    }
    let Some(named) = entry["consents"].as_object() else { return Vec::new() };
    let report: Value =
        report.and_then(|report| serde_json::from_str(report).ok()).unwrap_or_default();
    named
        .iter()
        .filter_map(|(name, version)| {
            Some((name.clone(), key(&report["Payload"], name)?, version.as_u64()?))
        })
        .collect()
}
