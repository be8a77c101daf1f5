//! Effects of a transaction, published once it is committed.

use std::collections::BTreeMap;

use asi_model::{FieldKey, OperationNetworkId, messages::MappingState};
use disclosure::Released;
use mapping::{MappingId, PublishRequest};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{log_record::LogRecord, operator::OperationKey};

/// Effects on the log, the twin, the mapping engine, the link and open pages, published in this
/// order.
#[derive(Debug, Default, PartialEq)]
pub struct Effects {
    /// Changes of the twin's nodes.
    pub twin: Vec<TwinUpdate>,
    /// Newly disclosed values for the twin's nodes, the newest of each field.
    pub values: Vec<(FieldKey, Released)>,
    /// Commands for the mapping engine.
    pub engine: Vec<EngineCommand>,
    /// Signals for the link.
    pub link: LinkSignals,
    /// The newest state of each field that changed, by field number, for open pages.
    pub fields: BTreeMap<i64, FieldEvent>,
    /// Other events for open pages, in order.
    pub events: Vec<ConnectorEvent>,
    pub decisions: DecisionCounts,
    /// Number of reports to send again.
    pub resent_report_count: u64,
    /// Records for the log, in order.
    pub log: Vec<LogRecord>,
}

impl Effects {
    /// Returns true where nothing is to be published.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn merge(&mut self, later: Self) {
        let Self {
            twin,
            values,
            engine,
            link,
            fields,
            events,
            decisions,
            resent_report_count,
            log,
        } = later;
        self.twin.extend(twin);
        self.values.extend(values);
        self.engine.extend(engine);
        self.link.is_spool_filled |= link.is_spool_filled;
        self.link.is_spool_rewound |= link.is_spool_rewound;
        self.link.is_receipted |= link.is_receipted;
        self.fields.extend(fields);
        self.events.extend(events);
        self.decisions.count += decisions.count;
        self.decisions.rule_count += decisions.rule_count;
        self.resent_report_count += resent_report_count;
        self.log.extend(log);
    }

    /// Takes the events for open pages.
    #[must_use]
    pub fn take_events(&mut self) -> Vec<ConnectorEvent> {
        let mut events = std::mem::take(&mut self.events);
        let fields = std::mem::take(&mut self.fields).into_values();
        events.extend(fields.map(|field| ConnectorEvent::Field(Box::new(field))));
        if self.decisions.count > 0 {
            events.push(ConnectorEvent::Decisions(self.decisions));
        }
        events
    }
}

/// Signals for the link: reasons to read the spool again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LinkSignals {
    /// The spool has new messages.
    pub is_spool_filled: bool,
    /// Messages that were sent or fetched wait again.
    pub is_spool_rewound: bool,
    /// The platform confirmed reports, so the backlog is smaller.
    pub is_receipted: bool,
}

/// Number of decisions in one transaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DecisionCounts {
    /// All decisions, those of standing rules included.
    pub count: usize,
    /// Decisions of standing rules among them.
    pub rule_count: usize,
}

/// A change of the twin's nodes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TwinUpdate {
    /// A network is new or revised.
    Apply(OperationNetworkId),
    /// A network was withdrawn.
    Remove(OperationNetworkId),
    /// A field was decided.
    Decision(FieldKey),
}

/// A command for the mapping engine.
#[derive(Debug, Clone, PartialEq)]
pub enum EngineCommand {
    /// Publish a new or changed mapping, or a shadow mapping.
    Put(PublishRequest),
    Remove(MappingId),
}

impl EngineCommand {
    /// Leaves a mapping alone that the engine runs already.
    pub(crate) fn going_on(self) -> Self {
        match self {
            Self::Put(request) => Self::Put(PublishRequest { goes_on: true, ..request }),
            Self::Remove(id) => Self::Remove(id),
        }
    }
}

/// An event for open pages.
#[derive(Debug, Clone, PartialEq)]
pub enum ConnectorEvent {
    /// A field was decided or has another value.
    Field(Box<FieldEvent>),
    /// A network is new, revised or withdrawn.
    Inbox(OperationNetworkId),
    /// A user commented on a network.
    Comment(OperationNetworkId),
    /// An operator entered something about an operation.
    Operator(OperationKey),
    /// Fields were decided, one or many at once.
    Decisions(DecisionCounts),
    /// The ledger has new entries; published from time to time.
    Ledger,
    /// Policies or standing rules changed.
    Policies,
    /// A consent ended; the id of its receipt.
    Revocation(String),
    /// The state of link, spool, twin or sources changed.
    Status,
}

/// State of a field after a change.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldEvent {
    pub key: FieldKey,
    pub mapping_state: MappingState,
    /// Number of the consent in force.
    pub consent_version: u32,
    /// A state of the plant withholds all values at present.
    pub is_withheld: bool,
    /// The value that the partner has.
    pub value: Option<Released>,
}
