//! Parts that both daemons share, so that an operator who knows one knows the other.
//!
//! - [`configuration`]: TOML files with environment overrides, and errors with origin and
//!   remedy.
//! - [`lifecycle`]: named tasks, one shutdown, and the consequence of a task's failure.
//! - [`descriptors`]: the limit of open files.
//! - [`exit`]: message and exit code after an error.
//! - [`telemetry`]: logs and metrics.
//! - [`confidential`]: values that must never reach a log.
//! - [`web`]: problem documents, sessions, security headers, embedded pages, live events, health.
//!
//! Independent of the purpose of either daemon.

pub mod confidential;
pub mod configuration;
pub mod descriptors;
pub mod exit;
pub mod lifecycle;
pub mod telemetry;
pub mod web;

pub use confidential::Confidential;
