//! Live news for pages, told after the commit of what they tell, and only to whom it may concern.

use asi_model::{
    DateTime, FactoryId, FieldKey, OperationNetworkId, OrganisationId, RequestKey, messages::Fault,
};
use daemon::web::events::EventLog;
use serde::Serialize;

use crate::{progress::OperationProgress, store::PartState};

/// The log behind `GET /live`.
pub type LiveLog = EventLog<News>;

/// Events kept for pages that catch up.
pub const EVENTS_KEPT_MAX: usize = 20_000;

/// An event and who may know of it.
#[derive(Debug, Clone)]
pub struct News {
    /// What happened.
    pub event: LiveEvent,
    /// The organisations that may know.
    pub audience: Vec<OrganisationId>,
    /// Whether administrators without an organisation may know, too: structure yes, values no.
    pub is_structure: bool,
}

/// What happened.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged, rename_all_fields = "camelCase")]
pub enum LiveEvent {
    /// `value`: a report brought newer values.
    Value {
        /// The request it answers.
        #[serde(flatten)]
        request: RequestKey,
        /// Who reported.
        factory_id: FactoryId,
        /// The values, each as `GET /operation-networks/{operationNetworkId}` would show it now.
        fields: Vec<ValueNews>,
    },
    /// `decision`: the factory's engineer decided about a field.
    Decision {
        /// The field.
        key: FieldKey,
        /// `PENDING`, `MAPPED` or `REFUSED`.
        mapping_state: asi_model::messages::MappingState,
        /// Why.
        reason: Option<String>,
        /// When.
        decided_at: DateTime,
    },
    /// `part`: a factory was sent its part, or answered.
    Part {
        /// The network.
        operation_network_id: OperationNetworkId,
        /// The factory.
        factory_id: FactoryId,
        /// The part's revision.
        revision: u64,
        /// How it stands.
        state: PartState,
        /// Why it was rejected.
        fault_list: Vec<Fault>,
    },
    /// `factory`: something arrived of a factory; at most once a second each.
    Factory {
        /// The factory.
        factory_id: FactoryId,
        /// When.
        last_seen_at: DateTime,
        /// What its publisher said of itself last.
        publisher_state: Option<String>,
    },
    /// `progress`: how an operation stands, as far as this audience may know.
    Progress {
        /// The network.
        operation_network_id: OperationNetworkId,
        /// The operation.
        #[serde(flatten)]
        operation: OperationProgress,
    },
    /// `network`: a new revision, or a withdrawal.
    Network {
        /// The network.
        operation_network_id: OperationNetworkId,
        /// Its revision.
        revision: u64,
    },
    /// `comment`: somebody said something.
    Comment {
        /// The network talked about.
        operation_network_id: OperationNetworkId,
        /// The comment's number.
        comment_id: u64,
    },
}

/// A newer value of a field.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ValueNews {
    /// The field.
    pub key: FieldKey,
    /// The value; 64-bit integers are texts.
    pub value: serde_json::Value,
    /// Its quality, by the standard's name.
    pub status: String,
    /// When the source measured it.
    pub source_timestamp: Option<DateTime>,
    /// When the connector reported it.
    pub report_timestamp: Option<DateTime>,
    /// When it arrived.
    pub received_at: DateTime,
    /// The writer's epoch.
    pub epoch: u32,
    /// The report's sequence number.
    pub sequence: u32,
}

impl LiveEvent {
    /// The event's name on the stream.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Value { .. } => "value",
            Self::Decision { .. } => "decision",
            Self::Part { .. } => "part",
            Self::Factory { .. } => "factory",
            Self::Progress { .. } => "progress",
            Self::Network { .. } => "network",
            Self::Comment { .. } => "comment",
        }
    }

    /// The event for an audience.
    #[must_use]
    pub const fn to(self, audience: Vec<OrganisationId>) -> News {
        let is_structure = matches!(
            self,
            Self::Part { .. } | Self::Factory { .. } | Self::Network { .. } | Self::Comment { .. }
        );
        News { event: self, audience, is_structure }
    }
}

impl News {
    /// Name and JSON of the event, if somebody who looks for `organisation` (or, without one, as
    /// administrator) may know of it.
    #[must_use]
    pub fn shown_to(
        &self,
        organisation: Option<&OrganisationId>,
        is_administrator: bool,
    ) -> Option<(&'static str, String)> {
        let is_concerned = organisation.is_some_and(|id| self.audience.contains(id));
        let is_shown = is_concerned || (is_administrator && self.is_structure);
        if !is_shown {
            return None;
        }
        serde_json::to_string(&self.event).ok().map(|json| (self.event.name(), json))
    }
}
