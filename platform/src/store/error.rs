//! Errors of the store.

use std::path::PathBuf;

/// Failure of the platform's database or of what it holds.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The database file cannot be opened.
    #[error("cannot open the database {}", path.display())]
    Open { path: PathBuf, source: sqlx::Error },
    /// The database cannot be brought to this version's form.
    #[error("cannot migrate the database")]
    Migrate(#[source] sqlx::migrate::MigrateError),
    /// A statement was refused or broke off; its unit of work has no effect.
    #[error("cannot {action}")]
    Statement {
        /// Imperative phrase for the message, for example "store a part".
        action: &'static str,
        source: sqlx::Error,
    },
    /// A stored value is not what this version stores.
    #[error("the column {column} holds what it never should: {reason}")]
    Corrupt {
        column: &'static str,
        /// Reason for the message.
        reason: String,
    },
}

impl StoreError {
    /// Returns a function for `map_err` that names the failed `action`.
    pub(super) fn during(action: &'static str) -> impl Fn(sqlx::Error) -> Self {
        move |source| Self::Statement { action, source }
    }
}
