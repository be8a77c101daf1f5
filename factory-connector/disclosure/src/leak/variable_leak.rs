//! Information about each variable, in all fields that rest on it.

use std::collections::BTreeMap;

use asi_model::FieldKey;
use serde::Serialize;

use super::{bits::bits_per_hour, open_field::OpenField, variable::VariableKey};
use crate::effects::values_per_hour_max;

/// Information about a variable, in all fields that rest on it.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct VariableLeak {
    pub variable: VariableKey,
    /// The fields that rest on it: with it as an input of their mapping, or withheld by the state of
    /// such a field.
    pub fields: Vec<FieldKey>,
    /// Most values per hour in these fields; none when one of them has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Most bits per hour in these fields; none when one of them has no limit.
    pub bits_per_hour_max: Option<f64>,
}

/// Computes the information about each variable: the sum over the fields that rest on it. Each
/// field counts in full, although other variables may contribute to it: nothing bounds the share
/// of one of them.
#[must_use]
pub fn variable_leaks(open: &[OpenField<'_>]) -> Vec<VariableLeak> {
    let mut by_variable: BTreeMap<&VariableKey, Vec<&OpenField<'_>>> = BTreeMap::new();
    for field in open {
        for variable in &*field.variables {
            by_variable.entry(variable).or_default().push(field);
        }
    }
    let leak = |(variable, fields): (&VariableKey, Vec<&OpenField<'_>>)| {
        let bits = fields.iter().map(|field| bits_per_hour(field.definition, field.policy));
        let values = fields.iter().map(|field| values_per_hour_max(field.policy));
        VariableLeak {
            variable: variable.clone(),
            values_per_hour_max: values.sum(),
            bits_per_hour_max: bits.sum(),
            fields: fields.iter().map(|field| field.key.clone()).collect(),
        }
    };
    by_variable.into_iter().map(leak).collect()
}
