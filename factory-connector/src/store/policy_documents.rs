//! Named policies, standing rules, alliances and caps: every version is stored.

use disclosure::{Alliance, Cap, DocumentId, DocumentVersion, NamedPolicy, Rule, Versioned};
use rusqlite::Connection;
use serde::de::DeserializeOwned;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    DocumentRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Kind of document, each in a table of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentKind {
    Policy,
    Rule,
    Alliance,
    Cap,
}

impl DocumentKind {
    const fn table(self) -> &'static str {
        match self {
            Self::Policy => "policy_version",
            Self::Rule => "rule_version",
            Self::Alliance => "alliance_version",
            Self::Cap => "cap_version",
        }
    }

    const fn id_column(self) -> &'static str {
        match self {
            Self::Policy => "policy_id",
            Self::Rule => "rule_id",
            Self::Alliance => "alliance_id",
            Self::Cap => "cap_id",
        }
    }
}

/// Repository of named policies, standing rules, alliances and caps.
pub struct PolicyDocuments<'c>(pub(super) &'c mut SqliteConnection);

impl PolicyDocuments<'_> {
    /// Reads the newest version of each named policy.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_policies(&mut self) -> Result<Vec<Versioned<NamedPolicy>>, StoreError> {
        self.newest(DocumentKind::Policy).await
    }

    /// Reads the newest version of each standing rule.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_rules(&mut self) -> Result<Vec<Versioned<Rule>>, StoreError> {
        self.newest(DocumentKind::Rule).await
    }

    /// Reads the newest version of each alliance.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_alliances(&mut self) -> Result<Vec<Versioned<Alliance>>, StoreError> {
        self.newest(DocumentKind::Alliance).await
    }

    /// Reads the newest version of each cap.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn newest_caps(&mut self) -> Result<Vec<Versioned<Cap>>, StoreError> {
        self.newest(DocumentKind::Cap).await
    }

    /// Reads the last thousand versions of a document, newest first.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn versions<T: DeserializeOwned>(
        &mut self,
        kind: DocumentKind,
        id: &DocumentId,
    ) -> Result<Vec<Versioned<T>>, StoreError> {
        let sql = format!(
            "SELECT * FROM {} WHERE {} = ? ORDER BY version DESC LIMIT 1000",
            kind.table(),
            kind.id_column()
        );
        let query = query(sql).bind(id.as_str().to_owned());
        let action = "read the versions of a document";
        all(self.0, query, action, |row| versioned(row, kind)).await
    }

    async fn newest<T: DeserializeOwned>(
        &mut self,
        kind: DocumentKind,
    ) -> Result<Vec<Versioned<T>>, StoreError> {
        // SQLite takes the columns beside `max(version)` from the row that has the maximum.
        let sql = format!(
            "SELECT {id}, max(version) AS version, document, changed_by, changed_at
             FROM {table} GROUP BY {id}",
            id = kind.id_column(),
            table = kind.table()
        );
        all(self.0, query(sql), "read the policies, rules, alliances and caps", |row| {
            versioned(row, kind)
        })
        .await
    }
}

fn versioned<T: DeserializeOwned>(
    row: &SqliteRow,
    kind: DocumentKind,
) -> Result<Versioned<T>, StoreError> {
    Ok(Versioned {
        key: DocumentVersion { id: row.parsed(kind.id_column())?, version: row.number("version")? },
        document: row.document("document")?,
        changed_by: row.column("changed_by")?,
        changed_at: row.time("changed_at")?,
    })
}

/// Stores new versions of documents of a kind.
pub(super) fn write(
    connection: &Connection,
    kind: DocumentKind,
    rows: &[DocumentRow],
) -> rusqlite::Result<()> {
    let statement = match kind {
        DocumentKind::Policy => {
            "INSERT INTO policy_version (policy_id, version, document, changed_by, changed_at)
             VALUES (?, ?, ?, ?, ?)"
        }
        DocumentKind::Rule => {
            "INSERT INTO rule_version (rule_id, version, document, changed_by, changed_at)
             VALUES (?, ?, ?, ?, ?)"
        }
        DocumentKind::Alliance => {
            "INSERT INTO alliance_version (alliance_id, version, document, changed_by, changed_at)
             VALUES (?, ?, ?, ?, ?)"
        }
        DocumentKind::Cap => {
            "INSERT INTO cap_version (cap_id, version, document, changed_by, changed_at)
             VALUES (?, ?, ?, ?, ?)"
        }
    };
    write_rows(connection, statement, rows, |row| {
        (
            row.key.id.as_str(),
            row.key.version,
            &row.document,
            &row.changed_by,
            row.changed_at.unix_micros(),
        )
    })
}
