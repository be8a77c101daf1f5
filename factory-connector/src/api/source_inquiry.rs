//! Inquiries at OPC UA servers that are no source yet.

use axum::{Json, extract::State};
use daemon::web::{ApiJson, Problem};
use serde::{Deserialize, Serialize};
use shop_floor::{ServerOffer, ServerProfile, SourceConfig, SourceProblem, TestedServer};
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::{Problems, shop_floor},
    roles::{Engineer, Viewer},
    sources::with_kept_password,
    view::Page,
};

/// Address to ask.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct DiscoveryBody {
    /// The server's address, `opc.tcp://host:port/path`.
    endpoint_url: String,
}

/// Answer of a server, or the problem that it could not be asked.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceDiscovery {
    offer: Option<ServerOffer>,
    problem: Option<SourceProblem>,
}

/// Asks a server which endpoints it offers. Nothing is stored.
#[utoipa::path(
    post,
    path = "/source-discovery",
    tag = "sources",
    request_body = DiscoveryBody,
    responses((status = 200, body = SourceDiscovery), Problems)
)]
pub async fn discover_source(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<DiscoveryBody>,
) -> Result<Json<SourceDiscovery>, Problem> {
    let _turn = api.machine_turns.take_unsaved(&user.principal.user_name).await?;
    let asked = api.shop_floor.discover(&body.endpoint_url).await.map_err(shop_floor)?;
    let (offer, problem) = parts(asked);
    Ok(Json(SourceDiscovery { offer, problem }))
}

/// Findings of a test, or the problem that kept it from a session.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SourceTest {
    server: Option<TestedServer>,
    problem: Option<SourceProblem>,
}

/// Opens a session with a server as a source would, and closes it again. No source is stored; a certificate of the server
/// that no person has approved is listed with those that servers have shown.
#[utoipa::path(
    post,
    path = "/source-test",
    tag = "sources",
    request_body = SourceConfig,
    responses((status = 200, body = SourceTest), Problems)
)]
pub async fn test_source(
    user: Engineer,
    State(api): State<Api>,
    ApiJson(source): ApiJson<SourceConfig>,
) -> Result<Json<SourceTest>, Problem> {
    let source = with_kept_password(&api, source).await?;
    let _turn = api.machine_turns.take_unsaved(&user.principal.user_name).await?;
    let tested = api.shop_floor.test_source(&source).await.map_err(shop_floor)?;
    let (server, problem) = parts(tested);
    Ok(Json(SourceTest { server, problem }))
}

/// Lists the families of servers that are known: limits, what to expect, what to set at the machine.
#[utoipa::path(
    get,
    path = "/server-profiles",
    tag = "sources",
    responses((status = 200, body = Page<ServerProfile>), Problems)
)]
pub async fn list_server_profiles(_: Viewer) -> Result<Json<Page<ServerProfile>>, Problem> {
    Ok(Json(Page::whole(ServerProfile::all().to_vec())))
}

fn parts<T>(outcome: Result<T, SourceProblem>) -> (Option<T>, Option<SourceProblem>) {
    match outcome {
        Ok(answer) => (Some(answer), None),
        Err(problem) => (None, Some(problem)),
    }
}
