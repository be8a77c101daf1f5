//! Fields that each writer carried in each epoch. Ledger entries about reports name the writer
//! only, whose id is given to another request one day.

use rusqlite::Connection;

use super::{CarriedFieldRow, statement::write_rows};

/// Stores fields that a writer carries for the first time in its epoch.
pub(super) fn write(connection: &Connection, fields: &[CarriedFieldRow]) -> rusqlite::Result<()> {
    write_rows(
        connection,
        // The state notes a field again after a restart: the first sequence number stays.
        "INSERT INTO carried_field (operation_network_id, operation_id, dynamic_data_request_id,
             field_name, writer_id, epoch, first_sequence)
         VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
        fields,
        |row| {
            let request = &row.field.request;
            (
                request.operation_network_id.as_str(),
                request.operation_id.as_str(),
                request.dynamic_data_request_id.as_str(),
                row.field.field_name.as_str(),
                row.data_set_writer_id,
                row.epoch,
                row.first_sequence,
            )
        },
    )
}
