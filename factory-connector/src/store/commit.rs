//! The one transaction.

mod decisions;
mod ledger;
mod requests;
mod spool;

use asi_model::messages::{MappingState, ValueSource};
use rusqlite::{Connection, Transaction};

use super::{
    Changes, Store, StoreError, mappings, operator,
    policies::write_policies,
    writer::{run, write_rows},
};

impl Store {
    /// Writes everything or nothing.
    ///
    /// # Errors
    /// [`StoreError::Write`]; then nothing was written.
    pub async fn commit(&mut self, changes: Changes) -> Result<(), StoreError> {
        let action = "write a transaction";
        let work = move |connection: &Transaction<'_>| {
            write(connection, &changes).map_err(StoreError::while_writing(action))
        };
        self.writer.transact(action, work).await
    }
}

fn write(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    requests::write(connection, changes)?;
    decisions::write(connection, changes)?;
    mappings::write(connection, &changes.mappings)?;
    write_policies(connection, changes)?;
    spool::write_reports(connection, changes)?;
    spool::write_controls(connection, changes)?;
    ledger::write(connection, changes)?;
    write_sources(connection, changes)?;
    operator::write(connection, changes)?;
    write_identity(connection, changes)
}

fn write_sources(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO source (source_id, config, password) VALUES (?, ?, ?) \
         ON CONFLICT (source_id) DO UPDATE SET config = excluded.config, password = excluded.password",
        &changes.sources,
        |row| (&row.source_id, &row.config, &row.password),
    )?;
    write_rows(
        connection,
        "DELETE FROM source WHERE source_id = ?",
        &changes.removed_sources,
        |id| (id,),
    )
}

fn write_identity(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    if changes.are_epochs_begun {
        run(connection, "UPDATE identity SET must_begin_epochs = 0", ())?;
    }
    if let Some(is_held) = changes.is_lease_held {
        run(connection, "UPDATE identity SET leased_place = iif(?, place, NULL)", (is_held,))?;
    }
    Ok(())
}

pub(super) const fn mapping_state_name(state: MappingState) -> &'static str {
    match state {
        MappingState::Pending => "PENDING",
        MappingState::Mapped => "MAPPED",
        MappingState::Refused => "REFUSED",
    }
}

pub(super) const fn value_source_name(source: ValueSource) -> &'static str {
    match source {
        ValueSource::Mapping => "MAPPING",
        ValueSource::Manual => "MANUAL",
        ValueSource::External => "EXTERNAL",
    }
}
