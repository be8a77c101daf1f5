//! What left this factory.

use asi_model::OrganisationId;
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{Api, problems::Problems};
use crate::{
    ledger::Verification,
    store::{LedgerRow, Store, ledger_page, verify_ledger},
};

/// Which part of which chain.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerQuery {
    /// Whose chain; the first by name without it.
    #[param(value_type = Option<String>)]
    recipient: Option<OrganisationId>,
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
    /// `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED` or `PURGED`.
    kind: String,
    /// What the entry says besides: field and policy of a consent, sequence numbers of a report.
    #[serde(flatten)]
    #[schema(value_type = Object)]
    content: serde_json::Map<String, serde_json::Value>,
    /// For a report: the values that left, by field, while they are kept.
    #[schema(value_type = Option<Object>)]
    value: Option<serde_json::Value>,
    /// Its hash, hexadecimal.
    hash: String,
}

impl From<LedgerRow> for EntryView {
    fn from(row: LedgerRow) -> Self {
        let mut content = match row.entry {
            serde_json::Value::Object(members) => members,
            _ => serde_json::Map::new(),
        };
        let mut text =
            |name: &str| content.remove(name).and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default();
        let (at, recipient_id, kind) = (text("recordedAt"), text("recipient"), text("event"));
        content.remove("number");
        if let Some(serde_json::Value::Object(field)) = content.remove("field") {
            content.extend(field);
        }
        let value = row.report.and_then(|report| report.get("Payload").cloned());
        Self { sequence: row.number, at, recipient_id, kind, content, value, hash: row.hash }
    }
}

/// Lists the entries of a recipient's chain, newest first, with what left.
#[utoipa::path(get, path = "/ledger", tag = "ledger", security(("session" = [])), params(LedgerQuery),
    responses((status = 200, body = LedgerView), Problems))]
pub async fn list(State(api): State<Api>, ApiQuery(query): ApiQuery<LedgerQuery>) -> Result<Json<LedgerView>, Problem> {
    let limit = query.limit.unwrap_or(100).clamp(1, 500);
    let before = query.after.unwrap_or(u64::MAX);
    let page = ledger_page(&api.readers, query.recipient.as_ref(), before, limit).await?;
    let next_cursor = page.entries.last().map(|entry| entry.number).filter(|number| *number > 1);
    Ok(Json(LedgerView {
        recipients: page.recipients,
        items: page.entries.into_iter().map(EntryView::from).collect(),
        next_cursor: next_cursor.map(|number| number.to_string()),
    }))
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
    let runtime = tokio::runtime::Handle::current();
    let verified = tokio::task::spawn_blocking(move || {
        runtime.block_on(async {
            let mut connection = Store::connect(&directory).await?;
            verify_ledger(&mut connection).await
        })
    });
    let verification = verified.await.map_err(|error| Problem::internal(&error))??;
    let chains = ledger_page(&api.readers, None, 0, 1).await?.recipients.len();
    let fault = verification
        .fault_list
        .first()
        .map(|fault| format!("{}, entry {}: {}", fault.recipient, fault.number, fault.message));
    Ok(Json(VerificationView { valid: verification.is_intact(), chains, fault, verification }))
}
