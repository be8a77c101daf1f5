//! What happens, as it happens.

use axum::{extract::State, http::HeaderMap, response::Response};
use daemon::web::events::last_event_id;

use super::{Api, problems::Problems, roles::Viewer};
use crate::{
    books::{ConnectorEvent, FieldNews},
    values::ShownValue,
};

/// A field's address flat, as its key is, with what is new.
#[derive(serde::Serialize)]
#[serde(rename_all = "camelCase")]
struct FieldNewsView<'n> {
    #[serde(flatten)]
    address: &'n asi_model::FieldKey,
    key: &'n asi_model::FieldKey,
    mapping_state: asi_model::messages::MappingState,
    consent_version: u32,
    is_withheld: bool,
    value: Option<ShownValue>,
}

impl<'n> From<&'n FieldNews> for FieldNewsView<'n> {
    fn from(news: &'n FieldNews) -> Self {
        Self {
            address: &news.key,
            key: &news.key,
            mapping_state: news.mapping_state,
            consent_version: news.consent_version,
            is_withheld: news.is_withheld,
            value: news.value.as_ref().map(ShownValue::from),
        }
    }
}

/// Server-sent events: `field` with the field's key, its state and its newest disclosed value,
/// `decisions` with how many fields were decided at once and how many of them by standing rules,
/// `inbox` and `comment` with the network's id, `operator` with the operation's key, `revocation`
/// with the receipt's id, `policies`, `ledger` every other second while it grows, `status` where
/// the link or a local server changes its state, and `reset` where events were missed and the page
/// must load afresh.
#[utoipa::path(
    get,
    path = "/events",
    tag = "events",
    responses((status = 200, content_type = "text/event-stream", body = String), Problems)
)]
pub async fn stream_events(_: Viewer, State(api): State<Api>, headers: HeaderMap) -> Response {
    api.events.stream(last_event_id(&headers), api.shutdown.clone(), |event| {
        Some(match event {
            ConnectorEvent::Field(news) => {
                ("field", serde_json::to_string(&FieldNewsView::from(&**news)).unwrap_or_default())
            }
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
