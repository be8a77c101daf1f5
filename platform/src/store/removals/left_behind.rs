//! Rows of those who have left: what goes with them, at once or in portions, and what stays.

use serde::Serialize;
use utoipa::ToSchema;

use crate::store::{database::Connection, error::StoreError};

/// Kind of records that stay of those who have left: others have a right to them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum RemainingRecords {
    /// Reports, for those to whom they were released, and to whom that was.
    Reports,
    /// Networks and requests as they were, with who drew and asked, and with the parts of factories.
    Networks,
    /// Comments, for those who exchanged them.
    Comments,
    /// Receipts of revocations, for those who received the values.
    Revocations,
    /// Checkpoints of ledgers, which are evidence for the recipients.
    LedgerLogs,
    /// Entries of who read values, for the factory whose they are, as long as `retention.access_days` says.
    Accesses,
    /// Entries of who changed what, as long as `retention.audit_days` says.
    Audit,
}

/// Statement that removes all rows of factories that have left.
macro_rules! of_factories {
    ($table:literal) => {
        concat!(
            "DELETE FROM ",
            $table,
            " WHERE factory_id IN (SELECT factory_id FROM factory WHERE removed_at IS NOT NULL)"
        )
    };
}

/// Statement that removes all rows of organisations that have left.
macro_rules! of_organisations {
    ($table:literal) => {
        concat!(
            "DELETE FROM ",
            $table,
            " WHERE organisation_id IN (SELECT organisation_id FROM organisation WHERE removed_at IS NOT NULL)"
        )
    };
}

/// Addresses of factories and tools that have left.
macro_rules! addresses {
    () => {
        "SELECT 'factory.' || factory_id || '.ingress' FROM factory WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'factory.' || factory_id || '.requests' FROM factory WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'factory.' || factory_id || '.leases' FROM factory WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'tool.' || tool_id || '.requests' FROM tool WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'tool.' || tool_id || '.reports' FROM tool WHERE removed_at IS NOT NULL"
    };
}

/// Statement that removes all rows of the addresses of factories and tools that have left.
macro_rules! of_addresses {
    ($table:literal) => {
        concat!("DELETE FROM ", $table, " WHERE address IN (", addresses!(), ")")
    };
}

/// Statements whose rows are few, by quotas: they go in the transaction of the removal.
const AT_ONCE: [&str; 14] = [
    of_factories!("enrolment_token"),
    of_factories!("signing_key"),
    of_factories!("writer_meta_data"),
    of_factories!("asset_offer"),
    of_factories!("lease"),
    of_factories!("past_release"),
    of_organisations!("network_viewer"),
    of_organisations!("seen_revision"),
    of_organisations!("revocation_reader"),
    of_addresses!("outbox"),
    of_addresses!("dead_letter"),
    "DELETE FROM request_tool WHERE tool_id IN (SELECT tool_id FROM tool WHERE removed_at IS NOT NULL)",
    "DELETE FROM revoked_access WHERE user_name IN (
         SELECT 'factory.' || factory_id FROM factory WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'tool.' || tool_id FROM tool WHERE removed_at IS NOT NULL)",
    "DELETE FROM broker_credential WHERE (holder_kind, holder_id) IN (
         SELECT 'FACTORY', factory_id FROM factory WHERE removed_at IS NOT NULL
         UNION ALL SELECT 'TOOL', tool_id FROM tool WHERE removed_at IS NOT NULL)",
];

/// Statement that removes the counts of those of whom nothing is kept any more.
const COUNTS: &str =
    concat!("DELETE FROM kept_of_sender WHERE number = 0 AND address IN (", addresses!(), ")");

/// Statements that remove some of many rows, at most `$1`: nobody waits long for the writer. From those who have left
/// to their rows, by `CROSS JOIN`: the tables are large, and mostly of others.
const IN_PORTIONS: [&str; 5] = [
    "DELETE FROM sequence_gap WHERE sequence_gap_id IN (
         SELECT r.sequence_gap_id FROM factory f CROSS JOIN sequence_gap r
         WHERE r.factory_id = f.factory_id AND f.removed_at IS NOT NULL LIMIT $1)",
    "DELETE FROM writer_recipient_set WHERE (factory_id, data_set_writer_id, epoch, recipient_set_id) IN (
         SELECT r.factory_id, r.data_set_writer_id, r.epoch, r.recipient_set_id
         FROM factory f CROSS JOIN writer_recipient_set r
         WHERE r.factory_id = f.factory_id AND f.removed_at IS NOT NULL LIMIT $1)",
    "DELETE FROM data_set_writer WHERE (factory_id, data_set_writer_id, epoch) IN (
         SELECT r.factory_id, r.data_set_writer_id, r.epoch
         FROM factory f CROSS JOIN data_set_writer r
         WHERE r.factory_id = f.factory_id AND f.removed_at IS NOT NULL LIMIT $1)",
    "DELETE FROM inbox_message WHERE inbox_message_id IN (
         SELECT r.inbox_message_id FROM factory f CROSS JOIN inbox_message r
         WHERE r.address = 'factory.' || f.factory_id || '.ingress' AND f.removed_at IS NOT NULL LIMIT $1)",
    "DELETE FROM inbox_message WHERE inbox_message_id IN (
         SELECT r.inbox_message_id FROM tool t CROSS JOIN inbox_message r
         WHERE r.address = 'tool.' || t.tool_id || '.requests' AND t.removed_at IS NOT NULL LIMIT $1)",
];

/// Removes rows of which there may be many, at most `rows` of each kind. Returns the largest number of them.
pub(super) async fn clear(connection: &mut Connection, rows: u32) -> Result<u64, StoreError> {
    let mut most = 0;
    for sql in IN_PORTIONS {
        let removed = sqlx::query(sql)
            .bind(i64::from(rows))
            .execute(&mut *connection)
            .await
            .map_err(StoreError::during("remove what was left behind"))?;
        most = most.max(removed.rows_affected());
    }
    sqlx::query(COUNTS)
        .execute(connection)
        .await
        .map_err(StoreError::during("remove counts of what was kept"))?;
    Ok(most)
}

/// Removes the rows of which there are few.
pub(super) async fn clear_at_once(connection: &mut Connection) -> Result<(), StoreError> {
    for sql in AT_ONCE {
        sqlx::query(sql)
            .execute(&mut *connection)
            .await
            .map_err(StoreError::during("remove what goes with who leaves"))?;
    }
    Ok(())
}
