//! State of a factory connector: networks, requested fields with their gates, data set writers,
//! policies, caps, journals of operators, and the ends of the ledger's chains.
//!
//! Pure: no I/O, no clock, no task, no database. Each registry owns its data behind private fields;
//! [`ConnectorState`] only composes them. A use case ([`use_cases`]) is a function of state, input
//! and time. It changes the state and returns a [`ChangeSet`] (candidates and what falls due change
//! gates only, of which [`transaction`] collects what they released): [`Writes`] for the store, and
//! [`Effects`] that follow once these are committed. [`transaction`] turns the change sets of one
//! transaction into what is committed; its types fix the order of the steps.

mod budgets;
mod change_set;
mod consents;
mod control_body;
mod dependencies;
mod documents;
mod effects;
mod endings;
mod fields;
mod former_disclosures;
mod gates;
mod ids;
mod into_changes;
mod journals;
mod keep_alive_schedule;
mod ledger_chains;
mod load;
mod log_record;
mod networks;
pub mod operator;
pub mod past;
mod past_decisions;
mod policies;
pub mod queries;
mod recipient_policy;
#[cfg(any(test, feature = "scene"))]
pub mod scene;
mod snapshot;
mod state;
#[cfg(test)]
mod tests;
pub mod transaction;
pub mod use_cases;
mod writers;
pub mod writes;

pub use budgets::BudgetRegistry;
pub use change_set::ChangeSet;
pub use control_body::{ControlBody, KeepAliveBody};
pub use documents::DocumentError;
pub use effects::{
    ConnectorEvent, DecisionCounts, Effects, EngineCommand, FieldEvent, LinkSignals, TwinUpdate,
};
pub use fields::{
    DisclosureRate, Field, FieldDecision, FieldRegistry, MappingVersions, ShadowMapping, Validity,
};
pub use former_disclosures::{FormerDisclosure, FormerDisclosureRegistry};
pub use ids::IdSource;
pub use into_changes::IntoChanges;
pub use journals::JournalRegistry;
pub use ledger_chains::LedgerChains;
pub use load::UnreadableState;
pub use log_record::LogRecord;
pub use networks::{Network, NetworkRegistry};
pub use past_decisions::PastDecisionRegistry;
pub use policies::PolicyRegistry;
pub use recipient_policy::RecipientPolicy;
pub use snapshot::{
    FormerRetention, Snapshot, StoredBudgets, StoredLedger, StoredMappings, StoredNetwork,
    StoredPolicies,
};
pub use state::{ConnectorState, StateConfig};
pub use writers::{Writer, WriterRegistry};
pub use writes::Writes;
