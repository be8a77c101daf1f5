//! Live events for pages, published after the commit, each to its audience only.

use asi_model::{
    DateTime, FactoryId, FieldKey, OperationNetworkId, OrganisationId, RequestKey,
    messages::{Fault, MappingState},
};
use daemon::web::events::EventLog;
use serde::Serialize;
use utoipa::ToSchema;

use crate::{
    accesses::{Contents, Values, Withheld},
    opaque_id::OpaqueId,
    progress::OperationProgress,
    store::{CurrentValue, PartState},
};

/// The log behind `GET /live`.
pub type LiveLog = EventLog<Notification>;

/// Most events that are retained for pages that catch up.
pub const EVENTS_MAX: usize = 20_000;

/// An event and who may know of it.
#[derive(Debug, Clone)]
pub struct Notification {
    /// An event for pages, with the values that it brings.
    event: Withheld<LiveEvent>,
    /// The organisations that may know.
    pub audience: Vec<OrganisationId>,
    /// True if administrators of any organisation may see it: structure yes, values no.
    pub is_structure: bool,
}

/// Live event: `event` is its name, `data` says what changed.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(tag = "event", content = "data", rename_all = "camelCase")]
pub enum LiveEvent {
    /// Newer values, brought by a report.
    #[serde(rename_all = "camelCase")]
    Value {
        /// The request it answers.
        #[serde(flatten)]
        request: RequestKey,
        factory_id: FactoryId,
        /// The values, each as `GET /operation-networks/{operationNetworkId}` would show it now.
        fields: Vec<FieldUpdate>,
    },
    /// Decision of the factory's engineer about a field.
    #[serde(rename_all = "camelCase")]
    Decision {
        key: FieldKey,
        /// `PENDING`, `MAPPED` or `REFUSED`.
        mapping_state: MappingState,
        /// The engineer's reason; absent for whom the decision may not have been made.
        reason: Option<String>,
        decided_at: DateTime,
    },
    /// State of a factory's part after it was sent or answered.
    #[serde(rename_all = "camelCase")]
    Part {
        operation_network_id: OperationNetworkId,
        factory_id: FactoryId,
        /// The part's revision; absent for those who may know the state alone.
        revision: Option<u64>,
        state: PartState,
        /// Faults for which it was rejected.
        fault_list: Vec<Fault>,
    },
    /// Sign of life of a factory: for its own organisation at most once a second, for others at most
    /// once a minute, unless its publisher's state changes.
    #[serde(rename_all = "camelCase")]
    Factory {
        factory_id: FactoryId,
        /// Time as `GET /factories` shows it to the same viewer.
        last_seen_at: DateTime,
        /// State that its publisher reported last.
        publisher_state: Option<String>,
    },
    /// Progress of an operation, as far as this audience may know.
    #[serde(rename_all = "camelCase")]
    Progress {
        operation_network_id: OperationNetworkId,
        #[serde(flatten)]
        operation: OperationProgress,
    },
    /// New revision of a network that changed what the viewer sees of it, or its withdrawal.
    #[serde(rename_all = "camelCase")]
    Network { operation_network_id: OperationNetworkId, revision: u64 },
    /// Comment that was added to a network.
    #[serde(rename_all = "camelCase")]
    Comment {
        /// The network talked about.
        operation_network_id: OperationNetworkId,
        comment_id: OpaqueId,
    },
    /// Loss of events: more happened than the platform remembers, and the page loads afresh.
    Reset {},
}

/// A newer value of a field.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldUpdate {
    pub key: FieldKey,
    /// The value; 64-bit integers are texts.
    #[schema(value_type = asi_model::openapi::PlainValue)]
    pub value: serde_json::Value,
    /// Its quality, by the standard's name.
    pub status: String,
    /// Source timestamp: time of the measurement.
    pub source_timestamp: Option<DateTime>,
    /// Time of the report at the connector.
    pub report_timestamp: Option<DateTime>,
    /// Time of arrival at the platform.
    pub received_at: DateTime,
    pub epoch: u32,
    /// The report's sequence number.
    pub sequence: u32,
}

impl From<&CurrentValue> for FieldUpdate {
    fn from(value: &CurrentValue) -> Self {
        Self {
            key: value.key.clone(),
            value: value.value.clone(),
            status: value.status.to_string(),
            source_timestamp: value.source_timestamp,
            report_timestamp: value.report_timestamp,
            received_at: value.received_at,
            epoch: value.epoch,
            sequence: value.sequence,
        }
    }
}

impl Notification {
    /// Addresses values to an audience.
    #[must_use]
    pub const fn of_values(event: Withheld<LiveEvent>, audience: Vec<OrganisationId>) -> Self {
        Self { event, audience, is_structure: false }
    }
}

impl LiveEvent {
    /// Addresses the event to an audience.
    #[must_use]
    pub fn to(self, audience: Vec<OrganisationId>) -> Notification {
        let is_structure =
            matches!(self, Self::Part { .. } | Self::Factory { .. } | Self::Network { .. });
        Notification { event: Withheld::new(self), audience, is_structure }
    }
}

impl Values for LiveEvent {
    /// Returns the values of a `value` event. Progress brings the contents of the fields that it was
    /// derived from; no other event has values.
    fn contents(&self) -> Vec<Contents> {
        let Self::Value { request, factory_id, fields } = self else { return Vec::new() };
        Contents::gather(fields.iter().map(|field| {
            let at = field.source_timestamp.or(field.report_timestamp);
            (factory_id, request, field.key.field_name.as_str(), at)
        }))
    }
}

impl Notification {
    /// Addresses the progress of an operation.
    #[must_use]
    pub fn progress(
        operation_network_id: OperationNetworkId,
        operation: Withheld<OperationProgress>,
        audience: Vec<OrganisationId>,
    ) -> Self {
        let event = operation.map_with(operation_network_id, |operation_network_id, operation| {
            LiveEvent::Progress { operation_network_id, operation }
        });
        Self { event, audience, is_structure: false }
    }

    /// Returns the event if a viewer for `organisation` (or, without one, as administrator) may see
    /// it, once that is on record.
    #[must_use]
    pub fn shown_to(
        &self,
        organisation: Option<&OrganisationId>,
        is_administrator: bool,
    ) -> Option<&Withheld<LiveEvent>> {
        let is_concerned = organisation.is_some_and(|id| self.audience.contains(id));
        let is_shown = is_concerned || (is_administrator && self.is_structure);
        is_shown.then_some(&self.event)
    }
}
