//! Errors of the durable file.

use std::path::PathBuf;

/// SQLite's code of a statement that was ended from outside (`SQLITE_INTERRUPT`).
const INTERRUPTED: &str = "9";

/// The durable file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder or file cannot be made or read.
    #[error("cannot use {}", path.display())]
    Access { path: PathBuf, source: std::io::Error },
    /// Another connector runs on the same folder.
    #[error("another connector is running on {}; stop it first", path.display())]
    InUse { path: PathBuf },
    /// The file belongs to another factory.
    #[error(
        "the store belongs to the factory {found}, but {configured} is configured; choose another state_directory"
    )]
    ForeignFactory {
        /// Factory that the file was made for.
        found: String,
        /// Factory of the configuration.
        configured: String,
    },
    /// The database refused a statement.
    #[error("cannot {action}")]
    Database {
        /// Verb and object, for a sentence that begins with "cannot".
        action: &'static str,
        source: sqlx::Error,
    },
    /// A page's reads took longer than pages may keep a reader.
    #[error("cannot {action}: it takes too long")]
    TooExpensive {
        /// Verb and object, for a sentence that begins with "cannot".
        action: &'static str,
    },
    /// The database refused to write.
    #[error("cannot {action}")]
    Write {
        /// Verb and object, for a sentence that begins with "cannot".
        action: &'static str,
        source: rusqlite::Error,
    },
    /// The store was closed meanwhile.
    #[error("the store is closed")]
    Closed,
    /// A migration failed, or the file was written by a newer version.
    #[error("cannot bring the store's tables up to date")]
    Migrate(#[from] sqlx::migrate::MigrateError),
    /// A stored document or identifier cannot be read.
    #[error("cannot read the stored {what}: {reason}")]
    Unreadable {
        /// Kind of document, or the name of its column.
        what: &'static str,
        reason: String,
    },
}

impl StoreError {
    /// Makes an argument for `map_err` after a statement.
    pub(super) fn while_doing(action: &'static str) -> impl FnOnce(sqlx::Error) -> Self {
        move |source| {
            let code = source.as_database_error().and_then(|error| error.code());
            if code.is_some_and(|code| code == INTERRUPTED) {
                return Self::TooExpensive { action };
            }
            Self::Database { action, source }
        }
    }

    /// Makes an argument for `map_err` after a statement of the writing connection.
    pub(super) const fn while_writing(
        action: &'static str,
    ) -> impl FnOnce(rusqlite::Error) -> Self {
        move |source| Self::Write { action, source }
    }

    /// Makes an argument for `map_err` after reading a stored document.
    pub(super) fn unreadable<E: std::fmt::Display>(what: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::Unreadable { what, reason: error.to_string() }
    }
}

impl From<connector_state::UnreadableState> for StoreError {
    fn from(error: connector_state::UnreadableState) -> Self {
        Self::Unreadable { what: error.what, reason: error.reason }
    }
}
