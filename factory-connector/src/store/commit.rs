//! The one transaction.

mod decisions;
mod ledger;
mod requests;
mod spool;

use asi_model::messages::{MappingState, ValueSource};

use super::{Changes, Store, StoreError, mappings, operator, policies::write_policies, rows::Batch};

impl Store {
    /// Writes everything or nothing.
    ///
    /// # Errors
    /// [`StoreError::Database`]; then nothing was written.
    pub async fn commit(&mut self, changes: Changes) -> Result<(), StoreError> {
        // A transaction that nobody waited for to its end is still open on its connection.
        if self.is_writing {
            self.replace_writer().await;
        }
        self.is_writing = true;
        let outcome = self.write(&changes).await;
        match outcome {
            Ok(()) => self.is_writing = false,
            Err(_) => self.replace_writer().await,
        }
        outcome
    }

    async fn write(&mut self, changes: &Changes) -> Result<(), StoreError> {
        let mut batch = Batch::transaction();
        requests::write(&mut batch, changes);
        decisions::write(&mut batch, changes);
        mappings::write(&mut batch, &changes.mappings);
        write_policies(&mut batch, changes);
        spool::write_reports(&mut batch, changes);
        spool::write_controls(&mut batch, changes);
        ledger::write(&mut batch, changes);
        write_sources(&mut batch, changes);
        operator::write(&mut batch, changes);
        write_identity(&mut batch, changes);
        batch.commit(&mut self.writer).await
    }
}

fn write_sources(batch: &mut Batch, changes: &Changes) {
    batch.insert(
        "INSERT INTO source (source_id, config, password)",
        " ON CONFLICT (source_id) DO UPDATE SET config = excluded.config, password = excluded.password",
        &changes.sources,
        |values, row| {
            values.push_bind(row.source_id.clone());
            values.push_bind(row.config.clone());
            values.push_bind(row.password.clone());
        },
    );
    for source_id in &changes.removed_sources {
        batch.run("DELETE FROM source WHERE source_id = ?").bind(source_id.clone());
    }
}

fn write_identity(batch: &mut Batch, changes: &Changes) {
    if changes.are_epochs_begun {
        batch.run("UPDATE identity SET must_begin_epochs = 0");
    }
    if let Some(is_held) = changes.is_lease_held {
        batch.run("UPDATE identity SET leased_place = iif(?, place, NULL)").bind(i64::from(is_held));
    }
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
