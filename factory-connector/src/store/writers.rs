//! Data set writers: request, epoch and the next sequence number of each.

use std::collections::BTreeMap;

use asi_model::DateTime;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    WriterRow,
    error::StoreError,
    query::{all, query},
    row::{Columns as _, document},
    statement::write_rows,
};

/// Repository of data set writers.
pub struct Writers<'c>(pub(super) &'c mut SqliteConnection);

impl Writers<'_> {
    /// Reads all writers by their ids, retired ones included.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<(u16, WriterRow)>, StoreError> {
        all(self.0, query("SELECT * FROM writer"), "read the writers", writer).await
    }
}

fn writer(row: &SqliteRow) -> Result<(u16, WriterRow), StoreError> {
    let writer = WriterRow {
        request: row.request_key()?,
        epoch: row.number("epoch")?,
        minor_version: row.number("minor_version")?,
        next_sequence: row.number("next_sequence")?,
        fields: row.document("field_list")?,
        retired_at: row.time_option("retired_at")?,
    };
    Ok((row.number("id")?, writer))
}

/// Stores new and changed writers by their ids.
pub(super) fn write(
    connection: &Connection,
    writers: &BTreeMap<u16, WriterRow>,
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO writer (id, operation_network_id, operation_id, dynamic_data_request_id, epoch,
             minor_version, next_sequence, field_list, retired_at)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)
         ON CONFLICT (id) DO UPDATE SET
             operation_network_id = excluded.operation_network_id,
             operation_id = excluded.operation_id,
             dynamic_data_request_id = excluded.dynamic_data_request_id,
             epoch = excluded.epoch, minor_version = excluded.minor_version,
             next_sequence = excluded.next_sequence, field_list = excluded.field_list,
             retired_at = excluded.retired_at",
        writers,
        |(id, row)| {
            (
                id,
                row.request.operation_network_id.as_str(),
                row.request.operation_id.as_str(),
                row.request.dynamic_data_request_id.as_str(),
                row.epoch,
                row.minor_version,
                row.next_sequence,
                document(&row.fields),
                row.retired_at.map(DateTime::unix_micros),
            )
        },
    )
}
