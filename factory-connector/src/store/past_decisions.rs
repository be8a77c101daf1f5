//! Decisions whether recipients see what had left before they were added.

use asi_model::{DateTime, OrganisationId, RequestKey};
use rusqlite::Connection;
use serde::Serialize;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    PastDecisionRow,
    error::StoreError,
    query::{all, query},
    row::{Columns as _, signed},
    statement::write_rows,
};

/// A decision about the past: who decided what, when and why.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct StoredPastDecision {
    /// Number of the decision, as text.
    pub id: String,
    pub request: RequestKey,
    /// The recipient that was added.
    pub recipient_id: OrganisationId,
    /// True where reports of the past are shown to it.
    pub is_released: bool,
    /// Number of reports that are shown.
    pub report_count: u64,
    /// Root over their values, hexadecimal, as the ledger commits to them; none where none is shown.
    pub root: Option<String>,
    pub reason: Option<String>,
    pub decided_by: String,
    pub decided_at: DateTime,
}

/// Repository of decisions about the past.
pub struct PastDecisions<'c>(pub(super) &'c mut SqliteConnection);

const READ: &str = "read the decisions about the past";

impl PastDecisions<'_> {
    /// Reads for each request and recipient the number of the newest report that was decided about.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest(&mut self) -> Result<Vec<(RequestKey, OrganisationId, i64)>, StoreError> {
        let sql = "SELECT operation_network_id, operation_id, dynamic_data_request_id, recipient,
                       max(through_report) AS through_report
                   FROM past_decision
                   GROUP BY operation_network_id, operation_id, dynamic_data_request_id, recipient";
        all(self.0, query(sql), READ, |row| {
            Ok((row.request_key()?, row.parsed("recipient")?, row.column("through_report")?))
        })
        .await
    }

    /// Reads decisions with smaller numbers than `before`, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(
        &mut self,
        before: i64,
        limit: u32,
    ) -> Result<Vec<StoredPastDecision>, StoreError> {
        let sql = "SELECT * FROM past_decision WHERE id < ? ORDER BY id DESC LIMIT ?";
        all(self.0, query(sql).bind(before).bind(i64::from(limit)), READ, decision).await
    }
}

fn decision(row: &SqliteRow) -> Result<StoredPastDecision, StoreError> {
    Ok(StoredPastDecision {
        id: row.column::<i64>("id")?.to_string(),
        request: row.request_key()?,
        recipient_id: row.parsed("recipient")?,
        is_released: row.flag("is_released")?,
        report_count: row.number("report_count")?,
        root: row.column("root")?,
        reason: row.column("reason")?,
        decided_by: row.column("decided_by")?,
        decided_at: row.time("decided_at")?,
    })
}

/// Stores new decisions. None is ever changed.
pub(super) fn write(
    connection: &Connection,
    decisions: &[PastDecisionRow],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO past_decision (operation_network_id, operation_id, dynamic_data_request_id,
             recipient, is_released, through_report, report_count, root, reason, decided_by,
             decided_at)
         VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        decisions,
        |row| {
            (
                row.request.operation_network_id.as_str(),
                row.request.operation_id.as_str(),
                row.request.dynamic_data_request_id.as_str(),
                row.recipient.as_str(),
                row.is_released,
                row.through_report,
                signed(row.report_count),
                &row.root,
                &row.reason,
                &row.decided_by,
                row.decided_at.unix_micros(),
            )
        },
    )
}
