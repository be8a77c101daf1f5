//! Revocation of consents, and its receipts.

mod receipt_page;

use asi_model::{
    DynamicDataRequestId, FieldKey, OperationId, OperationNetworkId, OrganisationId,
    messages::MappingState,
};
use axum::{
    Json,
    extract::State,
    http::{StatusCode, header},
    response::{IntoResponse, Response},
};
use connector_state::{
    ConnectorState,
    use_cases::{
        decide::DecisionCommand,
        revoke::{Revocation, revoke},
    },
};
use daemon::web::{ApiJson, ApiPath, ApiQuery, Problem};
use disclosure::Language;
use receipt_page::receipt_page;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use super::{
    context::Api,
    problems::{Problems, decision_problem},
    roles::{Engineer, Viewer},
    view::Page,
};
use crate::store::StoredRevocation;

/// Receipts per page, and most that may be asked for.
const PAGE: u32 = 50;

/// Fields whose consents end: single ones, or all that the other members select together.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevocationBody {
    /// Single fields; if any, the other members select none.
    #[serde(default)]
    fields: Vec<FieldKey>,
    /// All fields of this network.
    operation_network_id: Option<OperationNetworkId>,
    /// Restriction to fields of this operation.
    operation_id: Option<OperationId>,
    /// Restriction to fields of this request.
    dynamic_data_request_id: Option<DynamicDataRequestId>,
    /// All fields that this organisation may see.
    recipient_id: Option<OrganisationId>,
    /// State of the fields from now on: `PENDING` (the default) or `REFUSED`.
    mapping_state: Option<MappingState>,
    /// Reason that the partner reads; needed with `REFUSED`.
    pub(super) reason: Option<String>,
}

impl RevocationBody {
    /// Returns the decision about the fields; a problem where none are named.
    pub(super) fn command(&self) -> Result<DecisionCommand, Problem> {
        let command = match self.mapping_state {
            None | Some(MappingState::Pending) => DecisionCommand::LeavePending,
            Some(MappingState::Refused) => DecisionCommand::Refuse,
            Some(MappingState::Mapped) => {
                return Err(Problem::bad_request(
                    "INVALID_DECISION",
                    "A consent ends as PENDING or REFUSED.",
                ));
            }
        };
        let is_wide = self.operation_network_id.is_some() || self.recipient_id.is_some();
        if self.fields.is_empty() && !is_wide {
            return Err(Problem::bad_request(
                "NOTHING_NAMED",
                "Name the fields, or the network or recipient whose fields are meant.",
            ));
        }
        Ok(command)
    }

    /// Returns the fields that are meant.
    pub(super) fn fields_in(self, state: &ConnectorState) -> Vec<FieldKey> {
        if self.fields.is_empty() { selected(state, &self) } else { self.fields }
    }
}

/// Revokes consents. Values stop at once, waiting reports are taken back, the partner is notified,
/// and the receipt lists what had left.
#[utoipa::path(
    post,
    path = "/revocations",
    tag = "revocations",
    request_body = RevocationBody,
    responses((status = 201, body = StoredRevocation), Problems)
)]
pub async fn revoke_consents(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<RevocationBody>,
) -> Result<(StatusCode, Json<StoredRevocation>), Problem> {
    let (command, reason) = (body.command()?, body.reason.clone());
    let fields = api.coordinator.read(move |state| body.fields_in(state)).await?;
    let revoked_by = user.principal.user_name.clone();
    let revocation = Revocation { fields, command, reason, revoked_by };
    let revoked = api.coordinator.execute(move |state, now| revoke(state, &revocation, now));
    let id = revoked.await?.map_err(decision_problem)?;
    let receipt = api.store().await?.revocations().lookup(&id.to_string()).await?;
    receipt
        .map(|receipt| (StatusCode::CREATED, Json(receipt)))
        .ok_or_else(|| Problem::not_found("such revocation"))
}

/// Returns the mapped fields that a revocation selects.
fn selected(state: &ConnectorState, body: &RevocationBody) -> Vec<FieldKey> {
    let is_selected = |key: &FieldKey| {
        let request = &key.request;
        body.operation_network_id.as_ref().is_none_or(|id| *id == request.operation_network_id)
            && body.operation_id.as_ref().is_none_or(|id| *id == request.operation_id)
            && body
                .dynamic_data_request_id
                .as_ref()
                .is_none_or(|id| *id == request.dynamic_data_request_id)
            && body
                .recipient_id
                .as_ref()
                .is_none_or(|id| state.networks().recipients(request).contains(id))
    };
    let mut keys: Vec<FieldKey> = state
        .fields()
        .iter()
        .filter(|field| field.decision().is_mapped() && is_selected(field.key()))
        .map(|field| field.key().clone())
        .collect();
    keys.sort();
    keys
}

/// Page of receipts.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct RevocationsQuery {
    /// `nextCursor` of the page before.
    cursor: Option<String>,
    /// Receipts per page, at most 50.
    limit: Option<u32>,
}

/// Lists the receipts of ended consents, newest first.
#[utoipa::path(
    get,
    path = "/revocations",
    tag = "revocations",
    params(RevocationsQuery),
    responses((status = 200, body = Page<StoredRevocation>), Problems)
)]
pub async fn list_revocations(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<RevocationsQuery>,
) -> Result<Json<Page<StoredRevocation>>, Problem> {
    let limit = query.limit.unwrap_or(PAGE).clamp(1, PAGE);
    let items = api.store().await?.revocations().page(query.cursor.as_deref(), limit).await?;
    Ok(Json(Page::of(items, limit, |last| last.receipt.revocation_id.clone())))
}

/// Shows one receipt.
#[utoipa::path(
    get,
    path = "/revocations/{revocationId}",
    tag = "revocations",
    params(("revocationId" = String, Path)),
    responses((status = 200, body = StoredRevocation), Problems)
)]
pub async fn show_revocation(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<String>,
) -> Result<Json<StoredRevocation>, Problem> {
    find(&api, &id).await.map(Json)
}

async fn find(api: &Api, id: &str) -> Result<StoredRevocation, Problem> {
    let found = api.store().await?.revocations().lookup(id).await?;
    found.ok_or_else(|| Problem::not_found("such revocation"))
}

/// Language of a printed receipt.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PrintQuery {
    /// `en` or `de`.
    #[param(inline)]
    language: Option<Language>,
}

/// Prints a receipt as a page.
#[utoipa::path(
    get,
    path = "/revocations/{revocationId}/print",
    tag = "revocations",
    params(("revocationId" = String, Path), PrintQuery),
    responses((status = 200, content_type = "text/html", body = String), Problems)
)]
pub async fn print_revocation(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<String>,
    ApiQuery(query): ApiQuery<PrintQuery>,
) -> Result<Response, Problem> {
    let found = find(&api, &id).await?;
    let page = receipt_page(&found, query.language.unwrap_or_default());
    let name = format!("attachment; filename=\"revocation-{}.html\"", found.receipt.revocation_id);
    let headers = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8".to_owned()),
        (header::CONTENT_DISPOSITION, name),
    ];
    Ok((headers, page).into_response())
}
