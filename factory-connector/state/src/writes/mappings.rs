//! Rows about mappings.

use asi_model::DateTime;

/// Rows about mappings.
#[derive(Debug, Default, PartialEq)]
pub struct MappingWrites {
    pub versions: Vec<VersionRow>,
    /// Shadow mappings that start, by field number; `None` where one ends.
    pub shadows: Vec<(i64, Option<ShadowRow>)>,
    /// Templates that are new or changed.
    pub templates: Vec<TemplateRow>,
    /// Ids of templates that are removed.
    pub removed_templates: Vec<String>,
}

impl MappingWrites {
    /// Returns true where nothing is to be written.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn merge(&mut self, later: Self) {
        let Self { versions, shadows, templates, removed_templates } = later;
        self.versions.extend(versions);
        self.shadows.extend(shadows);
        // Rows are put before others are removed, so that of both about one template the later holds.
        self.templates.retain(|row| !removed_templates.contains(&row.template_id));
        self.removed_templates.retain(|id| templates.iter().all(|row| row.template_id != *id));
        self.templates.extend(templates);
        self.removed_templates.extend(removed_templates);
    }

    pub(super) fn forget_field(&mut self, id: i64) {
        self.versions.retain(|row| row.field_id != id);
        self.shadows.retain(|(field, _)| *field != id);
    }
}

/// A published mapping.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VersionRow {
    /// Number of the field.
    pub field_id: i64,
    /// Number of the version within its field, from 1.
    pub version: u32,
    /// The mapping as JSON.
    pub mapping: String,
    /// Name of the user who published it.
    pub author: Option<String>,
    /// Origin other than the editor: a former version, a file, a shadow mapping.
    pub note: Option<String>,
    pub published_at: DateTime,
}

/// A mapping that runs beside the published one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadowRow {
    /// The mapping as JSON.
    pub mapping: String,
    /// Name of the user who started it.
    pub author: String,
    pub started_at: DateTime,
}

/// A template of mappings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TemplateRow {
    pub template_id: String,
    /// The template as JSON.
    pub template: String,
    /// Name of the user who changed it last.
    pub author: String,
    pub changed_at: DateTime,
}
