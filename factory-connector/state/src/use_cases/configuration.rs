//! Sources of values, templates and the lease: stored with the rest of a transaction, but no part
//! of the state.

use crate::{
    ChangeSet,
    writes::{SourceRow, TemplateRow},
};

/// Stores a source.
#[must_use]
pub fn put_source(source: SourceRow) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.sources.put.push(source);
    changes
}

/// Removes a source.
#[must_use]
pub fn remove_source(source_id: String) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.sources.removed.push(source_id);
    changes
}

/// Stores a template of mappings.
#[must_use]
pub fn put_template(template: TemplateRow) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.mappings.templates.push(template);
    changes
}

/// Removes a template of mappings.
#[must_use]
pub fn remove_template(template_id: String) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.mappings.removed_templates.push(template_id);
    changes
}

/// Stores whether the factory's lease was granted to this connector.
#[must_use]
pub fn set_lease_held(is_held: bool) -> ChangeSet {
    let mut changes = ChangeSet::default();
    changes.writes.is_lease_held = Some(is_held);
    changes
}
