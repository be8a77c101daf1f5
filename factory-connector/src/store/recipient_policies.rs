//! Policies of recipients, each for everything that one recipient gets: every version is stored.

use asi_model::OrganisationId;
use connector_state::RecipientPolicy;
use disclosure::DocumentId;
use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    RecipientPolicyRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Repository of recipients' policies.
pub struct RecipientPolicies<'c>(pub(super) &'c mut SqliteConnection);

impl RecipientPolicies<'_> {
    /// Reads the newest policy of each recipient.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest(&mut self) -> Result<Vec<(OrganisationId, RecipientPolicy)>, StoreError> {
        // SQLite takes the columns beside `max(version)` from the row that has the maximum.
        let sql = "SELECT recipient, max(version) AS version, policy_id, changed_by, changed_at
                   FROM recipient_policy GROUP BY recipient";
        all(self.0, query(sql), "read the policies of recipients", recipient_policy).await
    }
}

fn recipient_policy(row: &SqliteRow) -> Result<(OrganisationId, RecipientPolicy), StoreError> {
    let set = RecipientPolicy {
        version: row.number("version")?,
        policy_id: row.parsed_option("policy_id")?,
        changed_by: row.column("changed_by")?,
        changed_at: row.time("changed_at")?,
    };
    Ok((row.parsed("recipient")?, set))
}

/// Stores new versions of recipients' policies.
pub(super) fn write(
    connection: &Connection,
    policies: &[RecipientPolicyRow],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO recipient_policy (recipient, version, policy_id, changed_by, changed_at)
         VALUES (?, ?, ?, ?, ?)",
        policies,
        |row| {
            (
                row.recipient.as_str(),
                row.set.version,
                row.set.policy_id.as_ref().map(DocumentId::as_str),
                &row.set.changed_by,
                row.set.changed_at.unix_micros(),
            )
        },
    )
}
