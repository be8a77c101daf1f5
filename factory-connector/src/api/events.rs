//! Server-sent events.

use axum::{extract::State, http::HeaderMap, response::Response};
use connector_state::{ConnectorEvent, FieldEvent};
use daemon::web::events::last_event_id;

use super::{context::Api, problems::Problems, roles::Viewer};
use crate::values::ShownValue;

/// State of a field after a change. The members of the key are there twice, flat and as `key`.
#[derive(serde::Serialize)]
#[serde(rename_all = "camelCase")]
struct FieldChangeView<'c> {
    #[serde(flatten)]
    address: &'c asi_model::FieldKey,
    key: &'c asi_model::FieldKey,
    mapping_state: asi_model::messages::MappingState,
    consent_version: u32,
    is_withheld: bool,
    value: Option<ShownValue>,
}

impl<'c> From<&'c FieldEvent> for FieldChangeView<'c> {
    fn from(change: &'c FieldEvent) -> Self {
        Self {
            address: &change.key,
            key: &change.key,
            mapping_state: change.mapping_state,
            consent_version: change.consent_version,
            is_withheld: change.is_withheld,
            value: change.value.as_ref().map(ShownValue::from),
        }
    }
}

/// Streams server-sent events: `field` with the field's key, its state and its newest disclosed
/// value, `decisions` with the number of fields decided at once and of those decided by standing
/// rules, `inbox` and `comment` with the network's id, `operator` with the operation's key,
/// `revocation` with the receipt's id, `policies`, `ledger` every other second while it grows,
/// `status` when the link or a local server changes its state, and `reset` when events were missed
/// and the page must load again.
#[utoipa::path(
    get,
    path = "/events",
    tag = "events",
    responses((status = 200, content_type = "text/event-stream", body = String), Problems)
)]
pub async fn stream_events(_: Viewer, State(api): State<Api>, headers: HeaderMap) -> Response {
    api.events.stream(last_event_id(&headers), api.server.shutdown.clone(), |event| {
        Some(match event {
            ConnectorEvent::Field(change) => (
                "field",
                serde_json::to_string(&FieldChangeView::from(&**change)).unwrap_or_default(),
            ),
            ConnectorEvent::Inbox(id) => {
                ("inbox", serde_json::json!({ "operationNetworkId": id }).to_string())
            }
            ConnectorEvent::Comment(id) => {
                ("comment", serde_json::json!({ "operationNetworkId": id }).to_string())
            }
            ConnectorEvent::Operator(operation) => {
                ("operator", serde_json::to_string(operation).unwrap_or_default())
            }
            ConnectorEvent::Decisions(made) => {
                ("decisions", serde_json::to_string(made).unwrap_or_default())
            }
            ConnectorEvent::Ledger => ("ledger", "{}".to_owned()),
            ConnectorEvent::Policies => ("policies", "{}".to_owned()),
            ConnectorEvent::Revocation(id) => {
                ("revocation", serde_json::json!({ "revocationId": id }).to_string())
            }
            ConnectorEvent::Status => ("status", "{}".to_owned()),
        })
    })
}
