//! Templates: mappings with gaps, filled once per machine of a series.

use rusqlite::Connection;
use sqlx::{SqliteConnection, sqlite::SqliteRow};

use super::{
    TemplateRow,
    error::StoreError,
    query::{all, query},
    row::Columns as _,
    statement::write_rows,
};

/// Repository of templates.
pub struct MappingTemplates<'c>(pub(super) &'c mut SqliteConnection);

impl MappingTemplates<'_> {
    /// Reads all templates by their ids.
    ///
    /// # Errors
    /// [`StoreError`].
    pub async fn all(&mut self) -> Result<Vec<TemplateRow>, StoreError> {
        let query = query("SELECT * FROM mapping_template ORDER BY template_id");
        all(self.0, query, "read the templates", template).await
    }
}

fn template(row: &SqliteRow) -> Result<TemplateRow, StoreError> {
    Ok(TemplateRow {
        template_id: row.column("template_id")?,
        template: row.column("template")?,
        author: row.column("author")?,
        changed_at: row.time("changed_at")?,
    })
}

/// Stores new and changed templates, then removes others by their ids.
pub(super) fn write(
    connection: &Connection,
    templates: &[TemplateRow],
    removed: &[String],
) -> rusqlite::Result<()> {
    write_rows(
        connection,
        "INSERT INTO mapping_template (template_id, template, author, changed_at)
         VALUES (?, ?, ?, ?)
         ON CONFLICT (template_id) DO UPDATE SET
             template = excluded.template, author = excluded.author,
             changed_at = excluded.changed_at",
        templates,
        |row| (&row.template_id, &row.template, &row.author, row.changed_at.unix_micros()),
    )?;
    write_rows(
        connection,
        "DELETE FROM mapping_template WHERE template_id = ?",
        removed,
        |template_id| (template_id,),
    )
}
