//! Reading dead letters.

use sqlx::{Row, SqlitePool};
use time::OffsetDateTime;

use crate::{dead_letter::BrokerDeadLetter, message};

/// Reads at most `limit` dead letters with ids above `after`, oldest first.
pub(crate) async fn dead_letters(
    pool: &SqlitePool,
    after: i64,
    limit: u32,
) -> Result<Vec<BrokerDeadLetter>, sqlx::Error> {
    let rows = sqlx::query(
        "SELECT message_id, origin, wire_id, subject, principal, code, reason, at_ms, bytes \
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

/// Returns the ids of the dead letters that are not among the newest ones of their queue.
pub(crate) async fn dead_letters_beyond(
    pool: &SqlitePool,
    per_queue_max: u32,
) -> Result<Vec<i64>, sqlx::Error> {
    sqlx::query_scalar(
        "SELECT message_id FROM (SELECT message_id, \
             ROW_NUMBER() OVER (PARTITION BY origin ORDER BY message_id DESC) AS position \
             FROM dead_letters) WHERE position > ?",
    )
    .bind(per_queue_max)
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
