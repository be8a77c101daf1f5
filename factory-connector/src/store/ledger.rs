//! Reading the ledger for people: pages of a chain, and everything in its order for an export.

use std::collections::{BTreeMap, HashMap};

use asi_model::{DateTime, OrganisationId};
use serde_json::Value;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{StoreError, load::get};
use crate::{disclosure::DisclosurePolicy, ledger::ExportedEntry};

/// Entries read at once for an export.
const BLOCK: i64 = 1000;
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

/// Which entries.
#[derive(Debug, Clone, Default)]
pub struct LedgerFilter {
    /// Of this chain only.
    pub recipient: Option<OrganisationId>,
    /// Recorded at this time or later.
    pub from: Option<DateTime>,
    /// Recorded before this time.
    pub until: Option<DateTime>,
    /// Newest first instead of in the order of the chain, before this number.
    pub before: Option<u64>,
}

/// Reads entries and explains them.
#[derive(Default)]
pub struct LedgerReader {
    wordings: HashMap<(String, u64), String>,
    last: (String, i64),
}

const SELECT: &str = "SELECT e.recipient, e.number, e.content, e.hash, r.body, r.message_id, r.sent_at, r.receipted_at \
    FROM ledger_entry e LEFT JOIN report r ON r.id = e.report_id";

/// Every recipient that has a chain.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn ledger_recipients(connection: &mut SqliteConnection) -> Result<Vec<String>, StoreError> {
    super::load::all(connection, "SELECT recipient FROM ledger_head ORDER BY recipient", |row| get(row, 0)).await
}

impl LedgerReader {
    /// Entries of one chain, newest first.
    ///
    /// # Errors
    /// [`StoreError`] where the tables cannot be read.
    pub async fn page(
        &mut self,
        connection: &mut SqliteConnection,
        recipient: &str,
        filter: &LedgerFilter,
        limit: u32,
    ) -> Result<Vec<LedgerRow>, StoreError> {
        let sql = format!(
            "{SELECT} WHERE e.recipient = ? AND e.number < ? AND e.recorded_at >= ? AND e.recorded_at < ? \
             ORDER BY e.number DESC LIMIT ?"
        );
        let rows = sqlx::query(sqlx::AssertSqlSafe(sql))
            .bind(recipient)
            .bind(filter.before.map_or(i64::MAX, |number| i64::try_from(number).unwrap_or(i64::MAX)))
            .bind(filter.from.map_or(i64::MIN, DateTime::unix_micros))
            .bind(filter.until.map_or(i64::MAX, DateTime::unix_micros))
            .bind(i64::from(limit))
            .fetch_all(&mut *connection)
            .await
            .map_err(StoreError::while_doing("read the ledger"))?;
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
        let wanted = filter.recipient.as_ref().map(ToString::to_string);
        if let Some(recipient) = wanted.as_ref().filter(|_| self.last.0.is_empty()) {
            self.last = (recipient.clone(), 0);
        }
        let sql = format!(
            "{SELECT} WHERE (e.recipient, e.number) > (?, ?) AND e.recipient <= coalesce(?, e.recipient) \
             AND e.recorded_at >= ? AND e.recorded_at < ? ORDER BY e.recipient, e.number LIMIT ?"
        );
        let rows = sqlx::query(sqlx::AssertSqlSafe(sql))
            .bind(self.last.0.clone())
            .bind(self.last.1)
            .bind(wanted)
            .bind(filter.from.map_or(i64::MIN, DateTime::unix_micros))
            .bind(filter.until.map_or(i64::MAX, DateTime::unix_micros))
            .bind(BLOCK)
            .fetch_all(&mut *connection)
            .await
            .map_err(StoreError::while_doing("read the ledger"))?;
        if let Some(row) = rows.last() {
            self.last = (get(row, 0)?, get(row, 1)?);
        }
        self.explain(connection, &rows).await
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
                Ok(get::<Option<i64>>(row, column)?.map(|micros| DateTime::from_unix_micros(micros).to_string()))
            };
            let mut precision = BTreeMap::new();
            for (name, field, version) in consents(&content, report.as_deref()) {
                if let Some(wording) = self.wording(connection, field, version).await? {
                    precision.insert(name, wording);
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
    async fn wording(
        &mut self,
        connection: &mut SqliteConnection,
        field: String,
        version: u64,
    ) -> Result<Option<String>, StoreError> {
        let key = (field, version);
        if let Some(known) = self.wordings.get(&key) {
            return Ok(Some(known.clone()));
        }
        let policy: Option<String> = sqlx::query_scalar("SELECT policy FROM consent WHERE field = ? AND version = ?")
            .bind(key.0.clone())
            .bind(i64::try_from(version).unwrap_or(i64::MAX))
            .fetch_optional(connection)
            .await
            .map_err(StoreError::while_doing("read a consent"))?;
        let policy = policy.and_then(|policy| serde_json::from_str::<DisclosurePolicy>(&policy).ok());
        let wording = policy.map(|policy| policy.statement(None).description);
        if let Some(wording) = wording.clone().filter(|_| self.wordings.len() < WORDINGS_MAX) {
            self.wordings.insert(key, wording);
        }
        Ok(wording)
    }
}

/// The consents that an entry names: field name, field's key as text, number.
fn consents(content: &str, report: Option<&str>) -> Vec<(String, String, u64)> {
    let entry: Value = serde_json::from_str(content).unwrap_or_default();
    let key = |of: &Value, name: &str| -> Option<String> {
        let part = |member: &str| {
            let value = &of[member];
            value.as_str().or_else(|| value["Body"].as_str()).or_else(|| value["Value"].as_str()).map(str::to_owned)
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
    let report: Value = report.and_then(|report| serde_json::from_str(report).ok()).unwrap_or_default();
    named
        .iter()
        .filter_map(|(name, version)| Some((name.clone(), key(&report["Payload"], name)?, version.as_u64()?)))
        .collect()
}
