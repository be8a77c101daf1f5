//! Status of the connector.

use asi_model::DateTime;
use axum::{Json, extract::State};
use daemon::web::Problem;
use serde::Serialize;
use shop_floor::SourceStatus;
use utoipa::ToSchema;

use super::{context::Api, problems::Problems, roles::Viewer};
use crate::clock::now;

/// Status of the connector, with evidence.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Status {
    factory_id: String,
    version: &'static str,
    started_at: DateTime,
    /// Clock of the connector; pages compute ages from it.
    now: DateTime,
    /// Link to the platform: `state` (connecting, up, down, stopped), `since` and `reason`.
    #[schema(value_type = Object)]
    link: serde_json::Value,
    /// Lease to speak for the factory: `state` (`ASKING`, `HELD`, `REFUSED`), `since`, and the other
    /// connector with the factory's credential (`holder`, `contender`).
    #[schema(value_type = Object)]
    lease: serde_json::Value,
    /// OPC UA server: `endpointUrl`.
    #[schema(value_type = Object)]
    twin: serde_json::Value,
    /// Backlog of the spool.
    #[schema(value_type = Object)]
    spool: serde_json::Value,
    /// Status of each local server.
    sources: Vec<SourceStatus>,
}

/// Shows the status of the connector.
#[utoipa::path(
    get,
    path = "/status",
    tag = "status",
    responses((status = 200, body = Status), Problems)
)]
pub async fn show_status(_: Viewer, State(api): State<Api>) -> Result<Json<Status>, Problem> {
    let link = api.link.as_ref().map(|link| link.state().borrow().clone());
    let mut link = link.and_then(|state| serde_json::to_value(state).ok()).unwrap_or_default();
    // The phase is an object `{state, ...}`: its members belong to the link itself.
    if let Some(members) = link.as_object_mut()
        && let Some(serde_json::Value::Object(phase)) = members.remove("phase")
    {
        members.extend(phase);
    }
    // Pages need one number here; `spool` has the rest.
    if let Some(waiting) = link.pointer("/backlog/waiting").cloned() {
        link["backlog"] = waiting;
    }
    let backlog = api.store().await?.spool().backlog().await?;
    Ok(Json(Status {
        factory_id: api.instance.factory_id.to_string(),
        version: env!("CARGO_PKG_VERSION"),
        started_at: api.instance.started_at,
        now: now(),
        link,
        lease: serde_json::to_value(&*api.lease.borrow()).unwrap_or_default(),
        twin: serde_json::json!({ "endpointUrl": api.twin.endpoint().borrow().clone() }),
        spool: serde_json::to_value(backlog).unwrap_or_default(),
        sources: api.shop_floor.states(),
    }))
}
