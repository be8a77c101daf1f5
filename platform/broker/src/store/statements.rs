//! Statements of the writer, one function per command.

use std::collections::HashSet;

use sqlx::{Connection as _, QueryBuilder, Sqlite, SqliteConnection};

use super::{
    command::{DeadLettering, NewMessage, StoreCommand},
    reader::json_list,
};
use crate::{clock, config::QueueOptions, queue::Queue};

/// Rows in one INSERT of new messages.
const ROWS_PER_INSERT: usize = 64;

/// Applies commands in one transaction. Returns the messages that went with their queue and are no dead letters, or no
/// longer.
pub(super) async fn apply(
    connection: &mut SqliteConnection,
    commands: &[StoreCommand],
    dead_letters: &Queue,
) -> Result<HashSet<i64>, sqlx::Error> {
    let mut transaction = connection.begin().await?;
    for command in commands {
        if let StoreCommand::DeclareQueue { id, name, options, .. } = command {
            declare(&mut transaction, *id, name, options).await?;
        }
    }
    let new: Vec<_> = commands
        .iter()
        .filter_map(|c| if let StoreCommand::Insert(new) = c { Some(new) } else { None })
        .collect();
    insert(&mut transaction, &new).await?;
    let mut gone = Vec::new();
    let mut with_their_queue = HashSet::new();
    for command in commands {
        match command {
            StoreCommand::Remove(id) => gone.push(*id),
            StoreCommand::CountDelivery { id, delivery_count } => {
                count_delivery(&mut transaction, *id, *delivery_count).await?;
            }
            StoreCommand::DeadLetter(letter) => {
                if !dead_letter(&mut transaction, letter, dead_letters.id).await? {
                    with_their_queue.insert(letter.entry.id);
                }
            }
            StoreCommand::DeleteQueue { id, name, .. } => {
                with_their_queue.extend(delete_queue(&mut transaction, *id, name).await?);
            }
            StoreCommand::ReplayDeadLetters { moves, .. } => {
                replay(&mut transaction, moves).await?
            }
            StoreCommand::PurgeDeadLetters { ids, .. } => gone.extend_from_slice(ids),
            StoreCommand::Insert(_) | StoreCommand::DeclareQueue { .. } => {}
        }
    }
    delete_messages(&mut transaction, &gone).await?;
    transaction.commit().await?;
    Ok(with_their_queue)
}

async fn delete_messages(
    connection: &mut SqliteConnection,
    ids: &[i64],
) -> Result<(), sqlx::Error> {
    if ids.is_empty() {
        return Ok(());
    }
    let list = json_list(ids);
    for sql in [
        "DELETE FROM messages WHERE id IN (SELECT value FROM json_each(?))",
        "DELETE FROM dead_letters WHERE message_id IN (SELECT value FROM json_each(?))",
    ] {
        sqlx::query(sql).bind(&list).execute(&mut *connection).await?;
    }
    Ok(())
}

/// Deletes a queue with its messages and dead letters; returns the letters.
async fn delete_queue(
    connection: &mut SqliteConnection,
    id: i64,
    name: &str,
) -> Result<Vec<i64>, sqlx::Error> {
    let sql = "SELECT message_id FROM dead_letters WHERE origin = ?";
    let letters: Vec<i64> = sqlx::query_scalar(sql).bind(name).fetch_all(&mut *connection).await?;
    delete_messages(&mut *connection, &letters).await?;
    for sql in ["DELETE FROM messages WHERE queue_id = ?", "DELETE FROM queues WHERE id = ?"] {
        sqlx::query(sql).bind(id).execute(&mut *connection).await?;
    }
    Ok(letters)
}

async fn count_delivery(
    connection: &mut SqliteConnection,
    id: i64,
    delivery_count: u32,
) -> Result<(), sqlx::Error> {
    sqlx::query("UPDATE messages SET delivery_count = ? WHERE id = ?")
        .bind(i64::from(delivery_count))
        .bind(id)
        .execute(connection)
        .await?;
    Ok(())
}

