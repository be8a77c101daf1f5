//! The disclosure policy of a field: what the engineer consented to.

use std::time::Duration;

use asi_model::{BuiltInType, messages::DisclosureStatement};
use serde::{Deserialize, Serialize};

use super::{RoundingStep, WorkingHours};

/// How a field's values are coarsened before they leave. Empty: every change leaves as it is.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields, default)]
pub struct DisclosurePolicy {
    /// Numbers are rounded to the nearest multiple of this, in the field's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<f64>)]
    pub rounding_step: Option<RoundingStep>,
    /// Numbers are replaced by the greatest of these bounds not above them (by the lowest, if below all); ascending.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<f64>,
    /// At most one value leaves per this many milliseconds; the latest wins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minimum_interval_ms: Option<u64>,
    /// Times are rounded down to multiples of this many milliseconds since 1970, and values leave on them only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_step_ms: Option<u64>,
    /// Every value leaves this many milliseconds late.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_ms: Option<u64>,
    /// Values leave within these hours only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub working_hours: Option<WorkingHours>,
}

/// What is wrong with a policy for a field.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{member}: {message}")]
pub struct PolicyFault {
    /// The member of the policy, as in JSON.
    pub member: &'static str,
    /// What is wrong and what to do.
    pub message: String,
}

/// Longest interval, time step or delay: a year.
const PERIOD_MS_MAX: u64 = 366 * 86_400_000;
/// Most bounds that bands may have.
const BANDS_MAX: usize = 64;

impl DisclosurePolicy {
    /// Everything that keeps this policy from being applied to a field of this type.
    #[must_use]
    pub fn faults(&self, field_type: BuiltInType) -> Vec<PolicyFault> {
        let mut faults = Vec::new();
        let mut fault = |member, message: String| faults.push(PolicyFault { member, message });
        if let Some(step) = self.rounding_step {
            if !field_type.is_numeric() {
                fault("roundingStep", format!("only numbers can be rounded, and this field is a {field_type}"));
            } else if field_type.is_integer() && step.to_integer().is_none() {
                fault("roundingStep", format!("{step} is not a whole number, as a {field_type} needs"));
            }
        }
        if !self.bands.is_empty() {
            if !field_type.is_numeric() {
                fault("bands", format!("only numbers can be put into bands, and this field is a {field_type}"));
            }
            if self.bands.len() > BANDS_MAX {
                fault("bands", format!("at most {BANDS_MAX} bounds are possible"));
            }
            if self.bands.iter().any(|bound| !bound.is_finite()) || self.bands.windows(2).any(|w| w[0] >= w[1]) {
                fault("bands", "the bounds must be finite numbers in ascending order".to_owned());
            }
            if field_type.is_integer() && self.bands.iter().any(|b| b.fract() != 0.0 || b.abs() > 9e15) {
                fault("bands", format!("the bounds must be whole numbers, as a {field_type} needs"));
            }
            if self.rounding_step.is_some() {
                fault("bands", "bands and a rounding step exclude each other; choose one".to_owned());
            }
        }
        for (member, period) in [
            ("minimumIntervalMs", self.minimum_interval_ms),
            ("timeStepMs", self.time_step_ms),
            ("delayMs", self.delay_ms),
        ] {
            if period.is_some_and(|ms| ms == 0 || ms > PERIOD_MS_MAX) {
                fault(member, format!("must lie between 1 and {PERIOD_MS_MAX}"));
            }
        }
        if let Some(hours) = &self.working_hours {
            if hours.days.is_empty() || hours.from >= hours.until {
                fault("workingHours", "needs at least one day, and must begin before it ends".to_owned());
            }
            if hours.utc_offset_minutes.abs() > 14 * 60 {
                fault("workingHours", "no place on earth is more than 14 hours ahead of or behind UTC".to_owned());
            }
        }
        faults
    }

    /// True where nothing is coarsened.
    #[must_use]
    pub fn is_open(&self) -> bool {
        *self == Self::default()
    }

