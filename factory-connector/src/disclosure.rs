//! The disclosure gate: the one place where a value becomes something a partner may know.
//!
//! Every candidate - from a mapping, from an OPC UA client, from the operator's page - is coarsened in value *and* time
//! as the engineer's consent says, and only what [`Gate`] has released can reach the reporter, the twin's nodes and the
//! ledger. The gate is pure: it has no clock and does no I/O, so its promises are stated as properties and tested.

mod coarsening;
mod decimal;
mod gate;
mod policy;
mod working_hours;

pub use decimal::{Decimal, InvalidStep, RoundingStep};
pub use gate::{Gate, GateState, Outcome};
pub use policy::{DisclosurePolicy, PolicyFault};
pub use working_hours::{ClockTime, Weekday, WorkingHours};
