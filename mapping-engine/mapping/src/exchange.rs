//! Many mappings at once: templates for series of like machines, and files that go out and come
//! back unchanged.

mod csv;
mod file;
mod table;
mod template;

pub use file::{ExchangeError, FILE_BYTES_MAX, MappingFile};
pub use table::{RowFault, read_table, write_table};
pub use template::{MappingTemplate, TemplateFault, TemplateParameter, numbers};
