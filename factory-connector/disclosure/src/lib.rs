//! Disclosure gate: the single point at which values are released to partners.
//!
//! Every candidate - from a mapping, from an OPC UA client, from the operator's page - is coarsened
//! in value *and* time by the policy of the engineer's consent. Only values that the [`Gate`] has
//! released reach the reports, the twin's nodes and the ledger: these take [`Released`] values,
//! which nothing but a gate makes, so that another way does not compile. The gate is pure, without
//! a clock and without I/O, so its guarantees are tested as properties.

mod aggregate;
mod basis;
mod coarsening;
mod decimal;
mod documents;
mod draft_gate;
mod effects;
mod faults;
mod gate;
mod language;
mod leak;
mod policy;
mod rate;
mod released;
mod report_frame;
mod rules;
mod statement;
mod status_codes;
mod strictest;
mod withholding;
mod working_hours;

pub use aggregate::{AggregateFunction, Aggregation, OpenWindow, Sum, WindowAggregate};
pub use basis::DecisionBasis;
pub use decimal::{Decimal, InvalidStep, RoundingStep};
pub use documents::{
    DOCUMENTS_MAX, DocumentId, DocumentVersion, NAME_CHARS_MAX, NamedPolicy, Versioned,
};
pub use draft_gate::DraftGate;
pub use effects::{
    Effect, EffectKind, effects, period_in_words, time_resolution_ms, values_per_hour_max,
};
pub use faults::PolicyFault;
pub use gate::{Gate, GateOutcome, GateState, gate_from_json, gate_to_json};
pub use language::Language;
pub use leak::{
    ALLIANCE_MEMBERS_MAX, Alliance, BITS_PER_HOUR_MAX, BitSum, Cap, CapExcess, CapInForce,
    CapSubject, CapUsage, Conclusion, Exchange, FieldLeak, FieldUse, FormerUse, LeakBudget,
    LeakSummary, LeakWarning, Measured, OpenField, VariableKey, VariableLeak, bits_per_hour,
    leak_budget, leak_summary, leak_warnings, readers, variable_leaks,
};
pub use policy::DisclosurePolicy;
pub use rate::RateLimit;
pub use released::Released;
pub use report_frame::{
    DraftField, DraftOrGate, ReportBody, ReportFrame, ReportOrigin, ReportedField, draft_report,
};
pub use rules::{Rule, RuleAction, RuleCondition, RuleFault, RuleOutcome, outcome};
pub use statement::{Statement, StatementPart, disclosure_statement};
pub use status_codes::StatusCodes;
pub use withholding::{StateValue, WithholdCondition};
pub use working_hours::{ClockTime, Weekday, WorkingHours};
