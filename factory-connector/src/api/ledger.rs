//! What left this factory.

use std::collections::BTreeMap;

use asi_model::{DateTime, OrganisationId};
use axum::{
    Json,
    body::Body,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use daemon::web::{ApiQuery, Problem};
use futures::StreamExt as _;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{Api, problems::Problems};
use crate::{
    ledger::{ExportFormat, Exporter, LEDGER_KEY_FILE, LedgerKey, Verification},
    print::Language,
    store::{LedgerFilter, LedgerReader, LedgerRow, Store, StoreError, ledger_recipients, verify_ledger},
};

/// Which part of which chain.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerQuery {
    /// Whose chain; the first by name without it.
    #[param(value_type = Option<String>)]
    recipient: Option<OrganisationId>,
    /// Recorded at this time or later.
    #[param(value_type = Option<String>)]
    from: Option<DateTime>,
    /// Recorded before this time.
    #[param(value_type = Option<String>)]
    until: Option<DateTime>,
    /// `nextCursor` of the page before.
    after: Option<u64>,
    /// Entries on the page, 1 to 500; 100 without it.
    limit: Option<u32>,
}

/// Entries of one chain, newest first.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerView {
    /// Every recipient that has a chain.
    recipients: Vec<String>,
    /// The entries.
    items: Vec<EntryView>,
    /// Where the next page begins.
    next_cursor: Option<String>,
}

/// An entry of a chain.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct EntryView {
    /// Its place in the chain.
    sequence: u64,
    /// When it was recorded.
    at: String,
    /// Whose chain.
    recipient_id: String,
    /// `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or `REVOKED`.
    kind: String,
    /// What the entry says besides: field and policy of a consent, sequence numbers of a report.
    #[serde(flatten)]
    #[schema(value_type = Object)]
    content: serde_json::Map<String, serde_json::Value>,
    /// For a report: the values that left, by field, while they are kept.
    #[schema(value_type = Option<Object>)]
    value: Option<serde_json::Value>,
    /// The precision under each consent that the entry names, by field, in the words that the partner was told.
    precision: BTreeMap<String, String>,
    /// For a report: the message it left in last.
    left_in_message: Option<String>,
    /// For a report: when the broker accepted it last.
    #[schema(format = "date-time")]
    sent_at: Option<String>,
    /// For a report: when the platform said that it holds it.
    #[schema(format = "date-time")]
    delivered_at: Option<String>,
    /// Its hash, hexadecimal.
    hash: String,
}

impl From<LedgerRow> for EntryView {
    fn from(row: LedgerRow) -> Self {
        let mut content: serde_json::Map<String, serde_json::Value> =
            serde_json::from_str(&row.entry.content).unwrap_or_default();
        let mut text =
            |name: &str| content.remove(name).and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default();
        let (at, recipient_id, kind) = (text("recordedAt"), text("recipient"), text("event"));
        content.remove("number");
        if let Some(serde_json::Value::Object(field)) = content.remove("field") {
            content.extend(field);
        }
        let report: Option<serde_json::Value> =
            row.entry.report.as_deref().and_then(|report| serde_json::from_str(report).ok());
        Self {
            sequence: row.number,
            at,
            recipient_id,
            kind,
            content,
            value: report.and_then(|report| report.get("Payload").cloned()),
            precision: row.entry.precision,
            left_in_message: row.entry.message_id,
            sent_at: row.entry.sent_at,
            delivered_at: row.entry.delivered_at,
            hash: row.entry.hash,
        }
    }
}

/// Lists the entries of a recipient's chain, newest first, with what left.
#[utoipa::path(get, path = "/ledger", tag = "ledger", security(("session" = [])), params(LedgerQuery),
    responses((status = 200, body = LedgerView), Problems))]
pub async fn list(State(api): State<Api>, ApiQuery(query): ApiQuery<LedgerQuery>) -> Result<Json<LedgerView>, Problem> {
    let limit = query.limit.unwrap_or(100).clamp(1, 500);
    let mut connection = api.reader().await?;
    let recipients = ledger_recipients(&mut connection).await?;
    let chosen = query.recipient.as_ref().map(ToString::to_string).or_else(|| recipients.first().cloned());
    let filter = LedgerFilter { recipient: query.recipient, from: query.from, until: query.until, before: query.after };
    let rows = match chosen {
        Some(chosen) => LedgerReader::default().page(&mut connection, &chosen, &filter, limit).await?,
        None => Vec::new(),
    };
    let is_whole = rows.len() < limit as usize;
    let next_cursor = rows.last().map(|row| row.number).filter(|number| *number > 1 && !is_whole);
    Ok(Json(LedgerView {
        recipients,
        items: rows.into_iter().map(EntryView::from).collect(),
        next_cursor: next_cursor.map(|number| number.to_string()),
    }))
}

