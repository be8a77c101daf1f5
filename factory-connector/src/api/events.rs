//! Server-sent events.

use asi_model::{FieldKey, OperationNetworkId, messages::MappingState};
use axum::{extract::State, http::HeaderMap, response::Response};
use connector_state::{ConnectorEvent, DecisionCounts, FieldEvent, operator::OperationKey};
use daemon::web::events::{ServerSentEvent, last_event_id};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    context::Api,
    problems::Problems,
    roles::{BeforeGate, Viewer},
    values::ShownValue,
};

/// Live event: `event` is its name, `data` says what changed.
#[derive(Serialize, ToSchema)]
#[serde(tag = "event", content = "data", rename_all = "camelCase")]
pub enum LiveEvent {
    /// State of a field that was decided or has another value.
    Field(Box<FieldChangeView>),
    /// Number of fields decided at once.
    Decisions(DecisionCounts),
    /// New revision of a network, or its withdrawal.
    #[serde(rename_all = "camelCase")]
    Inbox { operation_network_id: OperationNetworkId },
    /// New comment on a network.
    #[serde(rename_all = "camelCase")]
    Comment { operation_network_id: OperationNetworkId },
    /// Operation that an operator entered something about; for operators and engineers only.
    Operator(OperationKey),
    /// End of consents.
    #[serde(rename_all = "camelCase")]
    Revocation {
        /// Id of the receipt.
        revocation_id: String,
    },
    /// Change of policies or standing rules.
    Policies {},
    /// New entries of the ledger; at most every other second.
    Ledger {},
    /// Change of the link's or a local server's state.
    Status {},
    /// Loss of events: more happened than the connector remembers, and the page loads afresh.
    Reset {},
}

impl LiveEvent {
    fn new(event: &ConnectorEvent, before_gate: Option<BeforeGate>) -> Self {
        match event {
            ConnectorEvent::Field(change) => {
                Self::Field(Box::new(FieldChangeView::new(change, before_gate)))
            }
            ConnectorEvent::Decisions(made) => Self::Decisions(*made),
            ConnectorEvent::Inbox(id) => Self::Inbox { operation_network_id: id.clone() },
            ConnectorEvent::Comment(id) => Self::Comment { operation_network_id: id.clone() },
            ConnectorEvent::Operator(operation) => Self::Operator(operation.clone()),
            ConnectorEvent::Revocation(id) => Self::Revocation { revocation_id: id.clone() },
            ConnectorEvent::Policies => Self::Policies {},
            ConnectorEvent::Ledger => Self::Ledger {},
            ConnectorEvent::Status => Self::Status {},
        }
    }
}

/// State of a field after a change. The members of the key are there twice, flat and as `key`.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldChangeView {
    #[serde(flatten)]
    address: FieldKey,
    key: FieldKey,
    mapping_state: MappingState,
    /// Number of the consent in force.
    consent_version: u32,
    /// True while no value leaves; for operators and engineers only.
    #[serde(skip_serializing_if = "Option::is_none")]
    is_withheld: Option<bool>,
    /// Newest disclosed value, which the partner has.
    value: Option<ShownValue>,
}

impl FieldChangeView {
    fn new(change: &FieldEvent, before_gate: Option<BeforeGate>) -> Self {
        Self {
            address: change.key.clone(),
            key: change.key.clone(),
            mapping_state: change.mapping_state,
            consent_version: change.consent_version,
            is_withheld: before_gate.map(|_| change.is_withheld),
            value: change.value.as_ref().map(ShownValue::from),
        }
    }
}

/// Streams server-sent events (HTML living standard §9.2). Of each event, the schema's `event` is
/// the line `event:`, and its `data` is the JSON of the line `data:`.
#[utoipa::path(
    get,
    path = "/events",
    tag = "events",
    responses((status = 200, content_type = "text/event-stream", body = LiveEvent), Problems)
)]
pub async fn stream_events(user: Viewer, State(api): State<Api>, headers: HeaderMap) -> Response {
    let reset = ServerSentEvent::of(&LiveEvent::Reset {});
    let before_gate = user.before_gate();
    let log = if before_gate.is_some() { api.events.all() } else { api.events.of_viewers() };
    log.stream(last_event_id(&headers), reset, api.server.shutdown.clone(), move |event| {
        std::future::ready(Ok(Some(ServerSentEvent::of(&LiveEvent::new(&event, before_gate)))))
    })
}
