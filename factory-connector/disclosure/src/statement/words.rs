//! Sentences for a precision: English for the partner, German for people in the plant.

use super::part::StatementPart;
use crate::{AggregateFunction, Language, StatusCodes, working_hours::Weekday};

/// Joins parts to one sentence.
pub(super) fn sentence(parts: &[StatementPart], language: Language) -> String {
    let describe = match language {
        Language::En => in_english,
        Language::De => in_german,
    };
    let parts: Vec<String> = parts.iter().map(describe).collect();
    let mut text = parts.join("; ");
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text.push('.');
    text
}

fn in_english(part: &StatementPart) -> String {
    match part {
        StatementPart::Unchanged => "every change, as it is".to_owned(),
        StatementPart::Aggregated { function, window_ms } => {
            format!("{} per {}", function.describe(), describe_period(*window_ms))
        }
        StatementPart::Rounded { step, unit } => {
            format!("rounded to multiples of {step}{}", of(unit))
        }
        StatementPart::Banded { bounds, unit } => {
            let bounds: Vec<String> = bounds.iter().map(f64::to_string).collect();
            format!("in bands from {}{}", bounds.join(", "), of(unit))
        }
        StatementPart::Digits { digits } => {
            format!("with {digits} significant digit{}", if *digits == 1 { "" } else { "s" })
        }
        StatementPart::Interval { period_ms } => {
            format!("at most once per {}", describe_period(*period_ms))
        }
        StatementPart::Rate { values, period_ms } => {
            let plural = if *values == 1 { "" } else { "s" };
            format!("at most {values} value{plural} per {}", describe_period(*period_ms))
        }
        StatementPart::TimeStep { period_ms } => {
            format!("times in steps of {}", describe_period(*period_ms))
        }
        StatementPart::Delayed { period_ms } => format!("{} late", describe_period(*period_ms)),
        StatementPart::Hours { hours } => hours.describe(),
        StatementPart::Withheld => "withheld in certain states".to_owned(),
        StatementPart::StatusCodes { resolution } => match resolution {
            StatusCodes::Full => "with every status code as it is",
            StatusCodes::Common => "with the common status codes",
            StatusCodes::Severity => "of status codes only good, uncertain or bad",
        }
        .to_owned(),
    }
}

fn in_german(part: &StatementPart) -> String {
    let number = |number: &dyn ToString| number.to_string().replace('.', ",");
    match part {
        StatementPart::Unchanged => "jede Änderung, wie sie ist".to_owned(),
        StatementPart::Aggregated { function, window_ms } => {
            let made = match function {
                AggregateFunction::Last => "letzter Wert",
                AggregateFunction::Maximum => "Maximum",
                AggregateFunction::Minimum => "Minimum",
                AggregateFunction::Sum => "Summe",
                AggregateFunction::Mean => "zeitlicher Mittelwert",
            };
            format!("ein Wert je {}: {made}", describe_period(*window_ms))
        }
        StatementPart::Rounded { step, unit } => {
            format!("gerundet auf Vielfache von {}{}", number(step), of(unit))
        }
        StatementPart::Banded { bounds, unit } => {
            let bounds: Vec<String> = bounds.iter().map(|bound| number(bound)).collect();
            format!("in Bändern ab {}{}", bounds.join("; "), of(unit))
        }
        StatementPart::Digits { digits: 1 } => "mit 1 gültigen Ziffer".to_owned(),
        StatementPart::Digits { digits } => format!("mit {digits} gültigen Ziffern"),
        StatementPart::Interval { period_ms } => {
            format!("höchstens einmal je {}", describe_period(*period_ms))
        }
        StatementPart::Rate { values: 1, period_ms } => {
            format!("höchstens 1 Wert je {}", describe_period(*period_ms))
        }
        StatementPart::Rate { values, period_ms } => {
            format!("höchstens {values} Werte je {}", describe_period(*period_ms))
        }
        StatementPart::TimeStep { period_ms } => {
            format!("Zeiten in Schritten von {}", describe_period(*period_ms))
        }
        StatementPart::Delayed { period_ms } => format!("{} später", describe_period(*period_ms)),
        StatementPart::Hours { hours } => {
            let days: Vec<&str> = hours.days.iter().copied().map(german).collect();
            format!("nur {} von {} bis {}", days.join(", "), hours.from, hours.until)
        }
        StatementPart::Withheld => "in bestimmten Zuständen zurückgehalten".to_owned(),
        StatementPart::StatusCodes { resolution } => match resolution {
            StatusCodes::Full => "mit jedem Statuscode, wie er ist",
            StatusCodes::Common => "mit den üblichen Statuscodes",
            StatusCodes::Severity => "von Statuscodes nur gut, unsicher oder schlecht",
        }
        .to_owned(),
    }
}

const fn german(day: Weekday) -> &'static str {
    match day {
        Weekday::Monday => "Mo",
        Weekday::Tuesday => "Di",
        Weekday::Wednesday => "Mi",
        Weekday::Thursday => "Do",
        Weekday::Friday => "Fr",
        Weekday::Saturday => "Sa",
        Weekday::Sunday => "So",
    }
}

fn of(unit: &Option<String>) -> String {
    unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default()
}

/// Formats a period with the largest unit that divides it.
pub(crate) fn describe_period(ms: u64) -> String {
    for (length, name) in [(86_400_000, "d"), (3_600_000, "h"), (60_000, "min"), (1_000, "s")] {
        if ms.is_multiple_of(length) {
            return format!("{} {name}", ms / length);
        }
    }
    format!("{ms} ms")
}
