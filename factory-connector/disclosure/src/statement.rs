//! Statement of a policy: the precision as published to the partner.

mod part;
mod words;

use asi_model::messages::{
    AggregateStatement, DisclosureStatement, RateStatement, StatusResolution,
};
pub use part::StatementPart;
use serde::Serialize;
pub(super) use words::describe_period;
use words::sentence;

use super::{DisclosurePolicy, Language, StatusCodes, WorkingHours};

/// A precision as published to the partner.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Statement {
    /// The English sentence that the partner gets.
    pub statement: String,
    /// The same as codes with parameters.
    pub statement_parts: Vec<StatementPart>,
}

impl Statement {
    /// Describes a policy; `unit` is the field's.
    #[must_use]
    pub fn of(policy: &DisclosurePolicy, unit: Option<&str>) -> Self {
        let parts = StatementPart::all_of(policy, unit);
        Self { statement: sentence(&parts, Language::En), statement_parts: parts }
    }

    /// Returns the sentence in a language.
    #[must_use]
    pub fn in_language(&self, language: Language) -> String {
        match language {
            Language::En => self.statement.clone(),
            Language::De => sentence(&self.statement_parts, language),
        }
    }
}

/// Returns the statement of a policy for the message to the partner.
#[must_use]
pub fn disclosure_statement(policy: &DisclosurePolicy, unit: Option<&str>) -> DisclosureStatement {
    DisclosureStatement {
        description: sentence(&StatementPart::all_of(policy, unit), Language::En),
        rounding_step: policy.rounding_step.map(|step| step.decimal().to_f64()),
        significant_digits: policy.significant_digits,
        aggregate: policy.aggregate.map(|aggregate| AggregateStatement {
            function: aggregate.function.describe().to_owned(),
            window_ms: aggregate.window_ms,
        }),
        minimum_interval_ms: policy.minimum_interval_ms,
        rate_limit_list: policy
            .rate_limits
            .iter()
            .map(|limit| RateStatement { values: limit.values, period_ms: limit.period_ms })
            .collect(),
        time_step_ms: policy.time_step_ms,
        delay_ms: policy.delay_ms,
        band_list: policy.bands.clone(),
        hours_list: policy.hours().map(WorkingHours::statement).collect(),
        is_withheld_in_states: !policy.withhold_while.is_empty(),
        status_codes: match policy.status_codes {
            StatusCodes::Full => Some(StatusResolution::Full),
            StatusCodes::Common => None,
            StatusCodes::Severity => Some(StatusResolution::Severity),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_describes_the_precision() {
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
            (
                r#"{"roundingStep":5,"statusCodes":"SEVERITY"}"#,
                None,
                "Rounded to multiples of 5; of status codes only good, uncertain or bad.",
            ),
            (r#"{"statusCodes":"FULL"}"#, None, "With every status code as it is."),
        ] {
            let policy: DisclosurePolicy = serde_json::from_str(json).expect("a policy");
            assert_eq!(disclosure_statement(&policy, unit).description, text);
            assert_eq!(serde_json::to_string(&policy).expect("serialises"), json);
        }
    }

    #[test]
    fn a_statement_has_codes_and_a_german_text() {
        let policy: DisclosurePolicy = serde_json::from_str(
            r#"{"roundingStep":10,"bands":[0.5,50.0],"significantDigits":2,"aggregate":{"function":"MEAN","windowMs":3600000},
            "minimumIntervalMs":60000,"rateLimits":[{"values":3,"periodMs":3600000}],"timeStepMs":1000,"delayMs":5,
            "workingHours":{"days":["MONDAY"],"from":"06:00","until":"22:00"},"withholdWhile":[{"states":["SETUP"]}],"statusCodes":"SEVERITY"}"#,
        )
        .expect("a policy");
        let stated = Statement::of(&policy, Some("PIECE"));
        let statement = disclosure_statement(&policy, Some("PIECE"));
        assert_eq!(stated.statement, statement.description);
        let hours = &statement.hours_list[0];
        assert_eq!(hours.day_list[0], "MONDAY");
        assert_eq!(hours.from, "06:00");
        assert_eq!(hours.until, "22:00");
        assert_eq!((statement.band_list, statement.is_withheld_in_states), (vec![0.5, 50.0], true));
        assert_eq!(statement.status_codes, Some(StatusResolution::Severity));
        assert_eq!(
            stated.in_language(Language::De),
            "Ein Wert je 1 h: zeitlicher Mittelwert; gerundet auf Vielfache von 10 PIECE; in Bändern ab 0,5; 50 PIECE; mit 2 \
             gültigen Ziffern; höchstens einmal je 1 min; höchstens 3 Werte je 1 h; Zeiten in Schritten von 1 s; 5 ms \
             später; nur Mo von 06:00 bis 22:00; in bestimmten Zuständen zurückgehalten; von Statuscodes nur gut, \
             unsicher oder schlecht."
        );
        let parts = serde_json::to_value(&stated.statement_parts).expect("serialises");
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
            { "code": "STATUS_CODES", "resolution": "SEVERITY" },
        ]);
        assert_eq!(parts, expected);
        assert_eq!(
            StatementPart::all_of(&DisclosurePolicy::default(), None),
            [StatementPart::Unchanged]
        );
    }
}
