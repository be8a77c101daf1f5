//! Use cases: functions of state, input and time that return what they changed.
//!
//! A use case that fails changes nothing. The exceptions return no
//! [`ChangeSet`](crate::ChangeSet), since what they change is in memory alone:
//!
//! - [`values::receive_candidates`], [`values::receive_candidate`], [`values::write_value`],
//!   [`values::release_due`] and [`validity::begin_requests`] change gates. There are many values
//!   per second, so the registries note which fields changed and which writers have something to
//!   report, and the transaction collects each of them once.
//! - [`values::set_clock_back`] moves times that gates, keep-alives and former disclosures wait for.
//!   None of it is stored: a restart finds the clock as it is.
//! - [`keep_alive::keep_alives`] returns messages that are sent once and never stored.

pub mod alliances;
pub mod caps;
pub mod comments;
pub mod configuration;
pub mod decide;
pub mod decide_past;
pub mod deliver;
pub mod enter;
pub mod import_mappings;
pub mod keep_alive;
pub mod policies;
pub mod receive;
pub mod retain;
pub mod revise;
pub mod revoke;
pub mod rules;
pub mod seal;
pub mod validity;
pub mod values;
pub mod witness;
