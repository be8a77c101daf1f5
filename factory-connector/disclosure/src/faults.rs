//! Faults for which a policy cannot be applied to a field.

use asi_model::{BuiltInType, DateTime};

use super::{
    AggregateFunction, DisclosurePolicy, StateValue,
    coarsening::holds_numbers,
    policy::PERIOD_MS_MAX,
    rate::{LIMITS_MAX, VALUES_MAX},
    withholding::{CONDITIONS_MAX, STATE_CHARS_MAX, STATES_MAX},
};

/// Fault of a policy for a field.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{member}: {message}")]
pub struct PolicyFault {
    /// The member of the policy, as in JSON.
    pub member: &'static str,
    /// The fault and its remedy.
    pub message: String,
}

/// Most bounds that bands may have.
const BANDS_MAX: usize = 64;
/// Most hours beside the working hours.
const FURTHER_HOURS_MAX: usize = 8;
/// Most digits that every number of 64 bits can represent.
pub(super) const DIGITS_MAX: u8 = 15;

struct Faults(Vec<PolicyFault>);

impl Faults {
    fn add(&mut self, member: &'static str, message: impl Into<String>) {
        self.0.push(PolicyFault { member, message: message.into() });
    }

    fn unless(&mut self, is_valid: bool, member: &'static str, message: &str) {
        if !is_valid {
            self.add(member, message);
        }
    }
}

impl DisclosurePolicy {
    /// Returns all faults for which this policy cannot be applied to a field of this type, a single
    /// value or an array.
    #[must_use]
    pub fn faults(&self, field_type: BuiltInType, is_array: bool) -> Vec<PolicyFault> {
        let mut faults = self.own_faults();
        let mut found = Faults(Vec::new());
        if let Some(step) = self.rounding_step {
            if !holds_numbers(field_type) {
                found.add(
                    "roundingStep",
                    format!("only numbers can be rounded, and this field is a {field_type}"),
                );
            } else if field_type.is_integer() && step.to_integer().is_none() {
                found.add(
                    "roundingStep",
                    format!("{step} is not a whole number, as a {field_type} needs"),
                );
            }
        }
        if !self.bands.is_empty() && !holds_numbers(field_type) {
            found.add(
                "bands",
                format!("only numbers can be put into bands, and this field is a {field_type}"),
            );
        }
        if field_type.is_integer() && self.bands.iter().any(|b| b.fract() != 0.0 || b.abs() > 9e15)
        {
            found
                .add("bands", format!("the bounds must be whole numbers, as a {field_type} needs"));
        }
        if self.significant_digits.is_some() && !holds_numbers(field_type) {
            found.add(
                "significantDigits",
                format!("only numbers have digits, and this field is a {field_type}"),
            );
        }
        if let Some(aggregate) =
            self.aggregate.filter(|aggregate| aggregate.function != AggregateFunction::Last)
        {
            let what = aggregate.function.describe();
            if is_array {
                found.add(
                    "aggregate",
                    format!("{what} is made of single values, and this field is an array"),
                );
            } else if !field_type.is_numeric() {
                found.add(
                    "aggregate",
                    format!("{what} is made of numbers, and this field is a {field_type}"),
                );
            }
        }
        for condition in self.withhold_while.iter().filter(|condition| condition.field.is_none()) {
            if !condition.states.is_empty() && !condition.fits(field_type) {
                found.add(
                    "withholdWhile",
                    format!("none of these states is one of a {field_type}, as this field is"),
                );
            }
        }
        faults.append(&mut found.0);
        faults
    }

    /// Returns all faults of this policy for any field.
    #[must_use]
    pub fn own_faults(&self) -> Vec<PolicyFault> {
        let mut faults = Faults(Vec::new());
        let is_ascending = self.bands.iter().all(|bound| bound.is_finite())
            && self.bands.windows(2).all(|w| w[0] < w[1]);
        faults.unless(
            is_ascending,
            "bands",
            "the bounds must be finite numbers in ascending order",
        );
        faults.unless(self.bands.len() <= BANDS_MAX, "bands", "at most 64 bounds are possible");
        let is_one = self.bands.is_empty() || self.rounding_step.is_none();
        faults.unless(is_one, "bands", "bands and a rounding step exclude each other; choose one");
        let has_digits =
            self.significant_digits.is_none_or(|digits| (1..=DIGITS_MAX).contains(&digits));
        faults.unless(has_digits, "significantDigits", "must lie between 1 and 15");
        for (member, period) in [
            ("minimumIntervalMs", self.minimum_interval_ms),
            ("timeStepMs", self.time_step_ms),
            ("delayMs", self.delay_ms),
            ("aggregate", self.aggregate.map(|aggregate| aggregate.window_ms)),
        ] {
            if period.is_some_and(|ms| ms == 0 || ms > PERIOD_MS_MAX) {
                faults.add(member, format!("must lie between 1 and {PERIOD_MS_MAX} ms"));
            }
        }
        self.rate_faults(&mut faults);
        self.hours_faults(&mut faults);
        self.withholding_faults(&mut faults);
        faults.0
    }

