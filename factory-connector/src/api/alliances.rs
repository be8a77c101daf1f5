//! Alliances: partners that tell each other what they get, and their leak budgets.

use std::collections::{BTreeMap, btree_map::Entry};

use asi_model::FieldKey;
use axum::{Json, extract::State, http::HeaderMap};
use connector_state::{ConnectorState, queries, use_cases::alliances};
use daemon::web::{ApiJson, ApiPath, Problem};
use disclosure::{
    Alliance, DocumentId, DocumentVersion, LeakBudget, OpenField, Versioned, leak_budget,
};
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

/// Lists the alliances in their newest version, retired ones included.
#[utoipa::path(
    get,
    path = "/alliances",
    tag = "policies",
    responses((status = 200, body = Page<Versioned<Alliance>>), Problems)
)]
pub async fn list_alliances(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<Versioned<Alliance>>>, Problem> {
    let read = api.coordinator.read(|state| state.budgets().alliances().cloned().collect());
    Ok(Json(Page::whole(read.await?)))
}

/// Stores a new version of an alliance. Leak budgets and caps of its members count together from now
/// on; refused (`OVER_CAP`) where a cap would be exceeded by that. `If-Match` as for policies.
#[utoipa::path(
    put,
    path = "/alliances/{allianceId}",
    tag = "policies",
    params(("allianceId" = String, Path), ("If-Match" = Option<String>, Header)),
    request_body = Alliance,
    responses((status = 200, body = DocumentVersion), Problems)
)]
pub async fn put_alliance(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
    headers: HeaderMap,
    ApiJson(alliance): ApiJson<Alliance>,
) -> Result<Json<DocumentVersion>, Problem> {
    let put = move |state: &mut ConnectorState, expected, by: &str, now| {
        alliances::put_alliance(state, &id, alliance, expected, by, now)
    };
    documents::keep(&api, &user.principal.user_name, &headers, put).await.map(Json)
}

/// Lists every version of an alliance, newest first.
#[utoipa::path(
    get,
    path = "/alliances/{allianceId}/versions",
    tag = "policies",
    params(("allianceId" = String, Path)),
    responses((status = 200, body = Page<Versioned<Alliance>>), Problems)
)]
pub async fn list_alliance_versions(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<DocumentId>,
) -> Result<Json<Page<Versioned<Alliance>>>, Problem> {
    documents::versions(&api, DocumentKind::Alliance, &id).await
}

/// Leak budget of an alliance over all open fields of its members.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct AllianceLeaks {
    alliance: Versioned<Alliance>,
    /// Fields, rates, precision and warnings. A field that several members get counts once.
    #[serde(flatten)]
    budget: LeakBudget,
}

/// Lists the leak budget of each alliance: the sum over the open fields of its members, and the
/// conclusions that they permit together.
#[utoipa::path(
    get,
    path = "/leak-budgets/alliances",
    tag = "policies",
    responses((status = 200, body = Page<AllianceLeaks>), Problems)
)]
pub async fn list_alliance_budgets(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<AllianceLeaks>>, Problem> {
    let now = now();
    let read = api.coordinator.read(move |state| {
        let open = queries::open_fields(state, now, None);
        let alliances = state.budgets().alliances();
        let in_force = alliances.filter(|alliance| !alliance.document.is_retired);
        let leaks = |alliance: &Versioned<Alliance>| {
            let mut fields: BTreeMap<&FieldKey, &OpenField<'_>> = BTreeMap::new();
            let members = alliance.document.member_list.iter();
            for field in members.filter_map(|member| open.get(member)).flatten() {
                if let Entry::Vacant(entry) = fields.entry(field.key) {
                    entry.insert(field);
                }
            }
            let fields: Vec<OpenField<'_>> = fields.into_values().cloned().collect();
            AllianceLeaks { alliance: alliance.clone(), budget: leak_budget(&fields) }
        };
        in_force.map(leaks).collect()
    });
    Ok(Json(Page::whole(read.await?)))
}