async fn insert(connection: &mut SqliteConnection, new: &[&NewMessage]) -> Result<(), sqlx::Error> {
    // Few distinct lengths, so that SQLite keeps the statements prepared.
    let mut remaining = new;
    while !remaining.is_empty() {
        let count =
            [ROWS_PER_INSERT, 8, 1].into_iter().find(|n| *n <= remaining.len()).unwrap_or(1);
        let (rows, others) = remaining.split_at(count);
        remaining = others;
        let mut query = QueryBuilder::<Sqlite>::new(
            "INSERT INTO messages (id, queue_id, bytes, expires_at_ms, delivery_count, body) ",
        );
        query.push_values(rows, |mut row, new| {
            row.push_bind(new.entry.id)
                .push_bind(new.queue.id)
                .push_bind(i64::try_from(new.entry.bytes).unwrap_or(i64::MAX))
                .push_bind(new.entry.expires_at_ms)
                .push_bind(0_i64)
                .push_bind(new.wire.as_slice());
        });
        query.build().execute(&mut *connection).await?;
    }
    Ok(())
}

async fn declare(
    connection: &mut SqliteConnection,
    id: i64,
    name: &str,
    options: &QueueOptions,
) -> Result<(), sqlx::Error> {
    sqlx::query(
        "INSERT INTO queues \
         (id, name, messages_max, bytes_max, deliveries_max, is_single_active_consumer) \
         VALUES (?, ?, ?, ?, ?, ?) \
         ON CONFLICT (id) DO UPDATE SET messages_max = excluded.messages_max, \
         bytes_max = excluded.bytes_max, deliveries_max = excluded.deliveries_max, \
         is_single_active_consumer = excluded.is_single_active_consumer",
    )
    .bind(id)
    .bind(name)
    .bind(i64::try_from(options.messages_max).unwrap_or(i64::MAX))
    .bind(i64::try_from(options.bytes_max).unwrap_or(i64::MAX))
    .bind(i64::from(options.deliveries_max))
    .bind(i64::from(options.is_single_active_consumer))
    .execute(connection)
    .await?;
    Ok(())
}

/// Moves a message to the dead letters. Returns false where its queue was deleted meanwhile, and the message with it.
async fn dead_letter(
    connection: &mut SqliteConnection,
    letter: &DeadLettering,
    dead_letters: i64,
) -> Result<bool, sqlx::Error> {
    let moved = sqlx::query(
        "UPDATE messages SET queue_id = ?, delivery_count = 0, expires_at_ms = NULL WHERE id = ?",
    )
    .bind(dead_letters)
    .bind(letter.entry.id)
    .execute(&mut *connection)
    .await?;
    if moved.rows_affected() == 0 {
        return Ok(false);
    }
    sqlx::query(
        "INSERT OR REPLACE INTO dead_letters \
         (message_id, origin, wire_id, subject, principal, code, reason, at_ms, bytes) \
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
    )
    .bind(letter.entry.id)
    .bind(letter.origin.name.as_str())
    .bind(letter.features.message_id.as_deref())
    .bind(letter.features.subject.as_deref())
    .bind(letter.features.principal.as_deref())
    .bind(&letter.code)
    .bind(&letter.reason)
    .bind(clock::now_ms())
    .bind(i64::try_from(letter.entry.bytes).unwrap_or(i64::MAX))
    .execute(connection)
    .await?;
    Ok(true)
}

async fn replay(
    connection: &mut SqliteConnection,
    moves: &[(i64, i64, i64)],
) -> Result<(), sqlx::Error> {
    for (old_id, new_id, queue_id) in moves {
        sqlx::query("UPDATE messages SET id = ?, queue_id = ?, delivery_count = 0 WHERE id = ?")
            .bind(new_id)
            .bind(queue_id)
            .bind(old_id)
            .execute(&mut *connection)
            .await?;
        sqlx::query("DELETE FROM dead_letters WHERE message_id = ?")
            .bind(old_id)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}
