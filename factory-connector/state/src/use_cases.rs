//! Use cases: functions of state, input and time that return what they changed.
//!
//! A use case that fails changes nothing. Candidates ([`values`]) are the exception to returning a
//! [`ChangeSet`](crate::ChangeSet): there are many per second, so the registries note which fields
//! have values to report, and the transaction collects them once.

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
