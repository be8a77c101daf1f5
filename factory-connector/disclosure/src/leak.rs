//! Leak budget: the information that one partner gets in total, and conclusions from several fields.
//!
//! Pure: computes figures and warnings from a list of disclosed fields. The figures are upper bounds
//! of the information in values, statuses and times, for any behaviour of machines and scripts. The
//! warnings name conclusions that the engineer may not have intended to allow. Caps limit the sums
//! over the fields of a partner and of those whom it tells.

mod alliance;
mod bits;
mod cap;
mod cap_usage;
mod conclusions;
mod open_field;
mod variable;
mod variable_leak;

pub use alliance::{ALLIANCE_MEMBERS_MAX, Alliance, readers};
use asi_model::FieldKey;
pub use bits::bits_per_hour;
use bits::bits_per_value;
pub use cap::{BITS_PER_HOUR_MAX, Cap, CapExcess, CapSubject};
pub use cap_usage::{BitSum, CapInForce, CapUsage, Exchange, FieldUse, FormerUse};
pub use conclusions::{Conclusion, LeakWarning, leak_warnings};
pub use open_field::{Measured, MeasuredRelease, OpenField};
use serde::Serialize;
pub use variable::VariableKey;
pub use variable_leak::{VariableLeak, variable_leaks};

use super::{
    Statement,
    effects::{time_resolution_ms, values_per_hour_max},
};

/// Information in one field.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldLeak {
    pub key: FieldKey,
    /// Its precision in words.
    #[serde(flatten)]
    pub statement: Statement,
    /// Most values per hour; none when only the publishing interval limits them.
    pub values_per_hour_max: Option<f64>,
    pub measured: MeasuredRelease,
    /// Most information of one value with its status and source time, in bits; none for texts and
    /// other values without a bound.
    pub bits_per_value: Option<f64>,
    /// Most information per hour, in bits: values, statuses, source times and the times of releases;
    /// none without a limit.
    pub bits_per_hour_max: Option<f64>,
    /// Resolution of the times of changes, in milliseconds; 0 when every change is released at once.
    pub time_resolution_ms: u64,
}

/// Information that a partner gets in total.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakBudget {
    pub fields: Vec<FieldLeak>,
    /// Most values per hour; none when a field has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Values per hour as measured.
    pub values_per_hour_measured: f64,
    /// Most bits per hour in values, statuses and times; none when a field has no limit.
    pub bits_per_hour_max: Option<f64>,
    /// The same by variable: the sum over all fields that rest on it.
    pub variables: Vec<VariableLeak>,
    pub warnings: Vec<LeakWarning>,
}

/// Computes the information in disclosed fields.
#[must_use]
pub fn leak_budget(open: &[OpenField<'_>]) -> LeakBudget {
    let fields: Vec<FieldLeak> = open
        .iter()
        .map(|field| FieldLeak {
            key: field.key.clone(),
            statement: Statement::of(field.policy, field.definition.unit.as_deref()),
            values_per_hour_max: values_per_hour_max(field.policy),
            measured: field.measured,
            bits_per_value: bits_per_value(field.definition, field.policy),
            bits_per_hour_max: bits_per_hour(field.definition, field.policy),
            time_resolution_ms: time_resolution_ms(field.policy),
        })
        .collect();
    LeakBudget {
        values_per_hour_max: fields.iter().map(|field| field.values_per_hour_max).sum(),
        values_per_hour_measured: fields
            .iter()
            .filter_map(|field| field.measured.released_per_hour())
            .sum(),
        bits_per_hour_max: fields.iter().map(|field| field.bits_per_hour_max).sum(),
        variables: variable_leaks(open),
        warnings: leak_warnings(open),
        fields,
    }
}

/// Information that a partner gets in total, as a summary.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakSummary {
    pub field_count: usize,
    /// Most values per hour; none when a field has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Values per hour as measured.
    pub values_per_hour_measured: f64,
    /// Most bits per hour in values, statuses and times; none when a field has no limit.
    pub bits_per_hour_max: Option<f64>,
    /// Most information of one value of any field, in bits; none when a field has no bound.
    pub bits_per_value_max: Option<f64>,
    /// Finest resolution of the times of changes of any field, in milliseconds; 0 when every change
    /// is released at once.
    pub time_resolution_ms: u64,
    /// Number of warnings in the full budget.
    pub warning_count: usize,
    /// Possible conclusions, each once.
    pub conclusions: Vec<Conclusion>,
}

/// Computes a summary of the information in disclosed fields.
#[must_use]
pub fn leak_summary(open: &[OpenField<'_>]) -> LeakSummary {
    let warnings = leak_warnings(open);
    let mut conclusions: Vec<Conclusion> =
        warnings.iter().map(|warning| warning.conclusion).collect();
    conclusions.dedup();
    let rates = || open.iter().map(|field| values_per_hour_max(field.policy));
    let bits = || open.iter().map(|field| bits_per_value(field.definition, field.policy));
    LeakSummary {
        field_count: open.len(),
        values_per_hour_max: rates().sum(),
        values_per_hour_measured: open
            .iter()
            .filter_map(|field| field.measured.released_per_hour())
            .sum(),
        bits_per_hour_max: open
            .iter()
            .map(|field| bits_per_hour(field.definition, field.policy))
            .sum(),
        bits_per_value_max: bits().try_fold(0.0, |most: f64, bits| Some(most.max(bits?))),
        time_resolution_ms: open
            .iter()
            .map(|field| time_resolution_ms(field.policy))
            .min()
            .unwrap_or(0),
        warning_count: warnings.len(),
        conclusions,
    }
}

#[cfg(test)]
mod tests;
