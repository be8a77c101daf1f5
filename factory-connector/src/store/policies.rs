//! Named policies, standing rules and what they decided: every version is kept.

use asi_model::{DateTime, FieldKey, OrganisationId};
use rusqlite::Connection;
use serde::{Serialize, de::DeserializeOwned};
use sqlx::{Row as _, SqliteConnection, SqlitePool, sqlite::SqliteRow};

use super::{
    Changes, StoreError,
    load::{all, get, id, json, time, unsigned},
    writer::write_rows,
};
use crate::books::RecipientPolicy;
use disclosure::{DocumentId, DocumentVersion, NamedPolicy, Rule, RuleAction, Versioned};

/// A version of a policy or rule.
#[derive(Debug, Clone)]
pub struct DocumentRow {
    /// Which.
    pub key: DocumentVersion,
    /// What it says, as JSON.
    pub document: String,
    /// Who wrote it.
    pub changed_by: String,
    /// When.
    pub changed_at: DateTime,
}

impl DocumentRow {
    /// As stored.
    pub fn new(key: &DocumentVersion, document: &impl Serialize, by: &str, now: DateTime) -> Self {
        let document = serde_json::to_string(document)
            .expect("policies and rules have text keys and finite numbers");
        Self { key: key.clone(), document, changed_by: by.to_owned(), changed_at: now }
    }
}

/// A policy set for a recipient.
#[derive(Debug, Clone)]
pub struct RecipientPolicyRow {
    /// Whose.
    pub recipient: OrganisationId,
    /// What was set.
    pub set: RecipientPolicy,
}

/// What rules decided about a field.
#[derive(Debug, Clone)]
pub struct RuleDecisionRow {
    /// Its number.
    pub id: i64,
    /// The field.
    pub field: FieldKey,
    /// What was done.
    pub action: RuleAction,
    /// The rules, in the versions that decided.
    pub rules: Vec<DocumentVersion>,
    /// The consent that this made.
    pub consent_version: u32,
    /// When.
    pub decided_at: DateTime,
}

/// Which kind of document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentVersions {
    /// Named policies.
    Policies,
    /// Standing rules.
    Rules,
}

