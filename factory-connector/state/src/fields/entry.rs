//! A field as the registry holds it.

use super::{Field, deadlines::Noted};

/// A field with the registry's own notes about it.
pub(super) struct FieldEntry {
    pub(super) field: Field,
    /// Stands among the fields that the next transaction writes.
    pub(super) is_dirty: bool,
    /// Its gate released a value that no report carries yet.
    pub(super) has_released: bool,
    pub(super) deadlines: Noted,
}

impl FieldEntry {
    pub(super) fn new(field: Field) -> Self {
        Self { field, is_dirty: false, has_released: false, deadlines: Noted::default() }
    }
}
