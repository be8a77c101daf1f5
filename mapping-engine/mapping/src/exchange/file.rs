//! One readable file with everything: to keep under version control, to carry to another factory.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::template::MappingTemplate;
use crate::document::Mapping;

/// Longest file, in bytes.
pub const FILE_BYTES_MAX: usize = 64 << 20;
const VERSION: u32 = 1;

/// Mappings and templates as one JSON document.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MappingFile {
    /// The format's version: 1.
    pub version: u32,
    /// Templates for series of like machines.
    #[serde(default)]
    pub templates: Vec<MappingTemplate>,
    /// Mappings without a template.
    #[serde(default)]
    pub mappings: Vec<Mapping>,
}

/// Fault of a text that is not a mapping file.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    /// The file is too long.
    #[error("the file has {0} bytes; at most {FILE_BYTES_MAX} are read")]
    TooLong(usize),
    /// The file is not the JSON it should be.
    #[error("line {line}, column {column}: {message}")]
    Malformed {
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
        /// Sentence that names the fault.
        message: String,
    },
    /// The file is of a version that we do not know.
    #[error("the file is of version {0}; version {VERSION} is read")]
    Version(u32),
}

impl MappingFile {
    /// A file of these, each kind sorted by its id, so that two exports differ only where something
    /// changed.
    #[must_use]
    pub fn new(mut templates: Vec<MappingTemplate>, mut mappings: Vec<Mapping>) -> Self {
        templates.sort_by(|a, b| a.template_id.cmp(&b.template_id));
        mappings.sort_by(|a, b| a.mapping_id.cmp(&b.mapping_id));
        Self { version: VERSION, templates, mappings }
    }

    /// The text of the file: JSON with one member per line.
    #[must_use]
    pub fn write(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("mappings have text keys only");
        text.push('\n');
        text
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ExchangeError`].
    pub fn read(text: &str) -> Result<Self, ExchangeError> {
        if text.len() > FILE_BYTES_MAX {
            return Err(ExchangeError::TooLong(text.len()));
        }
        let file: Self = serde_json::from_str(text).map_err(|error| ExchangeError::Malformed {
            line: error.line(),
            column: error.column(),
            message: error.to_string(),
        })?;
        if file.version == VERSION { Ok(file) } else { Err(ExchangeError::Version(file.version)) }
    }
}

#[cfg(test)]
mod tests;
