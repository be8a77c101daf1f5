//! Mappings that are imported: whether they fit their fields, and what importing them would do.

use asi_model::messages::ValueSource;
use mapping::Mapping;

use crate::ConnectorState;

/// Effect of importing a mapping.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ImportEffect {
    /// The field is mapped: the mapping is its next version and runs.
    Published,
    /// The field is not mapped: the mapping is suggested with the decision.
    Proposed,
    /// The field has this mapping already.
    Unchanged,
}

/// A member of a mapping that does not match the field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldMismatch {
    /// JSON name of the member.
    pub member: &'static str,
    /// The fault and its remedy.
    pub message: String,
}

/// Checks a mapping against the field it names, and gives it the field's mapping id.
///
/// # Errors
/// All mismatches.
pub fn validate_for_field(
    state: &ConnectorState,
    mapping: Mapping,
) -> Result<Mapping, Vec<FieldMismatch>> {
    let Some(field) = state.field(&mapping.target) else {
        let message = format!("no partner asks for a field {}: correct the target", mapping.target);
        return Err(vec![FieldMismatch { member: "target", message }]);
    };
    let definition = field.definition();
    let mut mismatches = Vec::new();
    if mapping.target_type.0 != definition.field_type.0 {
        let expected = definition.field_type.0.name();
        let message =
            format!("the partner asks for {expected}, but this yields {}", mapping.target_type);
        mismatches.push(FieldMismatch { member: "targetType", message });
    }
    if mapping.target_unit != definition.unit {
        let name = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "no unit".to_owned());
        let message = format!(
            "the partner asks for {}, but this says {}",
            name(&definition.unit),
            name(&mapping.target_unit)
        );
        mismatches.push(FieldMismatch { member: "targetUnit", message });
    }
    if mapping.target_value_rank != definition.value_rank {
        let message = format!(
            "the partner asks for rank {}, but this yields {}",
            definition.value_rank, mapping.target_value_rank
        );
        mismatches.push(FieldMismatch { member: "targetValueRank", message });
    }
    if mismatches.is_empty() {
        Ok(Mapping { mapping_id: field.mapping_id(), ..mapping })
    } else {
        Err(mismatches)
    }
}

/// Returns the effect of importing a mapping; `None` where its field does not exist.
#[must_use]
pub fn import_effect(state: &ConnectorState, mapping: &Mapping) -> Option<ImportEffect> {
    let decision = state.field(&mapping.target)?.decision();
    Some(if decision.mapping.as_deref() == Some(mapping) {
        ImportEffect::Unchanged
    } else if decision.is_open_for(ValueSource::Mapping) {
        ImportEffect::Published
    } else {
        ImportEffect::Proposed
    })
}
