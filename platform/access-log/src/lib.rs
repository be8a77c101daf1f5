//! Access log: a tamper-evident record of who read a factory's values at the platform.
//!
//! One transparency log per factory: the leaves of its Merkle tree are the entries, so that one
//! checkpoint kept elsewhere proves all of them. Formats are those of the factories' own ledgers. This
//! crate is pure; the platform's store writes the entries before the values are handed out.

pub mod audit;
mod entry;
mod key;
mod log;
mod retention;

pub use audit::{AccessAudit, AccessAuditError, AccessAuditor};
pub use entry::{Access, AccessEntry, AccessKind, Agent, AgentKind};
pub use key::{AccessLogKey, UnusableKey};
pub use log::{AccessLog, AccessLogStart, RemovedEntries, access_log_verifier};
pub use retention::{AccessRetention, AccessRetentionEntry, AccessRetentionRule};
