//! Reading the ledger.

use asi_model::OrganisationId;
use sqlx::{SqliteConnection, SqlitePool};

use super::{StoreError, load::get};
use crate::ledger::{StoredEntry, Verification, Verifier};

/// Entries read at once.
const BLOCK: i64 = 2000;

/// An entry with the values it commits to.
#[derive(Debug, Clone, PartialEq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerRow {
    /// Its place in the recipient's chain.
    pub number: u64,
    /// The hashed text as JSON: what happened, when.
    #[schema(value_type = Object)]
    pub entry: serde_json::Value,
    /// Its hash, hexadecimal.
    pub hash: String,
    /// The DataSetMessage that left, while it is kept.
    #[schema(value_type = Option<Object>)]
    pub report: Option<serde_json::Value>,
}

/// Entries of one chain, newest first.
#[derive(Debug, Clone, PartialEq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerPage {
    /// Every recipient that has a chain.
    pub recipients: Vec<String>,
    /// The entries.
    pub entries: Vec<LedgerRow>,
}

/// Every recipient that has a chain, and the entries of one chain before a number.
///
/// # Errors
/// [`StoreError`] where the tables cannot be read.
pub async fn ledger_page(
    readers: &SqlitePool,
    recipient: Option<&OrganisationId>,
    before: u64,
    limit: u32,
) -> Result<LedgerPage, StoreError> {
    let action = "read the ledger";
    let recipients = sqlx::query("SELECT DISTINCT recipient FROM ledger_entry ORDER BY recipient")
        .fetch_all(readers)
        .await
        .map_err(StoreError::while_doing(action))?;
    let recipients: Vec<String> = recipients.iter().map(|row| get(row, 0)).collect::<Result<_, _>>()?;
    let Some(chosen) = recipient.map(ToString::to_string).or_else(|| recipients.first().cloned()) else {
        return Ok(LedgerPage { recipients, entries: Vec::new() });
    };
    let rows = sqlx::query(
        "SELECT e.number, e.content, e.hash, r.body FROM ledger_entry e LEFT JOIN report r ON r.id = e.report_id \
         WHERE e.recipient = ? AND e.number < ? ORDER BY e.number DESC LIMIT ?",
    )
    .bind(chosen)
    .bind(i64::try_from(before).unwrap_or(i64::MAX))
    .bind(i64::from(limit))
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing(action))?;
    let entries = rows
        .iter()
        .map(|row| {
            let number: i64 = get(row, 0)?;
            let content: String = get(row, 1)?;
            let hash: Vec<u8> = get(row, 2)?;
            let report: Option<String> = get(row, 3)?;
            Ok(LedgerRow {
                number: u64::try_from(number).unwrap_or_default(),
                entry: serde_json::from_str(&content).map_err(StoreError::unreadable("ledger entry"))?,
                hash: hex::encode(hash),
                report: report
                    .map(|text| serde_json::from_str(&text).map_err(StoreError::unreadable("report")))
                    .transpose()?,
            })
        })
        .collect::<Result<_, StoreError>>()?;
    Ok(LedgerPage { recipients, entries })
}

/// Reads every chain from its beginning and looks for any change, deletion or reordering.
///
/// # Errors
/// [`StoreError`] where the tables cannot be read.
pub async fn verify_ledger(connection: &mut SqliteConnection) -> Result<Verification, StoreError> {
    let action = "read the ledger";
    let checkpoints = sqlx::query("SELECT content, signature, public_key FROM ledger_checkpoint ORDER BY number")
        .fetch_all(&mut *connection)
        .await
        .map_err(StoreError::while_doing(action))?;
    let checkpoints: Vec<(String, Vec<u8>, Vec<u8>)> = checkpoints
        .iter()
        .map(|row| Ok((get(row, 0)?, get(row, 1)?, get(row, 2)?)))
        .collect::<Result<_, StoreError>>()?;
    let mut verifier = verifier(&checkpoints);
    let (mut recipient, mut number) = (String::new(), 0_i64);
    loop {
        let rows = sqlx::query(
            "SELECT e.recipient, e.number, e.content, e.hash, r.body, r.salt, r.id IS NOT NULL FROM ledger_entry e \
             LEFT JOIN report r ON r.id = e.report_id WHERE (e.recipient, e.number) > (?, ?) \
             ORDER BY e.recipient, e.number LIMIT ?",
        )
        .bind(&recipient)
        .bind(number)
        .bind(BLOCK)
        .fetch_all(&mut *connection)
        .await
        .map_err(StoreError::while_doing(action))?;
        if rows.is_empty() {
            break;
        }
        for row in &rows {
            recipient = get(row, 0)?;
            number = get(row, 1)?;
            let content: String = get(row, 2)?;
            let hash: Vec<u8> = get(row, 3)?;
            let body: Option<String> = get(row, 4)?;
            let salt: Option<Vec<u8>> = get(row, 5)?;
            let is_kept: i64 = get(row, 6)?;
            verifier.entry(&StoredEntry {
                recipient: &recipient,
                number: u64::try_from(number).unwrap_or_default(),
                content: &content,
                hash: &hash,
                report: (is_kept != 0).then_some((body.as_deref(), salt.as_deref())),
            });
        }
    }
    Ok(verifier.finish(std::iter::empty()))
}

fn verifier(checkpoints: &[(String, Vec<u8>, Vec<u8>)]) -> Verifier {
    Verifier::new(
        checkpoints.iter().map(|(text, signature, key)| (text.as_str(), signature.as_slice(), key.as_slice())),
    )
}
