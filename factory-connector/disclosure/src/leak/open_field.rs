//! A disclosed field, as input of the leak budget.

use std::sync::Arc;

use asi_model::{
    FieldKey,
    network::{Operation, ReportField},
};
use serde::Serialize;

use super::variable::VariableKey;
use crate::DisclosurePolicy;

/// A field that is disclosed to a partner.
#[derive(Debug, Clone)]
pub struct OpenField<'f> {
    pub key: &'f FieldKey,
    /// Definition in the request.
    pub definition: &'f ReportField,
    /// The operation that the request is about.
    pub operation: &'f Operation,
    /// The policy in force.
    pub policy: &'f DisclosurePolicy,
    /// The variables that the field rests on, sorted; none where people or OPC UA clients write it.
    pub variables: Arc<[VariableKey]>,
    pub measured: MeasuredRelease,
}

/// Counts over a period, before and behind the gate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Measured {
    /// Candidates from the source.
    pub candidates: u64,
    /// Values that the gate released.
    pub released: u64,
    /// Length of the period in hours, at most 24; since the connector started or the field was
    /// opened.
    pub hours: f64,
}

/// Count of what the gate released over a period. A budget has no other count: that of the
/// candidates tells what no partner gets.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct MeasuredRelease {
    /// Values that the gate released.
    pub released: u64,
    /// Length of the period in hours, at most 24; since the connector started or the field was
    /// opened.
    pub hours: f64,
}

impl MeasuredRelease {
    /// Returns the released values per hour; none before any time has passed.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn released_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.released as f64 / self.hours)
    }
}

impl From<Measured> for MeasuredRelease {
    fn from(Measured { released, hours, .. }: Measured) -> Self {
        Self { released, hours }
    }
}

impl Measured {
    /// Returns the candidates per hour; none before any time has passed.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn candidates_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.candidates as f64 / self.hours)
    }
}
