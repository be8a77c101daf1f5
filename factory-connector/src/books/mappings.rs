//! Mappings of fields: their versions, mappings placed without a new consent, and shadows.
//!
//! A mapping says where values come from; how much of them leaves is the consent's matter. So a
//! corrected mapping of a field that flows is a new version under the same consent, and the gate
//! stays as it is.

use std::sync::Arc;

use asi_model::{DateTime, FieldKey, messages::ValueSource};
use mapping_engine::{Mapping, MappingId, Published, TargetKey, TransformState};

use super::{Books, Field, MappingWork, decisions::DecisionError};
use crate::store::{ShadowRow, StoreError, VersionRow};

/// What is kept about a field's mapping beside the decision.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shelf {
    /// The number of the newest version; 0 before the first.
    pub version: u32,
    /// The mapping of the decision is the newest version: it is or was in force.
    pub is_recorded: bool,
    /// A mapping that runs beside the published one and writes nothing.
    pub shadow: Option<Box<Shadow>>,
}

/// A mapping on trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Shadow {
    /// The mapping, with an id of its own.
    pub mapping: Mapping,
    /// Who started it.
    pub author: String,
    /// When.
    pub started_at: DateTime,
}

/// A mapping for a field, checked by the caller.
#[derive(Debug, Clone, PartialEq)]
pub struct Placing {
    /// The mapping, as [`Books::fitted`] made it.
    pub mapping: Mapping,
    /// Who places it.
    pub author: String,
    /// Where it comes from.
    pub note: Option<String>,
}

/// What placing a mapping does or would do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Placed {
    /// The field is mapped: it is the next version and runs.
    Published,
    /// The field is not mapped: it is offered with the decision.
    Proposed,
    /// It is what is there already.
    Unchanged,
}

/// Why a mapping does not fit the field it names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misfit {
    /// The member of the mapping.
    pub member: &'static str,
    /// What is wrong and what to do.
    pub message: String,
}

impl Field {
    /// The shadow's id in the engine.
    #[must_use]
    pub fn shadow_id(&self) -> MappingId {
        MappingId::new(format!("field-{}.shadow", self.id))
            .expect("short and without control characters")
    }

    /// What a mapping in place of the present one goes on with.
    #[must_use]
    pub fn state_for(&self, mapping: &Mapping) -> Option<TransformState> {
        let before = self.decision.mapping.as_ref()?;
        Some(self.transform.as_ref()?.carried_over(&before.steps, &mapping.steps))
    }
}

