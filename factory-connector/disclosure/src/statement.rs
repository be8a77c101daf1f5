//! What the partner is told about the precision it gets.

mod words;

use asi_model::messages::{AggregateStatement, DisclosureStatement, RateStatement};
use serde::Serialize;

pub(super) use words::describe_period;
use words::sentence;

use super::{
    AggregateFunction, DisclosurePolicy, Language, RateLimit, RoundingStep, WindowAggregate,
    WorkingHours,
};

/// A part of a policy as the partner is told it: a code with its parameters, for who says it in
/// another language.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(tag = "code", rename_all = "SCREAMING_SNAKE_CASE")]
pub enum StatementPart {
    /// Every change, as it is: the only part of an open policy.
    Unchanged,
    /// One value per window.
    Aggregated {
        /// What is made of a window's values.
        function: AggregateFunction,
        /// Its length in milliseconds.
        #[serde(rename = "windowMs")]
        window_ms: u64,
    },
    /// The nearest multiple of a step.
    Rounded {
        /// The step.
        #[schema(value_type = f64)]
        step: RoundingStep,
        /// The field's unit.
        unit: Option<String>,
    },
    /// The greatest bound not above the value.
    Banded {
        /// The bounds, ascending.
        bounds: Vec<f64>,
        /// The field's unit.
        unit: Option<String>,
    },
    /// Few significant digits.
    Digits {
        /// How many.
        digits: u8,
    },
    /// At most one value per interval.
    Interval {
        /// The interval in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// At most so many values per period.
    Rate {
        /// How many.
        values: u32,
        /// The period in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Times in steps.
    TimeStep {
        /// The step in milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Late.
    Delayed {
        /// By so many milliseconds.
        #[serde(rename = "periodMs")]
        period_ms: u64,
    },
    /// Within certain hours only.
    Hours {
        /// The hours.
        hours: WorkingHours,
    },
    /// Nothing in certain states. Which these are is the plant's business.
    Withheld,
}

/// A precision as the partner is told it.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Statement {
    /// In words: the English sentence that the partner gets.
    pub statement: String,
    /// The same as codes with parameters.
    pub statement_parts: Vec<StatementPart>,
}

impl Statement {
    /// In words of a language.
    #[must_use]
    pub fn said_in(&self, language: Language) -> String {
        match language {
            Language::En => self.statement.clone(),
            Language::De => sentence(&self.statement_parts, language),
        }
    }
}

impl DisclosurePolicy {
    /// What the partner is told about its precision.
    #[must_use]
    pub fn statement(&self, unit: Option<&str>) -> DisclosureStatement {
        DisclosureStatement {
            description: sentence(&self.parts(unit), Language::En),
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
            band_list: self.bands.clone(),
            hours_list: self.hours().map(WorkingHours::statement).collect(),
            is_withheld_in_states: !self.withhold_while.is_empty(),
        }
    }

    /// The same for pages.
    #[must_use]
    pub fn told(&self, unit: Option<&str>) -> Statement {
        let parts = self.parts(unit);
        Statement { statement: sentence(&parts, Language::En), statement_parts: parts }
    }

    /// The same as codes with parameters.
    #[must_use]
    pub fn parts(&self, unit: Option<&str>) -> Vec<StatementPart> {
        let unit = || unit.map(str::to_owned);
        let mut parts = Vec::new();
        let aggregated = |of: WindowAggregate| StatementPart::Aggregated {
            function: of.function,
            window_ms: of.window_ms,
        };
        parts.extend(self.aggregate.map(aggregated));
        parts.extend(self.rounding_step.map(|step| StatementPart::Rounded { step, unit: unit() }));
        if !self.bands.is_empty() {
            parts.push(StatementPart::Banded { bounds: self.bands.clone(), unit: unit() });
        }
        parts.extend(self.significant_digits.map(|digits| StatementPart::Digits { digits }));
        parts.extend(
            self.minimum_interval_ms.map(|period_ms| StatementPart::Interval { period_ms }),
        );
        let rate = |limit: &RateLimit| StatementPart::Rate {
            values: limit.values,
            period_ms: limit.period_ms,
        };
        parts.extend(self.rate_limits.iter().map(rate));
        parts.extend(self.time_step_ms.map(|period_ms| StatementPart::TimeStep { period_ms }));
        parts.extend(self.delay_ms.map(|period_ms| StatementPart::Delayed { period_ms }));
        parts.extend(self.hours().map(|hours| StatementPart::Hours { hours: hours.clone() }));
        if !self.withhold_while.is_empty() {
            parts.push(StatementPart::Withheld);
        }
        if parts.is_empty() {
            parts.push(StatementPart::Unchanged);
        }
        parts
    }
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
            (
                r#"{"timeStepMs":900000,"delayMs":1500}"#,
                None,
                "Times in steps of 15 min; 1500 ms late.",
            ),
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

    #[test]
    fn the_same_is_said_as_codes_and_in_german() {
        let policy: DisclosurePolicy = serde_json::from_str(
            r#"{"roundingStep":10,"bands":[0.5,50.0],"significantDigits":2,"aggregate":{"function":"MEAN","windowMs":3600000},
            "minimumIntervalMs":60000,"rateLimits":[{"values":3,"periodMs":3600000}],"timeStepMs":1000,"delayMs":5,
            "workingHours":{"days":["MONDAY"],"from":"06:00","until":"22:00"},"withholdWhile":[{"states":["SETUP"]}]}"#,
        )
        .expect("a policy");
        let told = policy.told(Some("PIECE"));
        let statement = policy.statement(Some("PIECE"));
        assert_eq!(told.statement, statement.description);
        let hours = &statement.hours_list[0];
        assert_eq!(
            (&hours.day_list[0][..], &hours.from[..], &hours.until[..]),
            ("MONDAY", "06:00", "22:00")
        );
        assert_eq!((statement.band_list, statement.is_withheld_in_states), (vec![0.5, 50.0], true));
        assert_eq!(
            told.said_in(Language::De),
            "Ein Wert je 1 h: zeitlicher Mittelwert; gerundet auf Vielfache von 10 PIECE; in Bändern ab 0,5; 50 PIECE; mit 2 \
             gültigen Ziffern; höchstens einmal je 1 min; höchstens 3 Werte je 1 h; Zeiten in Schritten von 1 s; 5 ms \
             später; nur Mo von 06:00 bis 22:00; in bestimmten Zuständen zurückgehalten."
        );
        let parts = serde_json::to_value(&told.statement_parts).expect("serialises");
        let expected = serde_json::json!([
            { "code": "AGGREGATED", "function": "MEAN", "windowMs": 3_600_000 },
            { "code": "ROUNDED", "step": 10, "unit": "PIECE" },
            { "code": "BANDED", "bounds": [0.5, 50.0], "unit": "PIECE" },
            { "code": "DIGITS", "digits": 2 },
            { "code": "INTERVAL", "periodMs": 60_000 },
            { "code": "RATE", "values": 3, "periodMs": 3_600_000 },
            { "code": "TIME_STEP", "periodMs": 1000 },
            { "code": "DELAYED", "periodMs": 5 },
            { "code": "HOURS", "hours": { "days": ["MONDAY"], "from": "06:00", "until": "22:00", "utcOffsetMinutes": 0 } },
            { "code": "WITHHELD" },
        ]);
        assert_eq!(parts, expected);
        assert_eq!(DisclosurePolicy::default().parts(None), [StatementPart::Unchanged]);
    }
}
