//! What both daemons do alike, so that an operator who knows one knows the other.
//!
//! - [`configuration`]: TOML files with environment overrides, and errors that say where and how to
//!   mend.
//! - [`lifecycle`]: named tasks, one shutdown, and what the failure of a task means.
//! - [`ending`]: what is said about what went wrong, and the exit code.
//! - [`telemetry`]: logs and metrics.
//! - [`confidential`]: values that must never reach a log.
//! - [`web`]: problem documents, sessions, security headers, embedded pages, live events, health.
//!
//! Nothing here knows what either daemon is for; the rooms that do stay apart.

pub mod confidential;
pub mod configuration;
pub mod ending;
pub mod lifecycle;
pub mod telemetry;
pub mod web;

pub use confidential::Confidential;
