//! Caps: limits of the information that a partner or an alliance gets per hour.

use std::fmt;

use asi_model::OrganisationId;
use serde::{Deserialize, Serialize};

use super::variable::VariableKey;
use crate::{DocumentId, DocumentVersion, NAME_CHARS_MAX, RuleFault};

/// Greatest limit of a cap, in bits per hour.
pub const BITS_PER_HOUR_MAX: f64 = 1e15;

/// Partners whose information a cap limits.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum CapSubject {
    /// A partner, together with its allies: it learns what they tell it.
    Partner(OrganisationId),
    /// All members of an alliance together.
    AllianceId(DocumentId),
}

/// Limit of the information that a partner or an alliance gets per hour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Cap {
    /// Name for people, 1 to 120 characters.
    pub name: String,
    pub subject: CapSubject,
    /// The variable that it is about; all fields without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variable: Option<VariableKey>,
    /// Most bits per hour, 0 to 1e15. With 0 nothing is disclosed.
    #[schema(minimum = 0, maximum = 1e15)]
    pub bits_per_hour_max: f64,
    /// True when it no longer limits anything.
    #[serde(default)]
    pub is_retired: bool,
}

impl Cap {
    /// Returns all faults of the cap by itself.
    #[must_use]
    pub fn faults(&self) -> Vec<RuleFault> {
        let mut faults: Vec<RuleFault> = name_fault(&self.name).into_iter().collect();
        if !(0.0..=BITS_PER_HOUR_MAX).contains(&self.bits_per_hour_max) {
            let message = "A cap has 0 to 1e15 bits per hour.".to_owned();
            faults.push(RuleFault { pointer: "/bitsPerHourMax".to_owned(), message });
        }
        faults
    }
}

/// A cap that a change would exceed. The text names the figures and the remedies.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CapExcess {
    pub cap: DocumentVersion,
    /// Name of the cap.
    pub name: String,
    /// The variable that the cap is about, if it is about one.
    pub variable: Option<VariableKey>,
    /// Limit of the cap, in bits per hour.
    pub bits_per_hour_max: f64,
    /// Bits per hour at present; none without a bound.
    pub bits_per_hour_now: Option<f64>,
    /// Bits per hour with the change; none without a bound.
    pub bits_per_hour_then: Option<f64>,
}

impl fmt::Display for CapExcess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let figure = |bits: Option<f64>| {
            bits.map_or_else(|| "unlimited".to_owned(), |bits| format!("{:.1}", bits))
        };
        write!(
            f,
            "The cap {} allows {:.1} bits per hour; the sum is {} now and would be {}. Coarsen more \
             (a minimum interval, a time step, bands), end another consent (it counts for an hour \
             longer), or raise the cap.",
            self.name,
            self.bits_per_hour_max,
            figure(self.bits_per_hour_now),
            figure(self.bits_per_hour_then),
        )
    }
}

/// Returns the fault of a document's name, if it has one.
pub(super) fn name_fault(name: &str) -> Option<RuleFault> {
    let is_name = !name.trim().is_empty() && name.chars().count() <= NAME_CHARS_MAX;
    (!is_name).then(|| RuleFault {
        pointer: "/name".to_owned(),
        message: "A name has 1 to 120 characters.".to_owned(),
    })
}
