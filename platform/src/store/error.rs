//! Errors of the store.

use std::path::PathBuf;

/// SQLite's code of a statement that was ended from outside (`SQLITE_INTERRUPT`).
const INTERRUPTED: &str = "9";

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
    /// A page's reads took longer than pages may keep a reader.
    #[error("cannot {action}: it takes too long")]
    TooExpensive { action: &'static str },
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
        move |source| {
            let code = source.as_database_error().and_then(|error| error.code());
            if code.is_some_and(|code| code == INTERRUPTED) {
                return Self::TooExpensive { action };
            }
            Self::Statement { action, source }
        }
    }
}
