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

/// Returns the dead letters that are not among the newest ones of their queue, by number or by bytes, each with that
/// queue. Where there are too many of all queues together, those with most have fewer newest ones.
pub(crate) async fn dead_letters_beyond(
    pool: &SqlitePool,
    limits: &BrokerLimits,
) -> Result<Vec<(i64, String)>, sqlx::Error> {
    let sql = "SELECT COUNT(*), SUM(bytes) FROM dead_letters GROUP BY origin";
    let held: Vec<(i64, i64)> = sqlx::query_as(sql).fetch_all(pool).await?;
    let (numbers, bytes): (Vec<_>, Vec<_>) = held
        .into_iter()
        .map(|(number, bytes)| {
            let bytes = bytes.unsigned_abs().min(limits.dead_letter_bytes_per_queue_max);
            (number.unsigned_abs().min(limits.dead_letters_per_queue_max.into()), bytes)
        })
        .unzip();
    let number_max = level(numbers, limits.dead_letters_max);
    let bytes_max = level(bytes, limits.dead_letter_bytes_max);
    let stored = |max: u64| i64::try_from(max).unwrap_or(i64::MAX);
    sqlx::query_as(
        "SELECT message_id, origin FROM (SELECT message_id, origin, \
             ROW_NUMBER() OVER newest AS position, SUM(bytes) OVER newest AS total \
             FROM dead_letters WINDOW newest AS (PARTITION BY origin ORDER BY message_id DESC)) \
         WHERE position > ? OR total > ?",
    )
    .bind(stored(number_max.min(limits.dead_letters_per_queue_max.into())))
    .bind(stored(bytes_max.min(limits.dead_letter_bytes_per_queue_max)))
    .fetch_all(pool)
    .await
}

/// Returns the most that each may keep, so that all together keep no more than `max`: who holds most gives up first.
fn level(mut held: Vec<u64>, max: u64) -> u64 {
    held.sort_unstable();
    let mut rest = max;
    let mut others = held.len() as u64;
    for one in held {
        let part = rest / others;
        if one > part {
            return part;
        }
        rest -= one;
        others -= 1;
    }
    u64::MAX
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_holds_most_gives_up_first() {
        assert_eq!(level(vec![9, 3], 10), 7, "three stay");
        assert_eq!(level(vec![3, 9], 12), u64::MAX, "there is room for all");
        assert_eq!(level(vec![6, 1, 6], 10), 4, "both that hold most");
        assert_eq!(level(vec![5, 5, 5], 10), 3);
        assert_eq!(level(Vec::new(), 0), u64::MAX);
    }
}
