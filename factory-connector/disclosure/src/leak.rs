//! What one partner learns in sum, and what approved fields reveal when they are put together.
//!
//! Pure: a list of open fields goes in, figures and warnings come out. The figures are upper bounds
//! of what can be learned from the values themselves; the warnings name conclusions that an
//! engineer may not have meant to allow.

mod bits;
mod conclusions;

use asi_model::{
    FieldKey,
    network::{Operation, ReportField},
};
use serde::Serialize;

use bits::bits_per_value;
pub use conclusions::{Conclusion, LeakWarning, leak_warnings};

use super::{
    DisclosurePolicy, Statement,
    effects::{time_resolution_ms, values_per_hour_max},
};

/// A field that a partner gets.
#[derive(Debug, Clone, Copy)]
pub struct OpenField<'f> {
    /// Which.
    pub key: &'f FieldKey,
    /// As requested.
    pub definition: &'f ReportField,
    /// The operation that it is about.
    pub operation: &'f Operation,
    /// The precision that holds.
    pub policy: &'f DisclosurePolicy,
    /// What left.
    pub measured: Measured,
}

/// What was counted over a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Measured {
    /// Values that came from the source.
    pub candidates: u64,
    /// Values that left.
    pub released: u64,
    /// Over how many hours, at most 24; since the connector started or the field was opened.
    pub hours: f64,
}

impl Measured {
    /// Values that left per hour.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn released_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.released as f64 / self.hours)
    }

    /// Values that came per hour.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn candidates_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.candidates as f64 / self.hours)
    }
}

/// What one field tells.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldLeak {
    /// Which.
    #[schema(value_type = Object)]
    pub key: FieldKey,
    /// Its precision in words.
    #[serde(flatten)]
    pub told: Statement,
    /// Values per hour at most; none where only the publishing interval limits them.
    pub values_per_hour_max: Option<f64>,
    /// What was measured.
    pub measured: Measured,
    /// The most that one value can tell, in bits; none for texts and other values without bound.
    pub bits_per_value: Option<f64>,
    /// How exactly changes are timed, in milliseconds; 0: as they happen.
    pub time_resolution_ms: u64,
}

/// What a partner learns in sum.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakBudget {
    /// Each field.
    pub fields: Vec<FieldLeak>,
    /// Values per hour at most; none where a field has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Values per hour as measured.
    pub values_per_hour_measured: f64,
    /// Bits per hour at most; none where a field has no limit.
    pub bits_per_hour_max: Option<f64>,
    /// What can be concluded.
    pub warnings: Vec<LeakWarning>,
}

/// The sum of what open fields tell.
#[must_use]
pub fn leak_budget(open: &[OpenField<'_>]) -> LeakBudget {
    let fields: Vec<FieldLeak> = open
        .iter()
        .map(|field| FieldLeak {
            key: field.key.clone(),
            told: field.policy.told(field.definition.unit.as_deref()),
            values_per_hour_max: values_per_hour_max(field.policy),
            measured: field.measured,
            bits_per_value: bits_per_value(field),
            time_resolution_ms: time_resolution_ms(field.policy),
        })
        .collect();
    let bits = |field: &FieldLeak| Some(field.values_per_hour_max? * field.bits_per_value?);
    LeakBudget {
        values_per_hour_max: fields.iter().map(|field| field.values_per_hour_max).sum(),
        values_per_hour_measured: fields
            .iter()
            .filter_map(|field| field.measured.released_per_hour())
            .sum(),
        bits_per_hour_max: fields.iter().map(bits).sum(),
        warnings: leak_warnings(open),
        fields,
    }
}

/// What a partner learns in sum, in short.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakSummary {
    /// How many fields.
    pub field_count: usize,
    /// Values per hour at most; none where a field has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Values per hour as measured.
    pub values_per_hour_measured: f64,
    /// Bits per hour at most; none where a field has no limit.
    pub bits_per_hour_max: Option<f64>,
    /// The most that one value of any field can tell, in bits; none where a field has no bound.
    pub bits_per_value_max: Option<f64>,
    /// How exactly changes of the field that is timed best are timed, in milliseconds; 0: as they
    /// happen.
    pub time_resolution_ms: u64,
    /// How many things can be concluded.
    pub warning_count: usize,
    /// What, each once.
    pub conclusions: Vec<Conclusion>,
}

/// The sum of what open fields tell, in short.
#[must_use]
pub fn leak_summary(open: &[OpenField<'_>]) -> LeakSummary {
    let warnings = leak_warnings(open);
    let mut conclusions: Vec<Conclusion> =
        warnings.iter().map(|warning| warning.conclusion).collect();
    conclusions.dedup();
    let rates = || open.iter().map(|field| values_per_hour_max(field.policy));
    let bits = || open.iter().map(bits_per_value);
    LeakSummary {
        field_count: open.len(),
        values_per_hour_max: rates().sum(),
        values_per_hour_measured: open
            .iter()
            .filter_map(|field| field.measured.released_per_hour())
            .sum(),
        bits_per_hour_max: rates().zip(bits()).map(|(rate, bits)| Some(rate? * bits?)).sum(),
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