    fn rate_faults(&self, faults: &mut Faults) {
        faults.unless(
            self.rate_limits.len() <= LIMITS_MAX,
            "rateLimits",
            "at most 4 limits are possible",
        );
        for limit in &self.rate_limits {
            let (values, period) = (1..=VALUES_MAX, 1..=PERIOD_MS_MAX);
            if !values.contains(&limit.values) || !period.contains(&limit.period_ms) {
                faults.add(
                    "rateLimits",
                    format!("1 to {VALUES_MAX} values per 1 to {PERIOD_MS_MAX} ms are possible"),
                );
            }
        }
    }

    fn hours_faults(&self, faults: &mut Faults) {
        let has_room = self.further_hours.len() <= FURTHER_HOURS_MAX;
        faults.unless(has_room, "furtherHours", "at most 8 further hours are possible");
        let mut are_valid = true;
        for hours in self.hours() {
            if hours.days.is_empty() || hours.from >= hours.until {
                faults.add("workingHours", "needs at least one day, and must begin before it ends");
                are_valid = false;
            }
            if hours.utc_offset_minutes.abs() > 14 * 60 {
                faults.add(
                    "workingHours",
                    "no place on earth is more than 14 hours ahead of or behind UTC",
                );
            }
        }
        if are_valid && self.has_hours() && self.first_slot(DateTime::from_unix_micros(0)).is_none()
        {
            faults.add(
                "workingHours",
                "no instant lies within all hours and on the time step: nothing would ever leave",
            );
        }
    }

    fn withholding_faults(&self, faults: &mut Faults) {
        let member = "withholdWhile";
        faults.unless(
            self.withhold_while.len() <= CONDITIONS_MAX,
            member,
            "at most 8 conditions are possible",
        );
        for condition in &self.withhold_while {
            let count = condition.states.len();
            faults.unless(
                (1..=STATES_MAX).contains(&count),
                member,
                "a condition lists 1 to 32 states",
            );
            let are_valid = condition.states.iter().all(|state| match state {
                StateValue::Text(text) => text.chars().count() <= STATE_CHARS_MAX,
                StateValue::Number(number) => number.is_finite(),
                StateValue::Truth(_) | StateValue::Integer(_) => true,
            });
            faults.unless(
                are_valid,
                member,
                "a state is a finite number or a text of at most 256 characters",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_name_the_member() {
        for (json, field_type, members) in [
            (r#"{"roundingStep":0.5}"#, BuiltInType::Double, vec![]),
            (r#"{"roundingStep":0.5}"#, BuiltInType::Int32, vec!["roundingStep"]),
            (r#"{"roundingStep":5}"#, BuiltInType::String, vec!["roundingStep"]),
            (r#"{"bands":[5,1]}"#, BuiltInType::Double, vec!["bands"]),
            (
                r#"{"minimumIntervalMs":0,"delayMs":0}"#,
                BuiltInType::String,
                vec!["minimumIntervalMs", "delayMs"],
            ),
            (r#"{"significantDigits":0}"#, BuiltInType::Double, vec!["significantDigits"]),
            (r#"{"significantDigits":3}"#, BuiltInType::Boolean, vec!["significantDigits"]),
            (
                r#"{"aggregate":{"function":"MEAN","windowMs":1000}}"#,
                BuiltInType::String,
                vec!["aggregate"],
            ),
            (r#"{"aggregate":{"function":"LAST","windowMs":1000}}"#, BuiltInType::String, vec![]),
            (
                r#"{"aggregate":{"function":"LAST","windowMs":0}}"#,
                BuiltInType::String,
                vec!["aggregate"],
            ),
            (
                r#"{"rateLimits":[{"values":0,"periodMs":1}]}"#,
                BuiltInType::String,
                vec!["rateLimits"],
            ),
            (r#"{"withholdWhile":[{"states":[]}]}"#, BuiltInType::String, vec!["withholdWhile"]),
            (r#"{"withholdWhile":[{"states":[7]}]}"#, BuiltInType::String, vec!["withholdWhile"]),
            (r#"{"withholdWhile":[{"states":[7]}]}"#, BuiltInType::Variant, vec![]),
            (r#"{"withholdWhile":[{"states":["7"]}]}"#, BuiltInType::Int32, vec![]),
            (r#"{"withholdWhile":[{"states":["A"]}]}"#, BuiltInType::Guid, vec!["withholdWhile"]),
            // A step of a day is at midnight, which is outside of the hours.
            (
                r#"{"timeStepMs":86400000,"workingHours":{"days":["MONDAY"],"from":"06:00","until":"22:00"}}"#,
                BuiltInType::String,
                vec!["workingHours"],
            ),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            let found: Vec<&str> =
                policy.faults(field_type, false).iter().map(|fault| fault.member).collect();
            assert_eq!(found, members, "{json}");
        }
        assert!(serde_json::from_str::<DisclosurePolicy>(r#"{"roundingstep":5}"#).is_err());
        let mean: DisclosurePolicy =
            serde_json::from_str(r#"{"aggregate":{"function":"MEAN","windowMs":1000}}"#)
                .expect("a policy");
        assert_eq!(mean.faults(BuiltInType::Double, true).len(), 1, "arrays have no mean");
    }
}
