//! Space on the disk: what deleted messages took is given back to the file system, in portions, so
//! that no publisher waits long for its commit.

use sqlx::{AssertSqlSafe, SqliteConnection};
use tracing::{info, warn};

/// Free pages that stay in the file for the next messages: 1 MiB of pages of 4 KiB.
const FREE_PAGES_KEPT: i64 = 256;
/// Pages that are given back at once: 4 MiB.
const PORTION: i64 = 1024;
/// Most pages in use of a file of a former version that is converted, all at once and in memory:
/// 64 MiB. A larger file is converted at the first start after its messages were consumed.
const CONVERTED_PAGES_MAX: i64 = 16 * 1024;
/// Value of `PRAGMA auto_vacuum` for a file that gives back pages on demand.
const INCREMENTAL: i64 = 2;

/// Makes a new file, or one of a former version, give back what it does not use.
///
/// Not an option of each connection: those that only read may not set it.
pub(super) async fn prepare(connection: &mut SqliteConnection) {
    match convert(connection).await {
        Ok(None) => {}
        Ok(Some(true)) => {
            info!("the broker's database now gives back the space of deleted messages")
        }
        Ok(Some(false)) => warn!(
            "the broker's database keeps the space of deleted messages until it is started with fewer waiting"
        ),
        // It works as before, and there is another start.
        Err(error) => warn!(%error, "the broker's database keeps the space of deleted messages"),
    }
}

/// Returns whether the file could be converted; none where it need not.
async fn convert(connection: &mut SqliteConnection) -> Result<Option<bool>, sqlx::Error> {
    if number(connection, "PRAGMA auto_vacuum").await? == INCREMENTAL {
        return Ok(None);
    }
    let pages = number(connection, "PRAGMA page_count").await?;
    let in_use = pages - number(connection, "PRAGMA freelist_count").await?;
    if in_use > CONVERTED_PAGES_MAX {
        return Ok(Some(false));
    }
    // The process of the broker may write nowhere but beside the database.
    let sql = "PRAGMA temp_store = MEMORY; PRAGMA auto_vacuum = INCREMENTAL; VACUUM; PRAGMA temp_store = DEFAULT;";
    sqlx::raw_sql(sql).execute(&mut *connection).await?;
    Ok(Some(number(connection, "PRAGMA auto_vacuum").await? == INCREMENTAL))
}

/// Gives back a portion of what is free, and at last the log. Returns whether there is more to do.
pub(super) async fn give_back(
    connection: &mut SqliteConnection,
    is_idle: bool,
) -> Result<bool, sqlx::Error> {
    let free = number(connection, "PRAGMA freelist_count").await? - FREE_PAGES_KEPT;
    if free > 0 && number(connection, "PRAGMA auto_vacuum").await? == INCREMENTAL {
        // A pragma takes no parameters, and this one is a number of ours.
        let sql = format!("PRAGMA incremental_vacuum({})", free.min(PORTION));
        sqlx::raw_sql(AssertSqlSafe(sql)).execute(&mut *connection).await?;
        return Ok(true);
    }
    if is_idle {
        // The file itself shrinks with the checkpoint, which waits for nobody who writes now.
        sqlx::raw_sql("PRAGMA wal_checkpoint(TRUNCATE)").execute(&mut *connection).await?;
    }
    Ok(!is_idle)
}

async fn number(connection: &mut SqliteConnection, sql: &'static str) -> Result<i64, sqlx::Error> {
    sqlx::query_scalar(sql).fetch_one(connection).await
}
