//! The one transaction.

mod decisions;
mod ledger;
mod requests;
mod spool;

use asi_model::messages::{MappingState, ValueSource};
use sqlx::{Connection as _, SqliteConnection};

use super::{Changes, Store, StoreError, mappings, operator, policies::write_policies, rows::insert};

impl Store {
    /// Writes everything or nothing.
    ///
    /// # Errors
    /// [`StoreError::Database`]; then nothing was written.
    pub async fn commit(&mut self, changes: Changes) -> Result<(), StoreError> {
        let outcome = self.write(changes).await;
        if outcome.is_err() {
            self.replace_writer().await;
        }
        outcome
    }

    async fn write(&mut self, changes: Changes) -> Result<(), StoreError> {
        let begin = StoreError::while_doing("begin a transaction");
        let mut transaction = self.writer.begin_with("BEGIN IMMEDIATE").await.map_err(begin)?;
        requests::write(&mut transaction, &changes).await?;
        decisions::write(&mut transaction, &changes).await?;
        mappings::write(&mut transaction, &changes.mappings).await?;
        write_policies(&mut transaction, &changes).await?;
        spool::write_reports(&mut transaction, &changes).await?;
        spool::write_controls(&mut transaction, &changes).await?;
        ledger::write(&mut transaction, &changes).await?;
        write_sources(&mut transaction, &changes).await?;
        operator::write(&mut transaction, &changes).await?;
        write_identity(&mut transaction, &changes).await?;
        transaction.commit().await.map_err(StoreError::while_doing("commit a transaction"))
    }
}

async fn write_sources(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    insert(
        connection,
        "store a source",
        "INSERT INTO source (source_id, config, password)",
        " ON CONFLICT (source_id) DO UPDATE SET config = excluded.config, password = excluded.password",
        &changes.sources,
        |values, row| {
            values.push_bind(row.source_id.clone());
            values.push_bind(row.config.clone());
            values.push_bind(row.password.clone());
        },
    )
    .await?;
    for source_id in &changes.removed_sources {
        sqlx::query("DELETE FROM source WHERE source_id = ?")
            .bind(source_id.clone())
            .execute(&mut *connection)
            .await
            .map_err(StoreError::while_doing("remove a source"))?;
    }
    Ok(())
}

async fn write_identity(connection: &mut SqliteConnection, changes: &Changes) -> Result<(), StoreError> {
    let action = "store the connector's identity";
    if changes.are_epochs_begun {
        let statement = "UPDATE identity SET must_begin_epochs = 0";
        sqlx::query(statement).execute(&mut *connection).await.map_err(StoreError::while_doing(action))?;
    }
    if let Some(is_held) = changes.is_lease_held {
        let statement = "UPDATE identity SET leased_place = iif(?, place, NULL)";
        let query = sqlx::query(statement).bind(i64::from(is_held));
        query.execute(connection).await.map_err(StoreError::while_doing(action))?;
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
