//! Caps of the information that partners and alliances get.

use asi_model::FieldKey;
use axum::{Json, extract::State, http::HeaderMap};
use connector_state::{ConnectorState, queries, use_cases::caps};
use daemon::web::{ApiJson, ApiPath, Problem};
use disclosure::{BitSum, Cap, CapExcess, DocumentId, DocumentVersion, Versioned};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    documents,
    problems::Problems,
    roles::{Engineer, Viewer},
    view::Page,
};
use crate::{clock::now, store::DocumentKind};

/// A cap with the sum under it.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CapView {
    /// The newest version.
    #[serde(flatten)]
    cap: Versioned<Cap>,
    /// Most bits per hour that its partners get at present; none for a retired cap.
    bits_per_hour: Option<f64>,
    /// Fields that wait since the cap ended their consents, sorted.
    held_back: Vec<FieldKey>,
}

/// Lists the caps in their newest version, retired ones included.
#[utoipa::path(
    get,
    path = "/caps",
    tag = "policies",
    responses((status = 200, body = Page<CapView>), Problems)
)]
pub async fn list_caps(_: Viewer, State(api): State<Api>) -> Result<Json<Page<CapView>>, Problem> {
    let now = now();
    let read = api.coordinator.read(move |state| {
        let usage = queries::cap_usage(state, now);
        let mut held_back = queries::fields_held_back(state);
        let caps = state.budgets().caps().cloned();
        let view = |cap: Versioned<Cap>| CapView {
            bits_per_hour: usage.sum(&cap.key.id).and_then(BitSum::bits),
            held_back: held_back.remove(&cap.key.id).unwrap_or_default(),
            cap,
        };
        caps.map(view).collect()
    });
    Ok(Json(Page::whole(read.await?)))
}

/// A cap with its new version, and the fields that it held back.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredCap {
    #[serde(flatten)]
    version: DocumentVersion,
    /// Fields whose consents ended so that all caps hold.
    held_back: Vec<FieldKey>,
}

/// Stores a new version of a cap. Decisions, policies, alliances and mappings that would exceed it are
/// refused from now on (`OVER_CAP`). Where the present sum exceeds it, consents end at once until it
/// holds: in the order of their decisions each field stays that fits beside the earlier ones.
/// `If-Match` as for policies.
#[utoipa::path(
    put,
    path = "/caps/{capId}",
    tag = "policies",
    params(("capId" = String, Path), ("If-Match" = Option<String>, Header)),
    request_body = Cap,
    responses((status = 200, body = StoredCap), Problems)
)]
pub async fn put_cap(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    headers: HeaderMap,
    ApiJson(cap): ApiJson<Cap>,
) -> Result<Json<StoredCap>, Problem> {
    let put = move |state: &mut ConnectorState, expected, by: &str, now| {
        caps::put_cap(state, &id, cap, expected, by, now)
    };
    let (version, held_back) =
        documents::keep(&api, &user.principal.user_name, &headers, put).await?;
    Ok(Json(StoredCap { version, held_back }))
}

/// Lists every version of a cap, newest first.
#[utoipa::path(
    get,
    path = "/caps/{capId}/versions",
    tag = "policies",
    params(("capId" = String, Path)),
    responses((status = 200, body = Page<Versioned<Cap>>), Problems)
)]
pub async fn list_cap_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
) -> Result<Json<Page<Versioned<Cap>>>, Problem> {
    documents::versions(&api, DocumentKind::Cap, &id).await
}

/// A field that a cap would hold back.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldToHoldBack {
    key: FieldKey,
    /// The caps beside which it does not fit, with their figures.
    excesses: Vec<CapExcess>,
}

/// Lists the fields whose consents a draft of a cap would end, in the order of their decisions.
/// Changes nothing.
#[utoipa::path(
    post,
    path = "/caps/{capId}/preview",
    tag = "policies",
    params(("capId" = String, Path)),
    request_body = Cap,
    responses((status = 200, body = Page<FieldToHoldBack>), Problems)
)]
pub async fn preview_cap(
    _: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    ApiJson(draft): ApiJson<Cap>,
) -> Result<Json<Page<FieldToHoldBack>>, Problem> {
    let now = now();
    let read = api.coordinator.read(move |state| queries::cap_preview(state, &id, draft, now));
    let found = read.await?.map_err(documents::document_problem)?;
    let fields = found.into_iter().map(|(key, excesses)| FieldToHoldBack { key, excesses });
    Ok(Json(Page::whole(fields.collect())))
}
