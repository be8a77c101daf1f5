//! Decisions that standing rules made about fields.

use asi_model::{DateTime, FieldKey};
use disclosure::{DocumentVersion, RuleAction};
use rusqlite::Connection;
use serde::Serialize;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    RuleDecisionRow,
    error::StoreError,
    names::Named,
    query::{all, one, optional, query},
    row::{Columns as _, document},
    statement::write_rows,
};

impl Named for RuleAction {
    const ALL: &'static [Self] = &[Self::Accept, Self::Prefill, Self::Refuse];

    fn name(self) -> &'static str {
        match self {
            Self::Accept => "ACCEPT",
            Self::Prefill => "PREFILL",
            Self::Refuse => "REFUSE",
        }
    }
}

/// A decision of standing rules, with its undoing if there was one.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleDecision {
    /// Number of the decision, as text.
    pub id: String,
    pub field: FieldKey,
    /// `ACCEPT` or `REFUSE`.
    pub action: String,
    /// The rules, in the versions that decided.
    pub rules: Vec<DocumentVersion>,
    /// Number of the consent that the decision made.
    pub consent_version: u32,
    pub decided_at: DateTime,
    /// The person who undid it; none while it is in force.
    pub undone_by: Option<String>,
    pub undone_at: Option<DateTime>,
}

/// Repository of rules' decisions.
pub struct RuleDecisions<'c>(pub(super) &'c mut SqliteConnection);

const READ: &str = "read the decisions of rules";

impl RuleDecisions<'_> {
    /// Reads decisions with smaller numbers than `before`, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn page(&mut self, before: i64, limit: u32) -> Result<Vec<RuleDecision>, StoreError> {
        let sql = "SELECT * FROM rule_decision WHERE id < ? ORDER BY id DESC LIMIT ?";
        let query = query(sql).bind(before).bind(i64::from(limit));
        all(self.0, query, READ, decision).await
    }

    /// Looks one up by its number.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn lookup(&mut self, id: i64) -> Result<Option<RuleDecision>, StoreError> {
        let query = query("SELECT * FROM rule_decision WHERE id = ?").bind(id);
        optional(self.0, query, READ, decision).await
    }

    /// Returns the greatest number of a decision; 0 before the first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn last_id(&mut self) -> Result<i64, StoreError> {
        let query = query("SELECT coalesce(max(id), 0) AS id FROM rule_decision");
        one(self.0, query, READ, |row| row.column("id")).await
    }
}

fn decision(row: &SqliteRow) -> Result<RuleDecision, StoreError> {
    Ok(RuleDecision {
        id: row.column::<i64>("id")?.to_string(),
        field: row.document("field")?,
        action: row.named::<RuleAction>("action")?.name().to_owned(),
        rules: row.document("rules")?,
        consent_version: row.number("consent_version")?,
        decided_at: row.time("decided_at")?,
        undone_by: row.column("undone_by")?,
        undone_at: row.time_option("undone_at")?,
    })
}

/// Stores new decisions, and marks others as undone: number, person and time.
pub(super) fn write(
    connection: &Connection,
    decisions: &[RuleDecisionRow],
    undone: &[(i64, String, DateTime)],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO rule_decision (id, field, action, rules, consent_version, decided_at)
         VALUES (?, ?, ?, ?, ?, ?)",
        decisions,
        |row| {
            (
                row.id,
                document(&row.field),
                row.action.name(),
                document(&row.rules),
                row.consent_version,
                row.decided_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "UPDATE rule_decision SET undone_by = ?, undone_at = ? WHERE id = ? AND undone_at IS NULL",
        undone,
        |(id, by, at)| (by, at.unix_micros(), id),
    )
}
