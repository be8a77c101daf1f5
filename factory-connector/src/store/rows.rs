//! Many rows in few statements.
//!
//! Each statement costs a trip to the connection's thread, which would dominate a batch of small rows; so rows go in
//! blocks. Blocks have few sizes only, which keeps the cache of prepared statements small.

use sqlx::{QueryBuilder, Sqlite, SqliteConnection, query_builder::Separated};

use super::StoreError;

const BLOCK_SIZES: [usize; 8] = [200, 100, 40, 20, 10, 5, 2, 1];

/// Runs `head VALUES (row), (row), ... tail` for all rows.
pub(super) async fn insert<T, F>(
    connection: &mut SqliteConnection,
    action: &'static str,
    head: &'static str,
    tail: &'static str,
    rows: &[T],
    bind: F,
) -> Result<(), StoreError>
where
    F: Fn(&mut Separated<'_, Sqlite, &'static str>, &T),
{
    let mut rest = rows;
    while !rest.is_empty() {
        let size = BLOCK_SIZES.into_iter().find(|size| *size <= rest.len()).unwrap_or(1);
        let (block, further) = rest.split_at(size);
        rest = further;
        let mut statement = QueryBuilder::<Sqlite>::new(head);
        statement.push(" VALUES ");
        for (place, row) in block.iter().enumerate() {
            statement.push(if place == 0 { "(" } else { ", (" });
            let mut values = statement.separated(", ");
            bind(&mut values, row);
            statement.push(")");
        }
        statement.push(tail);
        statement.build().execute(&mut *connection).await.map_err(StoreError::while_doing(action))?;
    }
    Ok(())
}

/// Row numbers as one JSON parameter for `IN (SELECT value FROM json_each(?))`.
pub(super) fn id_list<I: Into<i64> + Copy>(ids: &[I]) -> String {
    let ids: Vec<i64> = ids.iter().map(|id| (*id).into()).collect();
    serde_json::to_string(&ids).expect("numbers serialise")
}
