//! What the partner is told about the precision it gets.

use asi_model::messages::{AggregateStatement, DisclosureStatement, RateStatement};

use super::DisclosurePolicy;

impl DisclosurePolicy {
    /// What the partner is told about its precision.
    #[must_use]
    pub fn statement(&self, unit: Option<&str>) -> DisclosureStatement {
        DisclosureStatement {
            description: self.describe(unit),
            rounding_step: self.rounding_step.map(|step| step.decimal().to_f64()),
            significant_digits: self.significant_digits,
            aggregate: self.aggregate.map(|aggregate| AggregateStatement {
                function: aggregate.function.describe().to_owned(),
                window_ms: aggregate.window_ms,
            }),
            minimum_interval_ms: self.minimum_interval_ms,
            rate_limit_list: self
                .rate_limits
                .iter()
                .map(|limit| RateStatement { values: limit.values, period_ms: limit.period_ms })
                .collect(),
            time_step_ms: self.time_step_ms,
            delay_ms: self.delay_ms,
        }
    }

    fn describe(&self, unit: Option<&str>) -> String {
        let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
        let mut parts = Vec::new();
        if let Some(aggregate) = self.aggregate {
            parts.push(format!("{} per {}", aggregate.function.describe(), describe_period(aggregate.window_ms)));
        }
        if let Some(step) = self.rounding_step {
            parts.push(format!("rounded to multiples of {step}{unit}"));
        }
        if !self.bands.is_empty() {
            let bounds: Vec<String> = self.bands.iter().map(f64::to_string).collect();
            parts.push(format!("in bands from {}{unit}", bounds.join(", ")));
        }
        if let Some(digits) = self.significant_digits {
            parts.push(format!("with {digits} significant digit{}", if digits == 1 { "" } else { "s" }));
        }
        if let Some(ms) = self.minimum_interval_ms {
            parts.push(format!("at most once per {}", describe_period(ms)));
        }
        for limit in &self.rate_limits {
            parts.push(format!("at most {} values per {}", limit.values, describe_period(limit.period_ms)));
        }
        if let Some(ms) = self.time_step_ms {
            parts.push(format!("times in steps of {}", describe_period(ms)));
        }
        if let Some(ms) = self.delay_ms {
            parts.push(format!("{} late", describe_period(ms)));
        }
        parts.extend(self.hours().map(super::WorkingHours::describe));
        if !self.withhold_while.is_empty() {
            // Which states these are is the plant's business.
            parts.push("withheld in certain states".to_owned());
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

/// A period with the largest unit that divides it.
pub(super) fn describe_period(ms: u64) -> String {
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
            (
                r#"{"significantDigits":2,"aggregate":{"function":"MEAN","windowMs":3600000}}"#,
                None,
                "The mean over time per 1 h; with 2 significant digits.",
            ),
            (
                r#"{"rateLimits":[{"values":3,"periodMs":3600000}],"withholdWhile":[{"field":"state","states":["SETUP"]}]}"#,
                None,
                "At most 3 values per 1 h; withheld in certain states.",
            ),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            assert_eq!(policy.statement(unit).description, text);
            assert_eq!(serde_json::to_string(&policy).expect("serialises"), json);
        }
    }
}
