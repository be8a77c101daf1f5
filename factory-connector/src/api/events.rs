//! What happens, as it happens.

use axum::{extract::State, http::HeaderMap, response::Response};
use daemon::web::events::last_event_id;

use super::{Api, problems::Problems};
use crate::books::ConnectorEvent;

/// Server-sent events: `field` with the field's key, `inbox` and `comment` with the network's id, `operator` with the
/// operation's key, `status`, and `reset` where events were missed and the page must load afresh. They name what changed;
/// values are read.
#[utoipa::path(get, path = "/events", tag = "events", security(("session" = [])),
    responses((status = 200, content_type = "text/event-stream", body = String), Problems))]
pub async fn stream(State(api): State<Api>, headers: HeaderMap) -> Response {
    api.events.stream(last_event_id(&headers), api.shutdown.clone(), |event| {
        Some(match event {
            ConnectorEvent::Field(key) => ("field", serde_json::to_string(key).unwrap_or_default()),
            ConnectorEvent::Inbox(id) => ("inbox", serde_json::json!({ "operationNetworkId": id }).to_string()),
            ConnectorEvent::Comment(id) => ("comment", serde_json::json!({ "operationNetworkId": id }).to_string()),
            ConnectorEvent::Operator(operation) => ("operator", serde_json::to_string(operation).unwrap_or_default()),
            ConnectorEvent::Status => ("status", "{}".to_owned()),
        })
    })
}
