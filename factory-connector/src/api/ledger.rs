//! What left this factory.

pub mod checkpoints;
pub mod export;
pub mod fields;
pub mod verification;

use std::collections::BTreeMap;

use asi_model::{
    DateTime, DynamicDataRequestId, FieldName, OperationId, OperationNetworkId, OrganisationId,
};
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{Api, problems::Problems, roles::Viewer};
use crate::store::{LedgerFilter, LedgerRow, LedgerSubject};
use disclosure::StatementPart;
use ledger::EventKind;

/// Which entries.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct LedgerSelection {
    /// Of this recipient's chain.
    recipient: Option<OrganisationId>,
    /// Recorded at this time or later.
    from: Option<DateTime>,
    /// Recorded before this time.
    until: Option<DateTime>,
    /// Of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
    /// `REVOKED`.
    #[param(inline)]
    kind: Option<EventKind>,
    /// About this network: decisions about its fields, reports that carried them, and what became
    /// of those.
    operation_network_id: Option<OperationNetworkId>,
    /// Of it, only about this operation.
    operation_id: Option<OperationId>,
    /// Of it, only about this request.
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// Of it, only about this field.
    field_name: Option<FieldName>,
}

impl LedgerSelection {
    fn filter(self) -> Result<LedgerFilter, Problem> {
        let is_named = [
            self.operation_network_id.is_some(),
            self.operation_id.is_some(),
            self.dynamic_data_request_id.is_some(),
            self.field_name.is_some(),
        ];
        if is_named.windows(2).any(|pair| pair[1] && !pair[0]) {
            let detail = "A field is named with its request, a request with its operation, an operation with its network.";
            return Err(Problem::bad_request("INCOMPLETE_ADDRESS", detail));
        }
        let subject = self.operation_network_id.map(|operation_network_id| LedgerSubject {
            operation_network_id,
            operation_id: self.operation_id,
            dynamic_data_request_id: self.dynamic_data_request_id,
            field_name: self.field_name,
        });
        Ok(LedgerFilter {
            recipient: self.recipient,
            from: self.from,
            until: self.until,
            kind: self.kind,
            subject,
        })
    }
}

/// Which page of them.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerPlace {
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
    /// The precision under each consent that the entry names, by field, in the words that the
    /// partner was told.
    precision: BTreeMap<String, String>,
    /// The same as codes with parameters.
    precision_parts: BTreeMap<String, Vec<StatementPart>>,
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
            serde_json::from_str(&row.content).unwrap_or_default();
        let mut text = |name: &str| {
            content
                .remove(name)
                .and_then(|value| value.as_str().map(str::to_owned))
                .unwrap_or_default()
        };
        let (at, recipient_id, kind) = (text("recordedAt"), text("recipient"), text("event"));
        content.remove("number");
        if let Some(serde_json::Value::Object(field)) = content.remove("field") {
            content.extend(field);
        }
        let report: Option<serde_json::Value> =
            row.report.as_deref().and_then(|report| serde_json::from_str(report).ok());
        let (mut precision, mut precision_parts) = (BTreeMap::new(), BTreeMap::new());
        for (field, told) in row.precision {
            precision.insert(field.clone(), told.statement);
            precision_parts.insert(field, told.statement_parts);
        }
        Self {
            sequence: row.number,
            at,
            recipient_id,
            kind,
            content,
            value: report.and_then(|report| report.get("Payload").cloned()),
            precision,
            precision_parts,
            left_in_message: row.message_id,
            sent_at: row.sent_at.map(|at| at.to_string()),
            delivered_at: row.delivered_at.map(|at| at.to_string()),
            hash: row.hash,
        }
    }
}

/// Lists the entries of a recipient's chain, newest first, with what left; of the first recipient
/// by name where none is named.
#[utoipa::path(
    get,
    path = "/ledger",
    tag = "ledger",
    params(LedgerSelection, LedgerPlace),
    responses((status = 200, body = LedgerView), Problems)
)]
pub async fn list_ledger_entries(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(wanted): ApiQuery<LedgerSelection>,
    ApiQuery(place): ApiQuery<LedgerPlace>,
) -> Result<Json<LedgerView>, Problem> {
    let limit = place.limit.unwrap_or(100).clamp(1, 500);
    let filter = wanted.filter()?;
    let mut session = api.store().await?;
    let recipients = session.ledger().recipients().await?;
    let chosen =
        filter.recipient.as_ref().map(ToString::to_string).or_else(|| recipients.first().cloned());
    let rows = match chosen {
        Some(chosen) => session.ledger().page(&chosen, &filter, place.after, limit).await?,
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
