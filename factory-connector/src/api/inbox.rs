//! What partners ask.

use asi_model::OperationNetworkId;
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{
    Api,
    problems::Problems,
    view::{Page, RequestView, requests},
};

/// Requests per page.
const PAGE: usize = 200;

/// Which page.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct InboxQuery {
    /// `nextCursor` of the page before.
    cursor: Option<usize>,
}

/// Lists the requests of all active networks with their fields.
#[utoipa::path(get, path = "/inbox", tag = "inbox", security(("session" = [])), params(InboxQuery),
    responses((status = 200, body = Page<RequestView>), Problems))]
pub async fn list(
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<InboxQuery>,
) -> Result<Json<Page<RequestView>>, Problem> {
    let from = query.cursor.unwrap_or(0);
    let mut views = api.desk.read(|books| requests(books, None)).await?;
    let next_cursor = (views.len() > from + PAGE).then(|| (from + PAGE).to_string());
    let items = views.drain(from.min(views.len())..).take(PAGE).collect();
    Ok(Json(Page { items, next_cursor }))
}

/// A network in short.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkSummary {
    operation_network_id: String,
    name: Option<String>,
    collaboration_id: Option<String>,
    revision: u64,
    is_withdrawn: bool,
    #[schema(value_type = String, format = "date-time")]
    received_at: asi_model::DateTime,
    request_count: usize,
    field_count: usize,
    pending_count: usize,
}

/// Lists all networks, withdrawn ones included.
#[utoipa::path(get, path = "/operation-networks", tag = "inbox", security(("session" = [])),
    responses((status = 200, body = Page<NetworkSummary>), Problems))]
pub async fn networks(State(api): State<Api>) -> Result<Json<Page<NetworkSummary>>, Problem> {
    let items = api
        .desk
        .read(|books| {
            let summary = |(id, network): (&OperationNetworkId, &crate::books::Network)| {
                let views = requests(books, Some(id));
                let fields = || views.iter().flat_map(|view| &view.fields);
                let pending = asi_model::messages::MappingState::Pending;
                NetworkSummary {
                    operation_network_id: id.to_string(),
                    name: network.message.as_ref().and_then(|message| message.operation_network.name.clone()),
                    collaboration_id: network.message.as_ref().map(|message| message.collaboration_id.to_string()),
                    revision: network.revision,
                    is_withdrawn: network.message.is_none(),
                    received_at: network.received_at,
                    request_count: views.len(),
                    field_count: fields().count(),
                    pending_count: fields().filter(|field| field.mapping_state == pending).count(),
                }
            };
            books.networks.iter().map(summary).collect()
        })
        .await?;
    Ok(Json(Page::whole(items)))
}

/// A network with its requests.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkView {
    /// The message as received; none once withdrawn.
    #[schema(value_type = Option<Object>)]
    message: Option<serde_json::Value>,
    /// Its revision.
    revision: u64,
    /// Its requests.
    requests: Vec<RequestView>,
}

/// Shows a network as received, and how its fields stand.
#[utoipa::path(get, path = "/operation-networks/{operationNetworkId}", tag = "inbox", security(("session" = [])),
    params(("operationNetworkId" = String, Path)), responses((status = 200, body = NetworkView), Problems))]
pub async fn network(
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<NetworkView>, Problem> {
    let wanted = id.clone();
    let view = api
        .desk
        .read(move |books| {
            books.networks.get(&wanted).map(|network| NetworkView {
                message: network.message.as_ref().and_then(|message| serde_json::to_value(&**message).ok()),
                revision: network.revision,
                requests: requests(books, Some(&wanted)),
            })
        })
        .await?;
    view.map(Json).ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))
}