/// What to export, and how.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct ExportQuery {
    /// `jsonl`, `csv` or `html`.
    #[param(value_type = String)]
    format: ExportFormat,
    /// Of this chain only.
    #[param(value_type = Option<String>)]
    recipient: Option<OrganisationId>,
    /// Recorded at this time or later.
    #[param(value_type = Option<String>)]
    from: Option<DateTime>,
    /// Recorded before this time.
    #[param(value_type = Option<String>)]
    until: Option<DateTime>,
    /// Of a page to print: `en` or `de`.
    #[param(value_type = Option<String>)]
    language: Option<Language>,
}

/// Everything that left, as JSON lines, as a table for spreadsheets or as a page to print; in the order of the chains.
#[utoipa::path(get, path = "/ledger/export", tag = "ledger", security(("session" = [])), params(ExportQuery),
    responses((status = 200, content_type = "text/csv", body = String), Problems))]
pub async fn export(State(api): State<Api>, ApiQuery(query): ApiQuery<ExportQuery>) -> Result<Response, Problem> {
    let exporter = Exporter::new(query.format, query.language.unwrap_or_default());
    let filter = LedgerFilter { recipient: query.recipient, from: query.from, until: query.until, before: None };
    let connection = api.reader().await?;
    let first = exporter.begin(api.factory_id.as_str());
    // One part per block of entries: nothing larger is ever in memory.
    let state = Some((connection, LedgerReader::default()));
    let parts = futures::stream::try_unfold(state, move |state| {
        let filter = filter.clone();
        async move {
            let Some((mut connection, mut reader)) = state else { return Ok(None) };
            let rows = reader.next(&mut connection, &filter).await?;
            if rows.is_empty() {
                return Ok(Some((exporter.end(), None)));
            }
            let part: String = rows.iter().map(|row| exporter.entry(&row.entry)).collect();
            Ok::<_, StoreError>(Some((part, Some((connection, reader)))))
        }
    });
    let body = futures::stream::once(async move { Ok(first) }).chain(parts);
    let name = format!("attachment; filename=\"ledger-{}.{}\"", api.factory_id, query.format.extension());
    let headers = [(header::CONTENT_TYPE, query.format.media_type().to_owned()), (header::CONTENT_DISPOSITION, name)];
    Ok((headers, Body::from_stream(body)).into_response())
}

/// The outcome of a verification.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct VerificationView {
    /// Nothing is wrong.
    valid: bool,
    /// How many chains there are.
    chains: usize,
    /// The first thing that is wrong, in words.
    fault: Option<String>,
    /// What was looked at and everything that is wrong.
    #[serde(flatten)]
    verification: Verification,
}

/// Reads every chain from its beginning and finds any change, deletion or reordering.
#[utoipa::path(post, path = "/ledger/verification", tag = "ledger", security(("session" = [])),
    responses((status = 200, body = VerificationView), Problems))]
pub async fn verify(State(api): State<Api>) -> Result<Json<VerificationView>, Problem> {
    // Hashing a whole ledger takes its time: it has a thread of its own.
    let directory = api.data_directory.clone();
    let trusted = LedgerKey::public_of(&directory.join(LEDGER_KEY_FILE)).map_err(|error| Problem::internal(&error))?;
    let runtime = tokio::runtime::Handle::current();
    let verified = tokio::task::spawn_blocking(move || {
        runtime.block_on(async {
            let mut connection = Store::connect(&directory).await?;
            verify_ledger(&mut connection, trusted).await
        })
    });
    let verification = verified.await.map_err(|error| Problem::internal(&error))??;
    let mut connection = api.reader().await?;
    let chains = ledger_recipients(&mut connection).await?.len();
    let fault = verification
        .fault_list
        .first()
        .map(|fault| format!("{}, entry {}: {}", fault.recipient, fault.number, fault.message));
    Ok(Json(VerificationView { valid: verification.is_intact(), chains, fault, verification }))
}
