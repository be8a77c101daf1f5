//! Operation networks as received, and what their revisions changed.

use asi_model::{
    FieldKey, OperationNetworkId,
    difference::{NetworkDifference, difference},
    messages::{MappingState, OperationNetworkMessage},
    network::OperationNetwork,
};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, Problem};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::Problems,
    roles::Viewer,
    view::{Page, RequestView, requests},
};
use crate::clock::now;

/// A network in short.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkSummary {
    operation_network_id: String,
    name: Option<String>,
    collaboration_id: Option<String>,
    revision: u64,
    is_withdrawn: bool,
    received_at: asi_model::DateTime,
    request_count: usize,
    field_count: usize,
    pending_count: usize,
}

/// Lists all networks, withdrawn ones included.
#[utoipa::path(
    get,
    path = "/operation-networks",
    tag = "inbox",
    responses((status = 200, body = Page<NetworkSummary>), Problems)
)]
pub async fn list_operation_networks(
    _: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<NetworkSummary>>, Problem> {
    let items = api
        .coordinator
        .read(|state| {
            let summary = |(id, network): (&OperationNetworkId, &connector_state::Network)| {
                let document = network.message.as_ref().map(|message| &message.operation_network);
                let fields = || document.into_iter().flat_map(|document| document.fields());
                let is_pending = |key: &FieldKey| {
                    state.field(key).is_some_and(|field| {
                        field.decision().mapping_state == MappingState::Pending
                    })
                };
                NetworkSummary {
                    operation_network_id: id.to_string(),
                    name: network
                        .message
                        .as_ref()
                        .and_then(|message| message.operation_network.name.clone()),
                    collaboration_id: network
                        .message
                        .as_ref()
                        .map(|message| message.collaboration_id.to_string()),
                    revision: network.revision,
                    is_withdrawn: network.message.is_none(),
                    received_at: network.received_at,
                    request_count: document.map_or(0, |document| document.requests().count()),
                    field_count: fields().count(),
                    pending_count: fields().filter(|(key, ..)| is_pending(key)).count(),
                }
            };
            state.networks().iter().map(summary).collect()
        })
        .await?;
    Ok(Json(Page::whole(items)))
}

/// A network with its requests.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NetworkView {
    /// The message as received; none once withdrawn.
    message: Option<OperationNetworkMessage>,
    revision: u64,
    requests: Vec<RequestView>,
}

/// Shows a network as received, and the state of its requests and fields.
#[utoipa::path(
    get,
    path = "/operation-networks/{operationNetworkId}",
    tag = "inbox",
    params(("operationNetworkId" = String, Path)),
    responses((status = 200, body = NetworkView), Problems)
)]
pub async fn show_operation_network(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<NetworkView>, Problem> {
    let (wanted, before_gate) = (id.clone(), user.before_gate());
    let view = api
        .coordinator
        .read(move |state| {
            state.networks().get(&wanted).map(|network| NetworkView {
                message: network.message.as_deref().cloned(),
                revision: network.revision,
                requests: requests(state, &wanted, now(), before_gate),
            })
        })
        .await?;
    view.map(Json).ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))
}

/// Difference between the revision in force and the one before.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RevisionDifference {
    /// The revision in force.
    revision: u64,
    /// The one before it; none for the first.
    previous_revision: Option<u64>,
    /// Changed operations, relations and requests, and each changed field with the reasons and the
    /// effect on its mapping and on the consent.
    difference: NetworkDifference,
}

/// Compares the revision in force of a network with the one before.
#[utoipa::path(
    get,
    path = "/operation-networks/{operationNetworkId}/news",
    tag = "inbox",
    params(("operationNetworkId" = String, Path)),
    responses((status = 200, body = RevisionDifference), Problems)
)]
pub async fn show_revision_difference(
    _: Viewer,
    State(api): State<Api>,
    ApiPath(id): ApiPath<OperationNetworkId>,
) -> Result<Json<RevisionDifference>, Problem> {
    let found = api.store().await?.networks().revisions(&id).await?;
    let found = found.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    let nothing = OperationNetwork {
        operation_network_id: id,
        name: None,
        description: None,
        operation_list: Vec::new(),
        operation_relation_list: Vec::new(),
    };
    let before = found.previous.as_ref().map_or(&nothing, |message| &message.operation_network);
    Ok(Json(RevisionDifference {
        revision: found.current.revision,
        previous_revision: found.previous.as_ref().map(|message| message.revision),
        difference: difference(before, &found.current.operation_network),
    }))
}