    /// The minimum interval, zero without one.
    #[must_use]
    pub fn minimum_interval(&self) -> Duration {
        Duration::from_millis(self.minimum_interval_ms.unwrap_or(0))
    }

    /// The time step, zero without one.
    #[must_use]
    pub fn time_step(&self) -> Duration {
        Duration::from_millis(self.time_step_ms.unwrap_or(0))
    }

    /// The delay, zero without one.
    #[must_use]
    pub fn delay(&self) -> Duration {
        Duration::from_millis(self.delay_ms.unwrap_or(0))
    }

    /// What the partner is told about its precision.
    #[must_use]
    pub fn statement(&self, unit: Option<&str>) -> DisclosureStatement {
        DisclosureStatement {
            description: self.describe(unit),
            rounding_step: self.rounding_step.map(|step| step.decimal().to_f64()),
            minimum_interval_ms: self.minimum_interval_ms,
            time_step_ms: self.time_step_ms,
            delay_ms: self.delay_ms,
        }
    }

    fn describe(&self, unit: Option<&str>) -> String {
        let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
        let mut parts = Vec::new();
        if let Some(step) = self.rounding_step {
            parts.push(format!("rounded to multiples of {step}{unit}"));
        }
        if !self.bands.is_empty() {
            let bounds: Vec<String> = self.bands.iter().map(f64::to_string).collect();
            parts.push(format!("in bands from {}{unit}", bounds.join(", ")));
        }
        if let Some(ms) = self.minimum_interval_ms {
            parts.push(format!("at most once per {}", describe_period(ms)));
        }
        if let Some(ms) = self.time_step_ms {
            parts.push(format!("times in steps of {}", describe_period(ms)));
        }
        if let Some(ms) = self.delay_ms {
            parts.push(format!("{} late", describe_period(ms)));
        }
        if let Some(hours) = &self.working_hours {
            parts.push(hours.describe());
        }
        if parts.is_empty() {
            return "Every change, as it is.".to_owned();
        }
        let mut text = parts.join("; ");
        if let Some(first) = text.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        text.push('.');
        text
    }
}

fn describe_period(ms: u64) -> String {
    for (length, name) in [(86_400_000, "d"), (3_600_000, "h"), (60_000, "min"), (1_000, "s")] {
        if ms.is_multiple_of(length) {
            return format!("{} {name}", ms / length);
        }
    }
    format!("{ms} ms")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_the_partner_gets() {
        for (json, unit, text) in [
            ("{}", None, "Every change, as it is."),
            (
                r#"{"roundingStep":10,"minimumIntervalMs":60000}"#,
                Some("PIECE"),
                "Rounded to multiples of 10 PIECE; at most once per 1 min.",
            ),
            (r#"{"timeStepMs":900000,"delayMs":1500}"#, None, "Times in steps of 15 min; 1500 ms late."),
            (r#"{"bands":[0.0,50.0,80.0]}"#, Some("%"), "In bands from 0, 50, 80 %."),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            assert_eq!(policy.statement(unit).description, text);
            assert_eq!(serde_json::to_string(&policy).expect("serialises"), json);
        }
    }

    #[test]
    fn faults_name_the_member() {
        for (json, field_type, members) in [
            (r#"{"roundingStep":0.5}"#, BuiltInType::Double, vec![]),
            (r#"{"roundingStep":0.5}"#, BuiltInType::Int32, vec!["roundingStep"]),
            (r#"{"roundingStep":5}"#, BuiltInType::String, vec!["roundingStep"]),
            (r#"{"bands":[5,1]}"#, BuiltInType::Double, vec!["bands"]),
            (r#"{"minimumIntervalMs":0,"delayMs":0}"#, BuiltInType::String, vec!["minimumIntervalMs", "delayMs"]),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            let found: Vec<&str> = policy.faults(field_type).iter().map(|fault| fault.member).collect();
            assert_eq!(found, members, "{json}");
        }
        assert!(serde_json::from_str::<DisclosurePolicy>(r#"{"roundingstep":5}"#).is_err());
    }
}
