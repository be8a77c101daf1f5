//! What can go wrong with the durable file.

use std::path::PathBuf;

/// The durable file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder or file cannot be made or read.
    #[error("cannot use {}", path.display())]
    Access {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Another connector runs on the same folder.
    #[error("another connector is running on {}; stop it first", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// The file belongs to another factory.
    #[error(
        "the store belongs to the factory {found}, but {wanted} is configured; choose another state_directory"
    )]
    ForeignFactory {
        /// Whose it is.
        found: String,
        /// Whose it should be.
        wanted: String,
    },
    /// The database refused a statement.
    #[error("cannot {action}")]
    Database {
        /// What was being done.
        action: &'static str,
        /// Why not.
        source: sqlx::Error,
    },
    /// The database refused to write.
    #[error("cannot {action}")]
    Write {
        /// What was being done.
        action: &'static str,
        /// Why not.
        source: rusqlite::Error,
    },
    /// The store was closed meanwhile.
    #[error("the store is closed")]
    Closed,
    /// A migration failed, or the file was written by a newer version.
    #[error("cannot bring the store's tables up to date")]
    Migrate(#[from] sqlx::migrate::MigrateError),
    /// A stored document cannot be read.
    #[error("cannot read the stored {what}: {reason}")]
    Unreadable {
        /// Which kind of document.
        what: &'static str,
        /// Why.
        reason: String,
    },
}

impl StoreError {
    /// For `map_err` after a statement.
    pub(super) const fn while_doing(action: &'static str) -> impl FnOnce(sqlx::Error) -> Self {
        move |source| Self::Database { action, source }
    }

    /// For `map_err` after a statement of the writing connection.
    pub(super) const fn while_writing(
        action: &'static str,
    ) -> impl FnOnce(rusqlite::Error) -> Self {
        move |source| Self::Write { action, source }
    }

    /// For `map_err` after reading a stored document.
    pub(super) fn unreadable<E: std::fmt::Display>(what: &'static str) -> impl FnOnce(E) -> Self {
        move |error| Self::Unreadable { what, reason: error.to_string() }
    }
}
