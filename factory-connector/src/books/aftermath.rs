//! What is to be done once a transaction is committed.

use crate::operator::OperationKey;
use asi_model::{DataValue, FieldKey, OperationNetworkId, messages::MappingState};
use mapping_engine::{MappingId, Published};

/// Work for the other rooms, in this order: twin, mapping engine, link, pages.
#[derive(Debug, Default)]
pub struct Aftermath {
    /// What the twin shows.
    pub twin: Vec<TwinWork>,
    /// Newly disclosed values, the newest of each field, for the twin's nodes.
    pub values: Vec<(FieldKey, DataValue)>,
    /// What the mapping engine runs.
    pub mappings: Vec<MappingWork>,
    /// The spool has new messages.
    pub is_spool_filled: bool,
    /// Messages that were sent wait again.
    pub is_spool_rewound: bool,
    /// A receipt came.
    pub is_receipted: bool,
    /// What pages are told.
    pub events: Vec<ConnectorEvent>,
    /// How many decisions were made.
    pub decisions: Decisions,
}

/// How many decisions one transaction has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Decisions {
    /// All of them.
    pub count: usize,
    /// Of them, those that standing rules made.
    pub rule_count: usize,
}

impl Aftermath {
    /// How a field stands, to be said anew: what was to be told before is told no more.
    pub(super) fn news_of(&mut self, place: &mut usize, key: &FieldKey) -> &mut FieldNews {
        if !matches!(self.events.get(*place), Some(ConnectorEvent::Field(older)) if older.key == *key)
        {
            *place = self.events.len();
            self.events.push(ConnectorEvent::Field(Box::new(FieldNews {
                key: key.clone(),
                mapping_state: MappingState::Pending,
                consent_version: 0,
                is_withheld: false,
                value: None,
            })));
        }
        match &mut self.events[*place] {
            ConnectorEvent::Field(news) => news,
            other => unreachable!("{other:?} is at the place of a field's news"),
        }
    }

    /// There is nothing to do.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.twin.is_empty()
            && self.values.is_empty()
            && self.mappings.is_empty()
            && self.events.is_empty()
            && self.decisions.count == 0
            && !(self.is_spool_filled || self.is_spool_rewound || self.is_receipted)
    }
}

/// A change of what the twin shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TwinWork {
    /// A network came or changed.
    Apply(OperationNetworkId),
    /// A network was withdrawn.
    Remove(OperationNetworkId),
    /// A field was decided.
    Decision(FieldKey),
}

/// A change of what the mapping engine runs.
#[derive(Debug, Clone)]
pub enum MappingWork {
    /// A mapping is new or changed, or runs as a shadow beside the one in force.
    Put(Published),
    /// A mapping ended.
    Remove(MappingId),
}

/// What pages are told.
#[derive(Debug, Clone, PartialEq)]
pub enum ConnectorEvent {
    /// A field was decided or has another value.
    Field(Box<FieldNews>),
    /// A network came, changed or was withdrawn.
    Inbox(OperationNetworkId),
    /// A remark was made.
    Comment(OperationNetworkId),
    /// Something was entered about an operation.
    Operator(OperationKey),
    /// Fields were decided, one or many at once.
    Decisions(Decisions),
    /// The ledger has new entries; told from time to time.
    Ledger,
    /// Policies or rules changed.
    Policies,
    /// A consent ended; the receipt's id.
    Revocation(String),
    /// Link, spool, twin or sources changed.
    Status,
}

/// How a field stands after something happened to it.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldNews {
    /// Which.
    pub key: FieldKey,
    /// What was decided.
    pub mapping_state: MappingState,
    /// Counts the consents.
    pub consent_version: u32,
    /// Nothing leaves at present because of a state.
    pub is_withheld: bool,
    /// What the partner has.
    pub value: Option<DataValue>,
}
