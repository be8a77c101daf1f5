//! Figures: printed as they are found, and returned as JSON.

use std::time::Duration;

use serde_json::{Value, json};

use super::goals;
use crate::harness::say;

/// Prints a figure with its goal and returns it.
pub(super) fn result(name: &str, value: f64, unit: &str) -> Value {
    let digits = if value.abs() < 10.0 { 2 } else { 1 };
    say(&format!("  {name}: {value:.digits$} {unit}{}", goals::beside(name, value, unit)));
    json!({ "name": name, "value": value, "unit": unit })
}

/// Prints and returns a distribution: median, 90 %, 99 % and the slowest.
pub(super) fn distribution(name: &str, mut latencies: Vec<Duration>) -> Vec<Value> {
    latencies.sort_unstable();
    let at = |share: usize| latencies[(latencies.len() - 1) * share / 100].as_secs_f64() * 1000.0;
    [("median", 50), ("90 %", 90), ("99 %", 99), ("slowest", 100)]
        .into_iter()
        .map(|(what, share)| {
            result(&format!("{name}, {what} of {}", latencies.len()), at(share), "ms")
        })
        .collect()
}

/// Makes one figure for the calling program.
pub(super) fn figure(name: &str, value: f64, unit: &str) -> Value {
    json!({ "name": name, "value": value, "unit": unit })
}

/// Makes figures of a distribution at these shares in percent.
pub(super) fn figures(name: &str, mut latencies: Vec<Duration>) -> Vec<Value> {
    latencies.sort_unstable();
    let at = |share: usize| latencies[(latencies.len() - 1) * share / 100].as_secs_f64() * 1000.0;
    [("median", 50), ("99 %", 99), ("slowest", 100)]
        .into_iter()
        .map(|(what, share)| {
            figure(&format!("{name}, {what} of {}", latencies.len()), at(share), "ms")
        })
        .collect()
}
