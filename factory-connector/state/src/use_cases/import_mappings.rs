//! Mappings of fields: imported without a new consent, and run as shadow mappings.
//!
//! A mapping says where values come from; the consent says how much of them is disclosed. So a
//! corrected mapping of a mapped field is a new version under the same consent. What waited at the
//! gate came from the former mapping and is dropped.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey};
use disclosure::CapExcess;
use mapping::Mapping;

use super::decide::DecisionError;
use crate::{
    ChangeSet, ConnectorState, ShadowMapping, consents, dependencies,
    fields::mapping_json,
    queries::{ImportEffect, import_effect, import_excesses},
    writes::ShadowRow,
};

/// A mapping to import.
#[derive(Debug, Clone, PartialEq)]
pub struct MappingImport {
    /// The mapping, as [`validate_for_field`](crate::queries::validate_for_field) returned it.
    pub mapping: Mapping,
    /// Name of the user.
    pub author: String,
    /// Origin of the mapping.
    pub note: Option<String>,
}

/// Imports mappings: as the next version where the field is mapped, as a proposal elsewhere. No
/// consent changes. Fields that do not exist any more are skipped.
///
/// # Errors
/// The caps of variables that the mappings together would exceed.
pub fn import_mappings(
    state: &mut ConnectorState,
    imports: Vec<MappingImport>,
    now: DateTime,
) -> Result<ChangeSet, Vec<CapExcess>> {
    let excesses = import_excesses(state, imports.iter().map(|import| &import.mapping), now);
    if !excesses.is_empty() {
        return Err(excesses);
    }
    let mut changes = ChangeSet::default();
    for import in imports {
        import_one(state, &mut changes, import, now);
    }
    Ok(changes)
}

fn import_one(
    state: &mut ConnectorState,
    changes: &mut ChangeSet,
    import: MappingImport,
    now: DateTime,
) {
    let MappingImport { mut mapping, author, note } = import;
    let Some(key) = state.field(&mapping.target).map(|field| field.key().clone()) else { return };
    state.fields.share_mapping(&mut mapping, &key);
    let is_published = match import_effect(state, &mapping) {
        None | Some(ImportEffect::Unchanged) => return,
        Some(outcome) => outcome == ImportEffect::Published,
    };
    let Some(mut field) = state.fields.get_mut(&key) else { return };
    let transform = field.state_for(&mapping).filter(|_| is_published);
    if is_published {
        changes.purge_replaced(field.writer());
        field.begin_source(transform, now);
    } else {
        field.set_transform(transform);
    }
    field.change_decision(|decision| decision.mapping = Some(Arc::new(mapping)));
    field.set_recorded(false);
    changes.put_field(&field);
    if is_published {
        changes.effects.engine.extend(field.publish_mapping());
        dependencies::notify(state, &key, now);
        consents::record_version(state, changes, &key, (Some(author), note), now);
    }
}

/// Runs a mapping beside the published one; `None` ends it.
///
/// # Errors
/// [`DecisionError::UnknownField`].
pub fn set_shadow(
    state: &mut ConnectorState,
    key: &FieldKey,
    mapping: Option<Mapping>,
    author: &str,
    now: DateTime,
) -> Result<ChangeSet, DecisionError> {
    let mut field = state.fields.get_mut(key).ok_or(DecisionError::UnknownField)?;
    let shadow = mapping.map(|mapping| {
        let mapping = Mapping { mapping_id: field.shadow_id(), ..mapping };
        Box::new(ShadowMapping { mapping, author: author.to_owned(), started_at: now })
    });
    let row = shadow.as_ref().map(|shadow| ShadowRow {
        mapping: mapping_json(&shadow.mapping),
        author: shadow.author.clone(),
        started_at: now,
    });
    field.set_shadow(shadow);
    let mut changes = ChangeSet::default();
    changes.writes.mappings.shadows.push((field.id(), row));
    changes.effects.engine.push(field.publish_shadow());
    changes.put_event(&field);
    Ok(changes)
}