impl Books {
    /// A mapping as the field that it names takes it: under the field's own id.
    ///
    /// # Errors
    /// Everything about it that does not fit the field.
    pub fn fitted(&self, mapping: Mapping) -> Result<Mapping, Vec<Misfit>> {
        let Some(field) = self.fields.get(&mapping.target) else {
            let message =
                format!("no partner asks for a field {}: correct the target", mapping.target);
            return Err(vec![Misfit { member: "target", message }]);
        };
        let definition = &field.definition;
        let mut misfits = Vec::new();
        if mapping.target_type.0 != definition.field_type.0 {
            let wanted = definition.field_type.0.name();
            let message =
                format!("the partner asks for {wanted}, but this yields {}", mapping.target_type);
            misfits.push(Misfit { member: "targetType", message });
        }
        if mapping.target_unit != definition.unit {
            let name = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "no unit".to_owned());
            let message = format!(
                "the partner asks for {}, but this says {}",
                name(&definition.unit),
                name(&mapping.target_unit)
            );
            misfits.push(Misfit { member: "targetUnit", message });
        }
        if mapping.target_value_rank != definition.value_rank {
            let message = format!(
                "the partner asks for rank {}, but this yields {}",
                definition.value_rank, mapping.target_value_rank
            );
            misfits.push(Misfit { member: "targetValueRank", message });
        }
        if misfits.is_empty() {
            Ok(Mapping { mapping_id: field.mapping_id(), ..mapping })
        } else {
            Err(misfits)
        }
    }

    /// What placing this mapping would do; `None` where there is no such field.
    #[must_use]
    pub fn outcome_of(&self, mapping: &Mapping) -> Option<Placed> {
        let decision = &self.fields.get(&mapping.target)?.decision;
        Some(if decision.mapping.as_deref() == Some(mapping) {
            Placed::Unchanged
        } else if decision.is_open_for(ValueSource::Mapping) {
            Placed::Published
        } else {
            Placed::Proposed
        })
    }

    /// Takes mappings for their fields: the next version where the field is mapped, a proposal
    /// elsewhere. No consent changes. Fields that are gone meanwhile are passed over.
    pub fn place(&mut self, placings: Vec<Placing>, now: DateTime) {
        for Placing { mut mapping, author, note } in placings {
            let Some(key) = self.fields.get(&mapping.target).map(|field| field.key.clone()) else {
                continue;
            };
            self.shared.share(&mut mapping, &key);
            let (Some(outcome), Some(field)) =
                (self.outcome_of(&mapping), self.fields.get_mut(&key))
            else {
                continue;
            };
            if outcome == Placed::Unchanged {
                continue;
            }
            field.transform = field.state_for(&mapping).filter(|_| outcome == Placed::Published);
            field.decision.mapping = Some(Arc::new(mapping));
            if outcome == Placed::Published {
                self.aftermath.mappings.extend(field.published());
            }
            field.shelf.is_recorded = false;
            if outcome == Placed::Published {
                self.record_version(&key, Some(author), note, now);
            }
            self.store_field(&key);
            self.tell_pages(&key);
        }
    }

    /// Lets a mapping run beside the published one; `None` ends it.
    ///
    /// # Errors
    /// [`DecisionError::UnknownField`].
    pub fn set_shadow(
        &mut self,
        key: &FieldKey,
        mapping: Option<Mapping>,
        author: &str,
        now: DateTime,
    ) -> Result<(), DecisionError> {
        let field = self.fields.get_mut(key).ok_or(DecisionError::UnknownField)?;
        let row = mapping.map(|mapping| {
            let mapping = Mapping { mapping_id: field.shadow_id(), ..mapping };
            let row =
                ShadowRow { mapping: json(&mapping), author: author.to_owned(), started_at: now };
            field.shelf.shadow =
                Some(Box::new(Shadow { mapping, author: author.to_owned(), started_at: now }));
            row
        });
        if row.is_none() {
            field.shelf.shadow = None;
        }
        self.changes.mappings.shadows.push((field.id, row));
        self.show_shadow(key);
        self.tell_pages(key);
        Ok(())
    }

    /// Tells the engine of a field's shadow. It begins with what the published mapping remembers,
    /// so that both can be compared.
    pub(super) fn show_shadow(&mut self, key: &FieldKey) {
        let Some(field) = self.fields.get(key) else { return };
        self.aftermath.mappings.push(match &field.shelf.shadow {
            Some(shadow) => MappingWork::Put(Published {
                state: field.state_for(&shadow.mapping),
                is_shadow: true,
                ..Published::new(shadow.mapping.clone(), TargetKey(field.id))
            }),
            None => MappingWork::Remove(field.shadow_id()),
        });
    }

    /// The mapping in force becomes the next version, unless it is the newest already.
    pub(super) fn record_version(
        &mut self,
        key: &FieldKey,
        author: Option<String>,
        note: Option<String>,
        now: DateTime,
    ) {
        let Some(field) = self.fields.get_mut(key).filter(|field| !field.shelf.is_recorded) else {
            return;
        };
        let Some(mapping) = &field.decision.mapping else { return };
        field.shelf.version += 1;
        field.shelf.is_recorded = true;
        self.changes.mappings.versions.push(VersionRow {
            field_id: field.id,
            version: field.shelf.version,
            mapping: json(mapping),
            author,
            note,
            published_at: now,
        });
    }

    /// What was stored about a field's mapping beside the decision.
    pub(super) fn load_shelf(
        newest: Option<(u32, Option<String>)>,
        mapping: Option<&Mapping>,
        shadow: Option<ShadowRow>,
    ) -> Result<Shelf, StoreError> {
        let unreadable = |error: serde_json::Error| StoreError::Unreadable {
            what: "mapping",
            reason: error.to_string(),
        };
        let is_recorded = match (&newest, mapping) {
            (Some((_, Some(recorded))), Some(mapping)) => {
                serde_json::from_str::<Mapping>(recorded).map_err(unreadable)? == *mapping
            }
            (newest, mapping) => newest.is_some() && mapping.is_some(),
        };
        let shadow = shadow
            .map(|row| {
                let mapping = serde_json::from_str(&row.mapping).map_err(unreadable)?;
                Ok::<_, StoreError>(Box::new(Shadow {
                    mapping,
                    author: row.author,
                    started_at: row.started_at,
                }))
            })
            .transpose()?;
        Ok(Shelf {
            version: newest.map(|(version, _)| version).unwrap_or_default(),
            is_recorded,
            shadow,
        })
    }

    /// A field goes: what was to be written about its mapping goes too, and its shadow ends.
    pub(super) fn clear_shelf(&mut self, field: &Field) {
        let changes = &mut self.changes.mappings;
        changes.versions.retain(|row| row.field_id != field.id);
        changes.shadows.retain(|(id, _)| *id != field.id);
        if field.shelf.shadow.is_some() {
            self.aftermath.mappings.push(MappingWork::Remove(field.shadow_id()));
        }
    }
}

fn json(mapping: &Mapping) -> String {
    serde_json::to_string(mapping).expect("mappings have text keys and finite numbers")
}
