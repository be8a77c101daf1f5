//! Ledger queries.

pub mod checkpoints;
mod entry;
pub mod export;
pub mod fields;
pub mod logs;
pub mod verification;

use asi_model::{
    DateTime, DynamicDataRequestId, FieldName, OperationId, OperationNetworkId, OrganisationId,
};
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use ledger::EventKind;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use self::entry::EntryView;
use super::{context::Api, problems::Problems, roles::Viewer};
use crate::store::{LedgerFilter, LedgerSubject};

/// Filter of ledger entries.
#[derive(Deserialize, IntoParams)]
#[serde(rename_all = "camelCase")]
#[into_params(parameter_in = Query)]
pub struct LedgerSelection {
    /// Entries of this recipient's chain.
    recipient: Option<OrganisationId>,
    /// Entries recorded at this time or later.
    from: Option<DateTime>,
    /// Entries recorded before this time.
    until: Option<DateTime>,
    /// Entries of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
    /// `REVOKED`.
    #[param(inline)]
    kind: Option<EventKind>,
    /// Entries about this network: decisions about its fields, reports that carried them, and the
    /// delivery of those.
    operation_network_id: Option<OperationNetworkId>,
    /// Restriction to entries about this operation.
    operation_id: Option<OperationId>,
    /// Restriction to entries about this request.
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// Restriction to entries about this field.
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

/// Page of ledger entries.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerPage {
    /// `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
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
    /// Entries, newest first.
    items: Vec<EntryView>,
    /// Value of `after` for the next page; none on the last.
    next_cursor: Option<String>,
}

/// Lists the entries of a recipient's chain, newest first, with the values that left. Without a
/// recipient, of the first one by name.
#[utoipa::path(
    get,
    path = "/ledger",
    tag = "ledger",
    params(LedgerSelection, LedgerPage),
    responses((status = 200, body = LedgerView), Problems)
)]
pub async fn list_ledger_entries(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(selection): ApiQuery<LedgerSelection>,
    ApiQuery(page): ApiQuery<LedgerPage>,
) -> Result<Json<LedgerView>, Problem> {
    let limit = page.limit.unwrap_or(100).clamp(1, 500);
    let filter = selection.filter()?;
    let mut session = api.store().await?;
    let recipients = session.ledger().recipients().await?;
    let chosen =
        filter.recipient.as_ref().map(ToString::to_string).or_else(|| recipients.first().cloned());
    let rows = match chosen {
        Some(chosen) => session.ledger().page(&chosen, &filter, page.after, limit).await?,
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
