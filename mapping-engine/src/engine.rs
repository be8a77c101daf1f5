//! The engine: inputs in, candidates out.
//!
//! One task routes changes to the mappings that use them and runs the chains up to a script or
//! their end; script calls go to worker processes through [`crate::script::worker_queue`].
//! Candidates for a slow consumer wait in a bounded list; while it is full no changes are taken, and
//! the shop floor coalesces them.

mod command;
mod config;
mod core;
mod dry_runner;
mod error;
mod handle;
mod history;
mod inventory;
mod plans;
mod recording;
mod routes;
mod service;
mod status;
mod survey;
mod timers;

pub use config::MappingEngineConfig;
pub use error::EngineError;
pub use handle::MappingEngineHandle;
pub use history::HistoryConfig;
pub use recording::VariableRecording;
pub use service::MappingEngine;
pub use status::{CircuitState, InputStatus, MappingStatus};
pub use survey::{HealthCounts, MappingHealth, MappingSurvey, SurveyedMapping};
