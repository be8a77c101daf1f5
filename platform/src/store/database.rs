//! Types of the database driver, named once.

/// The database behind the repositories.
pub type Database = sqlx::Sqlite;

/// A connection of [`Database`].
pub(super) type Connection = <Database as sqlx::Database>::Connection;
