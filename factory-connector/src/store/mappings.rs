//! Versions of mappings, shadows and templates.

use std::collections::HashMap;

use asi_model::DateTime;
use futures::TryStreamExt as _;
use rusqlite::Connection;
use sqlx::{SqliteConnection, SqlitePool};

use super::{
    StoreError,
    load::get,
    writer::{run, write_rows},
};

/// Versions kept per field; the oldest go.
pub const VERSIONS_MAX: u32 = 100;

/// What one transaction changes about mappings.
#[derive(Debug, Default)]
pub struct MappingChanges {
    /// New versions.
    pub versions: Vec<VersionRow>,
    /// Shadows that start; `None` where one ends. By the number of the field.
    pub shadows: Vec<(i64, Option<ShadowRow>)>,
    /// Templates that are new or changed.
    pub templates: Vec<TemplateRow>,
    /// Templates that are gone.
    pub removed_templates: Vec<String>,
}

impl MappingChanges {
    /// Nothing to write.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.versions.is_empty()
            && self.shadows.is_empty()
            && self.templates.is_empty()
            && self.removed_templates.is_empty()
    }
}

/// A published mapping.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VersionRow {
    /// The number of its field.
    pub field_id: i64,
    /// Counts from 1.
    pub version: u32,
    /// The mapping as JSON.
    pub mapping: String,
    /// Who published it.
    pub author: Option<String>,
    /// Where it came from, where not from the editor: a former version, a file, a shadow.
    pub note: Option<String>,
    /// When.
    pub published_at: DateTime,
}

/// A mapping that runs beside the published one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadowRow {
    /// The mapping as JSON.
    pub mapping: String,
    /// Who started it.
    pub author: String,
    /// When.
    pub started_at: DateTime,
}

/// A stored template.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TemplateRow {
    /// Its id.
    pub template_id: String,
    /// The template as JSON.
    pub template: String,
    /// Who changed it last.
    pub author: String,
    /// When.
    pub changed_at: DateTime,
}

/// What is known of the mappings of all fields at the start.
#[derive(Debug, Default)]
pub struct MappingShelf {
    /// The newest version of each field, with its mapping as JSON; without where it is the mapping
    /// of the field's decision.
    pub versions: HashMap<i64, (u32, Option<String>)>,
    /// The shadows.
    pub shadows: HashMap<i64, ShadowRow>,
}

pub(super) fn write(connection: &Connection, changes: &MappingChanges) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO mapping_version (field_id, version, mapping, author, note, published_at) \
         VALUES (?, ?, ?, ?, ?, ?)",
        &changes.versions,
        |row| {
            (
                row.field_id,
                row.version,
                &row.mapping,
                &row.author,
                &row.note,
                row.published_at.unix_micros(),
            )
        },
    )?;
    write_rows(
        connection,
        "DELETE FROM mapping_version WHERE field_id = ? AND version <= ?",
        changes.versions.iter().filter(|row| row.version > VERSIONS_MAX),
        |row| (row.field_id, row.version - VERSIONS_MAX),
    )?;
    for (field_id, shadow) in &changes.shadows {
        let Some(shadow) = shadow else {
            run(connection, "DELETE FROM mapping_shadow WHERE field_id = ?", (field_id,))?;
            continue;
        };
        run(
            connection,
            "INSERT INTO mapping_shadow (field_id, mapping, author, started_at) VALUES (?, ?, ?, ?) \
             ON CONFLICT (field_id) DO UPDATE SET mapping = excluded.mapping, author = excluded.author, \
             started_at = excluded.started_at",
            (field_id, &shadow.mapping, &shadow.author, shadow.started_at.unix_micros()),
        )?;
    }
    write_rows(
        connection,
        "INSERT INTO mapping_template (template_id, template, author, changed_at) VALUES (?, ?, ?, ?) \
         ON CONFLICT (template_id) DO UPDATE SET template = excluded.template, author = excluded.author, \
         changed_at = excluded.changed_at",
        &changes.templates,
        |row| (&row.template_id, &row.template, &row.author, row.changed_at.unix_micros()),
    )?;
    write_rows(
        connection,
        "DELETE FROM mapping_template WHERE template_id = ?",
        &changes.removed_templates,
        |template_id| (template_id,),
    )
}

pub(super) async fn load(connection: &mut SqliteConnection) -> Result<MappingShelf, StoreError> {
    let mut shelf = MappingShelf::default();
    let mut versions = sqlx::query(
        "SELECT this.field_id, this.version, nullif(this.mapping, field.mapping) FROM mapping_version AS this \
         LEFT JOIN field ON field.id = this.field_id WHERE this.version = \
         (SELECT max(version) FROM mapping_version AS other WHERE other.field_id = this.field_id)",
    )
    .fetch(&mut *connection);
    while let Some(row) = versions
        .try_next()
        .await
        .map_err(StoreError::while_doing("read the versions of mappings"))?
    {
        let version: i64 = get(&row, 1)?;
        shelf
            .versions
            .insert(get(&row, 0)?, (u32::try_from(version).unwrap_or(u32::MAX), get(&row, 2)?));
    }
    drop(versions);
    let shadows = sqlx::query("SELECT field_id, mapping, author, started_at FROM mapping_shadow")
        .fetch_all(connection)
        .await
        .map_err(StoreError::while_doing("read the shadow mappings"))?;
    for row in &shadows {
        let shadow = ShadowRow {
            mapping: get(row, 1)?,
            author: get(row, 2)?,
            started_at: DateTime::from_unix_micros(get(row, 3)?),
        };
        shelf.shadows.insert(get(row, 0)?, shadow);
    }
    Ok(shelf)
}

/// The versions of a field's mapping, newest first.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn versions(readers: &SqlitePool, field_id: i64) -> Result<Vec<VersionRow>, StoreError> {
    let rows = sqlx::query(
        "SELECT version, mapping, author, note, published_at FROM mapping_version WHERE field_id = ? \
         ORDER BY version DESC",
    )
    .bind(field_id)
    .fetch_all(readers)
    .await
    .map_err(StoreError::while_doing("read the versions of a mapping"))?;
    rows.iter()
        .map(|row| {
            let version: i64 = get(row, 0)?;
            Ok(VersionRow {
                field_id,
                version: u32::try_from(version).unwrap_or(u32::MAX),
                mapping: get(row, 1)?,
                author: get(row, 2)?,
                note: get(row, 3)?,
                published_at: DateTime::from_unix_micros(get(row, 4)?),
            })
        })
        .collect()
}

/// All templates, by their ids.
///
/// # Errors
/// [`StoreError`] where the table cannot be read.
pub async fn templates(readers: &SqlitePool) -> Result<Vec<TemplateRow>, StoreError> {
    let rows =
        sqlx::query("SELECT template_id, template, author, changed_at FROM mapping_template ORDER BY template_id")
            .fetch_all(readers)
            .await
            .map_err(StoreError::while_doing("read the templates"))?;
    rows.iter()
        .map(|row| {
            Ok(TemplateRow {
                template_id: get(row, 0)?,
                template: get(row, 1)?,
                author: get(row, 2)?,
                changed_at: DateTime::from_unix_micros(get(row, 3)?),
            })
        })
        .collect()
}
