//! Queries of the reading connections.

use std::borrow::Cow;

use futures::TryStreamExt as _;
use sqlx::{
    AssertSqlSafe, Sqlite, SqliteConnection,
    sqlite::{SqliteArguments, SqliteRow},
};

use super::error::StoreError;

type Query<'q> = sqlx::query::Query<'q, Sqlite, SqliteArguments>;

/// Makes a query of a text that consists of constants only; values are bound.
pub(super) fn query(sql: impl Into<Cow<'static, str>>) -> Query<'static> {
    sqlx::query(AssertSqlSafe(sql.into()))
}

/// Reads all rows of a query in its order; the first that cannot be read ends it.
pub(super) async fn all<T>(
    connection: &mut SqliteConnection,
    query: Query<'_>,
    action: &'static str,
    read: impl Fn(&SqliteRow) -> Result<T, StoreError>,
) -> Result<Vec<T>, StoreError> {
    // One after the other: all rows of a large table together would take more memory than the
    // values that are made of them.
    let mut rows = query.fetch(connection);
    let mut found = Vec::new();
    while let Some(row) = rows.try_next().await.map_err(StoreError::while_doing(action))? {
        found.push(read(&row)?);
    }
    Ok(found)
}

/// Reads the one row that there always is.
pub(super) async fn one<T>(
    connection: &mut SqliteConnection,
    query: Query<'_>,
    action: &'static str,
    read: impl FnOnce(&SqliteRow) -> Result<T, StoreError>,
) -> Result<T, StoreError> {
    let row = query.fetch_one(connection).await.map_err(StoreError::while_doing(action))?;
    read(&row)
}

/// Reads the row if there is one.
pub(super) async fn optional<T>(
    connection: &mut SqliteConnection,
    query: Query<'_>,
    action: &'static str,
    read: impl FnOnce(&SqliteRow) -> Result<T, StoreError>,
) -> Result<Option<T>, StoreError> {
    let row = query.fetch_optional(connection).await.map_err(StoreError::while_doing(action))?;
    row.as_ref().map(read).transpose()
}
