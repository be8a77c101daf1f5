//! Reading: queues and entries at the start, bodies by id later.

use sqlx::{Row, SqlitePool};

use crate::{
    address::QueueName,
    config::QueueOptions,
    message::{self, AnyMessage},
    queue::QueueEntry,
};

/// A stored queue with its entries in their order.
#[derive(Debug)]
pub(crate) struct StoredQueue {
    pub id: i64,
    pub name: QueueName,
    pub options: QueueOptions,
    pub entries: Vec<QueueEntry>,
}

/// Reads all queues with their entries.
pub(crate) async fn load(pool: &SqlitePool) -> Result<Vec<StoredQueue>, sqlx::Error> {
    let rows = sqlx::query(
        "SELECT id, name, messages_max, bytes_max, deliveries_max, is_single_active_consumer \
         FROM queues ORDER BY id",
    )
    .fetch_all(pool)
    .await?;
    let mut queues = Vec::with_capacity(rows.len());
    for row in rows {
        let name: String = row.try_get("name")?;
        let name = name.parse().map_err(|e| sqlx::Error::Decode(Box::new(e)))?;
        let options = QueueOptions {
            messages_max: row.try_get::<i64, _>("messages_max")?.unsigned_abs(),
            bytes_max: row.try_get::<i64, _>("bytes_max")?.unsigned_abs(),
            deliveries_max: row.try_get::<i64, _>("deliveries_max")?.try_into().unwrap_or(u32::MAX),
            is_single_active_consumer: row.try_get::<i64, _>("is_single_active_consumer")? != 0,
        };
        queues.push(StoredQueue { id: row.try_get("id")?, name, options, entries: Vec::new() });
    }
    let mut rows = sqlx::query(
        "SELECT id, queue_id, bytes, expires_at_ms, delivery_count FROM messages ORDER BY id",
    )
    .fetch(pool);
    let by_id: std::collections::HashMap<i64, usize> =
        queues.iter().enumerate().map(|(at, q)| (q.id, at)).collect();
    while let Some(row) = futures::TryStreamExt::try_next(&mut rows).await? {
        let Some(at) = by_id.get(&row.try_get::<i64, _>("queue_id")?) else { continue };
        queues[*at].entries.push(QueueEntry {
            id: row.try_get("id")?,
            bytes: row.try_get::<i64, _>("bytes")?.unsigned_abs(),
            expires_at_ms: row.try_get("expires_at_ms")?,
            delivery_count: row.try_get::<i64, _>("delivery_count")?.try_into().unwrap_or(u32::MAX),
            // Leases are not stored: it may have been delivered when the broker stopped.
            is_redelivered: true,
        });
    }
    drop(rows);
    Ok(queues)
}

/// Reads messages by id: id, stored size, message. Deleted ones are missing in the result; one that
/// cannot be decoded is none.
pub(crate) async fn bodies(
    pool: &SqlitePool,
    ids: &[i64],
) -> Result<Vec<(i64, u64, Option<AnyMessage>)>, sqlx::Error> {
    let rows = sqlx::query(
        "SELECT id, bytes, body FROM messages WHERE id IN (SELECT value FROM json_each(?))",
    )
    .bind(json_list(ids))
    .fetch_all(pool)
    .await?;
    rows.into_iter()
        .map(|row| {
            let body: Vec<u8> = row.try_get("body")?;
            Ok((
                row.try_get("id")?,
                row.try_get::<i64, _>("bytes")?.unsigned_abs(),
                message::decode(&body).ok(),
            ))
        })
        .collect()
}

/// Writes ids as a JSON array, the one parameter of any length that SQLite has.
pub(super) fn json_list(ids: &[i64]) -> String {
    let mut text = String::with_capacity(ids.len() * 8 + 2);
    text.push('[');
    for (at, id) in ids.iter().enumerate() {
        if at > 0 {
            text.push(',');
        }
        text.push_str(&id.to_string());
    }
    text.push(']');
    text
}
