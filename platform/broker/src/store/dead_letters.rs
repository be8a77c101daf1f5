//! Reading dead letters.

use sqlx::{Row, SqlitePool};
use time::OffsetDateTime;

use crate::{config::BrokerLimits, dead_letter::BrokerDeadLetter, message};

/// Reads at most `limit` dead letters with ids above `after`, oldest first.
pub(crate) async fn dead_letters(
    pool: &SqlitePool,
    after: i64,
    limit: u32,
) -> Result<Vec<BrokerDeadLetter>, sqlx::Error> {
    let rows = sqlx::query(
        // Former versions stored texts of any length.
        "SELECT message_id, origin, substr(wire_id, 1, 256) AS wire_id, \
             substr(subject, 1, 256) AS subject, principal, substr(code, 1, 100) AS code, \
             substr(reason, 1, 1000) AS reason, at_ms, bytes \
         FROM dead_letters WHERE message_id > ? ORDER BY message_id LIMIT ?",
    )
    .bind(after)
    .bind(limit)
    .fetch_all(pool)
    .await?;
    rows.into_iter()
        .map(|row| {
            let origin: String = row.try_get("origin")?;
            let at_ms: i64 = row.try_get("at_ms")?;
            Ok(BrokerDeadLetter {
                id: row.try_get("message_id")?,
                queue: origin.parse().map_err(|e| sqlx::Error::Decode(Box::new(e)))?,
                message_id: row.try_get("wire_id")?,
                subject: row.try_get("subject")?,
                principal: row.try_get("principal")?,
                code: row.try_get("code")?,
                reason: row.try_get("reason")?,
                at: OffsetDateTime::from_unix_timestamp_nanos(i128::from(at_ms) * 1_000_000)
                    .map_err(|e| sqlx::Error::Decode(Box::new(e)))?,
                bytes: row.try_get::<i64, _>("bytes")?.unsigned_abs(),
            })
        })
        .collect()
}

/// Returns the ids of the dead letters that are not among the newest ones of their queue, by number or by
/// bytes.
pub(crate) async fn dead_letters_beyond(
    pool: &SqlitePool,
    limits: &BrokerLimits,
) -> Result<Vec<i64>, sqlx::Error> {
    sqlx::query_scalar(
        "SELECT message_id FROM (SELECT message_id, \
             ROW_NUMBER() OVER newest AS position, SUM(bytes) OVER newest AS total \
             FROM dead_letters WINDOW newest AS (PARTITION BY origin ORDER BY message_id DESC)) \
         WHERE position > ? OR total > ?",
    )
    .bind(limits.dead_letters_per_queue_max)
    .bind(i64::try_from(limits.dead_letter_bytes_per_queue_max).unwrap_or(i64::MAX))
    .fetch_all(pool)
    .await
}

/// Returns the ids of the dead letters of a queue.
pub(crate) async fn dead_letters_of(
    pool: &SqlitePool,
    queue: &str,
) -> Result<Vec<i64>, sqlx::Error> {
    sqlx::query_scalar("SELECT message_id FROM dead_letters WHERE origin = ?")
        .bind(queue)
        .fetch_all(pool)
        .await
}

/// Reads the body of a dead letter; empty when it is neither bytes nor text.
pub(crate) async fn dead_letter_body(
    pool: &SqlitePool,
    id: i64,
) -> Result<Option<Vec<u8>>, sqlx::Error> {
    let body: Option<Vec<u8>> = sqlx::query_scalar(
        "SELECT body FROM messages JOIN dead_letters ON dead_letters.message_id = messages.id \
         WHERE messages.id = ?",
    )
    .bind(id)
    .fetch_optional(pool)
    .await?;
    Ok(body.map(|bytes| message::decode(&bytes).map(message::body_bytes).unwrap_or_default()))
}
