//! Comparison of a shown report with the one that left.

use asi_model::plain_value::ReportedValue;
use serde_json::Value;

use super::export::ShownReport;
use crate::left::{QueuedReport, ReportContent};

/// Lists what differs, each as a sentence without a full stop.
pub(super) fn differences(shown: &ShownReport, left: &QueuedReport) -> Vec<String> {
    match &left.content {
        Some(content) => of_content(shown, content),
        None => of_names(shown, left),
    }
}

/// Compares with a report whose values were emptied: its entry still has the names of the fields.
fn of_names(shown: &ShownReport, left: &QueuedReport) -> Vec<String> {
    let names = shown.fields.keys().filter(|name| !left.consents.contains_key(name.as_str()));
    names.map(|name| not_left(name)).collect()
}

fn of_content(shown: &ShownReport, left: &ReportContent) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |what: &str, is_same: bool| {
        if !is_same {
            found.push(format!("{what} is not the one that left"));
        }
    };
    compare("the request", shown.request == left.request);
    compare("the name of the report", shown.report_name == left.report_name);
    compare("the time of the values", shown.shopfloor_timestamp == left.shopfloor_timestamp);
    compare("the time of the report", shown.report_timestamp == left.report_timestamp);
    for (name, value) in &shown.fields {
        let Some(left) = left.fields.get(name) else {
            found.push(not_left(name));
            continue;
        };
        found.extend(of_values(name, value, left));
    }
    let hidden = left.fields.keys().filter(|name| !shown.fields.contains_key(name.as_str()));
    found.extend(hidden.map(|name| format!("the field {name} left and was not shown")));
    found
}

fn of_values(name: &str, shown: &ReportedValue, left: &ReportedValue) -> Option<String> {
    let differing = [
        ("value", !is_same(&shown.value, &left.value)),
        ("status", shown.status != left.status),
        ("time", shown.source_timestamp != left.source_timestamp),
    ];
    let differing: Vec<&str> =
        differing.into_iter().filter(|(_, differs)| *differs).map(|(what, _)| what).collect();
    (!differing.is_empty())
        .then(|| format!("of the field {name} {} not as it left", differing.join(", ") + " is"))
}

fn not_left(name: &str) -> String {
    format!("the field {name} was shown and did not leave in this report")
}

/// Compares plain values. One encoding of the wire has no types: there a number that is shown as a
/// text left as a number, or the other way round.
fn is_same(shown: &Value, left: &Value) -> bool {
    match (shown, left) {
        (Value::Number(number), Value::String(text))
        | (Value::String(text), Value::Number(number)) => number.to_string() == *text,
        (Value::Number(shown), Value::Number(left)) => {
            shown == left
                || (shown.is_f64() || left.is_f64())
                    && shown.as_f64().zip(left.as_f64()).is_some_and(|(one, other)| one == other)
        }
        (Value::Array(shown), Value::Array(left)) => {
            shown.len() == left.len()
                && shown.iter().zip(left).all(|(shown, left)| is_same(shown, left))
        }
        (shown, left) => shown == left,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_are_the_same_with_and_without_their_types() {
        for (shown, left, expected) in [
            (json!("12"), json!(12), true),
            (json!(12), json!("12"), true),
            (json!(1.0), json!(1), true),
            (json!([1, "2"]), json!(["1", 2]), true),
            (json!("12"), json!(13), false),
            (json!(9_007_199_254_740_993_u64), json!(9_007_199_254_740_992_u64), false),
            (json!(null), json!(0), false),
            (json!([1]), json!([1, 2]), false),
            (json!(true), json!("true"), false),
        ] {
            assert_eq!(is_same(&shown, &left), expected, "{shown} and {left}");
        }
    }
}