pub(super) fn write_policies(connection: &Connection, changes: &Changes) -> rusqlite::Result<()> {
    let tables = [
        (
            "INSERT INTO policy_version (policy_id, version, document, changed_by, changed_at) VALUES (?, ?, ?, ?, ?)",
            &changes.policies,
        ),
        (
            "INSERT INTO rule_version (rule_id, version, document, changed_by, changed_at) VALUES (?, ?, ?, ?, ?)",
            &changes.rules,
        ),
    ];
    for (statement, rows) in tables {
        write_rows(connection, statement, rows, |row| {
            (
                row.key.id.to_string(),
                row.key.version,
                &row.document,
                &row.changed_by,
                row.changed_at.unix_micros(),
            )
        })?;
    }
    write_rows(
        connection,
        "INSERT INTO recipient_policy (recipient, version, policy_id, changed_by, changed_at) VALUES (?, ?, ?, ?, ?)",
        &changes.recipient_policies,
        |row| {
            let set = &row.set;
            let policy = set.policy_id.as_ref().map(ToString::to_string);
            (
                row.recipient.as_str(),
                set.version,
                policy,
                &set.changed_by,
                set.changed_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "INSERT INTO rule_decision (id, field, action, rules, consent_version, decided_at) VALUES (?, ?, ?, ?, ?, ?)",
        &changes.rule_decisions,
        |row| {
            (
                row.id,
                serde_json::to_string(&row.field).expect("keys serialise"),
                action_name(row.action),
                serde_json::to_string(&row.rules).expect("ids and numbers serialise"),
                row.consent_version,
                row.decided_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "UPDATE rule_decision SET undone_by = ?, undone_at = ? WHERE id = ? AND undone_at IS NULL",
        &changes.undone_rule_decisions,
        |(id, by, at)| (by, at.unix_micros(), id),
    )
}

const fn action_name(action: RuleAction) -> &'static str {
    match action {
        RuleAction::Accept => "ACCEPT",
        RuleAction::Prefill => "PREFILL",
        RuleAction::Refuse => "REFUSE",
    }
}

pub(super) async fn newest_policies(
    connection: &mut SqliteConnection,
) -> Result<Vec<Versioned<NamedPolicy>>, StoreError> {
    let newest = "SELECT policy_id, max(version), document, changed_by, changed_at FROM policy_version GROUP BY policy_id";
    all(connection, newest, versioned).await
}

pub(super) async fn newest_rules(
    connection: &mut SqliteConnection,
) -> Result<Vec<Versioned<Rule>>, StoreError> {
    let newest = "SELECT rule_id, max(version), document, changed_by, changed_at FROM rule_version GROUP BY rule_id";
    all(connection, newest, versioned).await
}

pub(super) async fn newest_recipient_policies(
    connection: &mut SqliteConnection,
) -> Result<Vec<(OrganisationId, RecipientPolicy)>, StoreError> {
    let newest = "SELECT recipient, max(version), policy_id, changed_by, changed_at FROM recipient_policy GROUP BY recipient";
    all(connection, newest, |row| {
        let policy_id: Option<String> = get(row, 2)?;
        let set = RecipientPolicy {
            version: unsigned(get(row, 1)?),
            policy_id: policy_id
                .map(|text| {
                    text.parse::<DocumentId>().map_err(StoreError::unreadable("identifier"))
                })
                .transpose()?,
            changed_by: get(row, 3)?,
            changed_at: DateTime::from_unix_micros(get(row, 4)?),
        };
        Ok((id::<OrganisationId>(row, 0)?, set))
    })
    .await
}

pub(super) async fn last_rule_decision(
    connection: &mut SqliteConnection,
) -> Result<i64, StoreError> {
    let rows =
        all(connection, "SELECT coalesce(max(id), 0) FROM rule_decision", |row| get::<i64>(row, 0))
            .await?;
    Ok(rows.into_iter().next().unwrap_or(0))
}

fn versioned<T: DeserializeOwned>(row: &SqliteRow) -> Result<Versioned<T>, StoreError> {
    let document: String = get(row, 2)?;
    Ok(Versioned {
        key: DocumentVersion { id: id::<DocumentId>(row, 0)?, version: unsigned(get(row, 1)?) },
        document: json(&document, "policy or rule")?,
        changed_by: get(row, 3)?,
        changed_at: DateTime::from_unix_micros(get(row, 4)?),
    })
}

/// All versions of a policy or rule, newest first, at most the last thousand.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn document_versions<T: DeserializeOwned>(
    readers: &SqlitePool,
    kind: DocumentVersions,
    id: &DocumentId,
) -> Result<Vec<Versioned<T>>, StoreError> {
    let sql = match kind {
        DocumentVersions::Policies => {
            "SELECT policy_id, version, document, changed_by, changed_at FROM policy_version WHERE policy_id = ? \
             ORDER BY version DESC LIMIT 1000"
        }
        DocumentVersions::Rules => {
            "SELECT rule_id, version, document, changed_by, changed_at FROM rule_version WHERE rule_id = ? \
             ORDER BY version DESC LIMIT 1000"
        }
    };
    let rows = sqlx::query(sql)
        .bind(id.as_str())
        .fetch_all(readers)
        .await
        .map_err(StoreError::while_doing("read the versions of a policy or rule"))?;
    rows.iter().map(versioned).collect()
}

/// What rules decided by themselves.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RuleDecision {
    /// Its number, as text.
    pub id: String,
    /// The field.
    #[schema(value_type = Object)]
    pub field: FieldKey,
    /// `ACCEPT` or `REFUSE`.
    pub action: String,
    /// The rules, in the versions that decided.
    pub rules: Vec<DocumentVersion>,
    /// The consent that this made.
    pub consent_version: u32,
    /// When.
    #[schema(value_type = String, format = "date-time")]
    pub decided_at: DateTime,
    /// Who undid it.
    pub undone_by: Option<String>,
    /// When.
    #[schema(value_type = Option<String>, format = "date-time")]
    pub undone_at: Option<DateTime>,
}

/// What rules decided, newest first, before a number.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn rule_decisions(
    readers: &SqlitePool,
    before: i64,
    limit: u32,
) -> Result<Vec<RuleDecision>, StoreError> {
    let rows = sqlx::query(
        "SELECT id, field, action, rules, consent_version, decided_at, undone_by, undone_at FROM rule_decision \
         WHERE id < ? ORDER BY id DESC LIMIT ?",
    )
    .bind(before)
    .bind(i64::from(limit))
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the decisions of rules"))?;
    rows.iter().map(decision).collect()
}

/// One decision of rules.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn rule_decision(
    readers: &SqlitePool,
    id: i64,
) -> Result<Option<RuleDecision>, StoreError> {
    let row = sqlx::query(
        "SELECT id, field, action, rules, consent_version, decided_at, undone_by, undone_at FROM rule_decision \
         WHERE id = ?",
    )
    .bind(id)
    .fetch_optional(readers)
    .await
    .map_err(StoreError::while_doing("read the decisions of rules"))?;
    row.as_ref().map(decision).transpose()
}

fn decision(row: &SqliteRow) -> Result<RuleDecision, StoreError> {
    let (field, rules): (String, String) = (get(row, 1)?, get(row, 3)?);
    Ok(RuleDecision {
        id: get::<i64>(row, 0)?.to_string(),
        field: json(&field, "field's key")?,
        action: get(row, 2)?,
        rules: json(&rules, "rule's decision")?,
        consent_version: unsigned(
            row.try_get(4).map_err(StoreError::while_doing("read a column"))?,
        ),
        decided_at: DateTime::from_unix_micros(get(row, 5)?),
        undone_by: get(row, 6)?,
        undone_at: time(get(row, 7)?),
    })
}
