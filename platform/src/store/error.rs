//! What can go wrong with the store.

use std::path::PathBuf;

/// The store failed.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The database file cannot be opened.
    #[error("cannot open the database {}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        source: sqlx::Error,
    },
    /// The database cannot be brought to this version's form.
    #[error("cannot migrate the database")]
    Migrate(#[source] sqlx::migrate::MigrateError),
    /// A statement failed.
    #[error("cannot {action}")]
    Statement {
        /// What was tried.
        action: &'static str,
        /// Why.
        source: sqlx::Error,
    },
    /// A stored value is not what this version stores.
    #[error("the column {column} holds what it never should: {reason}")]
    Corrupt {
        /// The column.
        column: &'static str,
        /// What is wrong.
        reason: String,
    },
}

impl StoreError {
    /// For `map_err`: the statement that did `action` failed.
    pub(super) fn during(action: &'static str) -> impl Fn(sqlx::Error) -> Self {
        move |source| Self::Statement { action, source }
    }
}
