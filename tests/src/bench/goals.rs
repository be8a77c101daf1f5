//! Goals of the figures: what each must reach, and the other side of each ratio.

use serde_json::{Value, json};

/// Bound of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    AtLeast(f64),
    AtMost(f64),
}

/// Goal of a figure.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// Name of the figure; one `*` stands for any text.
    pub figure: &'static str,
    /// Unit of the figure: one name may be measured in several.
    pub unit: &'static str,
    pub bound: Bound,
    /// Name of the figure that a ratio is against, with the text that `*` stood for.
    pub against: Option<&'static str>,
}

const fn at_least(figure: &'static str, value: f64, unit: &'static str) -> Goal {
    Goal { figure, unit, bound: Bound::AtLeast(value), against: None }
}

const fn at_most(figure: &'static str, value: f64, unit: &'static str) -> Goal {
    Goal { figure, unit, bound: Bound::AtMost(value), against: None }
}

impl Goal {
    const fn against(self, other: &'static str) -> Self {
        Self { against: Some(other), ..self }
    }
}

/// All goals, in the order of the figures. Figures without a goal are context.
pub const GOALS: &[Goal] = &[
    at_most("value changed on the machine -> on the buyer's live stream, median of *", 150.0, "ms"),
    at_most("request sent -> nodes browsable in the twin, slowest of *", 200.0, "ms"),
    at_least("drain rate after an outage against the live rate", 1.0, "times")
        .against("reports stored by the platform"),
    at_most("twin: memory of a field, its document included, 100 000 fields", 2_500.0, "bytes"),
    at_most("twin: 100 000 fields parsed and shown again after a restart", 5.0, "s"),
    at_most(
        "connector: start with 100 000 fields in 10 000 networks, until all are shown",
        5.0,
        "s",
    ),
    at_most("twin: reads meanwhile that took over 20 ms", 0.0, "reads"),
    at_most("twin: browsing an interface among 10 000 against among 10", 1.5, "times")
        .against("twin: browsing an interface among 10, median"),
    at_most("twin: change to notification at 10 ms publishing, median of *", 15.0, "ms"),
    at_most("twin: of these lost", 0.0, "changes"),
    at_most("twin: of these out of order", 0.0, "changes"),
    at_least("built-in mappings into report fields", 100_000.0, "changes per second")
        .against("bare subscription"),
    at_least("JavaScript mappings into report fields", 50_000.0, "changes per second")
        .against("bare subscription"),
    at_most("memory per JavaScript mapping, its worker's included", 250_000.0, "bytes"),
    at_least("built-in mappings against node-opcua", 4.0, "times the values per CPU second")
        .against("the same with node-opcua"),
    at_most("50 000 built-in mappings live after the start", 10.0, "s"),
    at_most(
        "memory per built-in mapping, subscription and field values included",
        3_000.0,
        "bytes",
    ),
    at_least("disclosed values through gate, ledger and spool, sustained", 10_000.0, "per second"),
    at_least("appending against bare SQLite", 0.7, "times")
        .against("the same rows into the same tables by bare SQLite"),
    at_most("verification of a million entries", 10.0, "s"),
    at_least("*, link against bare client", 0.8, "times").against("*, bare client"),
    at_most("the most memory up to a million messages against 100 000", 1.25, "times")
        .against("memory of link and broker after 100 000 messages"),
];

/// Returns the goal of a figure with the text that its `*` stands for.
fn goal_of<'a>(name: &'a str, unit: &str) -> Option<(&'static Goal, &'a str)> {
    GOALS.iter().filter(|goal| goal.unit == unit).find_map(|goal| {
        let Some((before, after)) = goal.figure.split_once('*') else {
            return (goal.figure == name).then_some((goal, ""));
        };
        let middle = name.strip_prefix(before)?.strip_suffix(after)?;
        Some((goal, middle))
    })
}

impl Bound {
    fn is_met(self, value: f64) -> bool {
        match self {
            Self::AtLeast(bound) => value >= bound,
            Self::AtMost(bound) => value <= bound,
        }
    }

    fn text(self) -> String {
        match self {
            Self::AtLeast(bound) => format!("at least {bound}"),
            Self::AtMost(bound) => format!("at most {bound}"),
        }
    }
}

/// Returns what stands beside a figure when it is printed; empty without a goal.
pub(super) fn beside(name: &str, value: f64, unit: &str) -> String {
    goal_of(name, unit).map_or_else(String::new, |(goal, _)| {
        let outcome = if goal.bound.is_met(value) { "met" } else { "SHORT" };
        format!(" ({}: {outcome})", goal.bound.text())
    })
}

/// Adds goal, outcome and the other side of ratios to the results. Returns a line for each figure
/// that falls short.
pub(super) fn judge(results: &mut [Value]) -> Vec<String> {
    let measured: Vec<Value> = results.to_vec();
    let mut short = Vec::new();
    for result in results {
        let name = result["name"].as_str().unwrap_or_default().to_owned();
        let unit = result["unit"].as_str().unwrap_or_default().to_owned();
        let value = result["value"].as_f64().unwrap_or(f64::NAN);
        let Some((goal, middle)) = goal_of(&name, &unit) else { continue };
        let is_met = goal.bound.is_met(value);
        result["goal"] = json!(goal.bound.text());
        result["outcome"] = json!(if is_met { "met" } else { "short" });
        let other = goal.against.map(|other| other.replace('*', middle));
        let other = other.and_then(|other| other_side(&measured, &other, &unit));
        if let Some(other) = other {
            result["against"] = other.clone();
        }
        if !is_met {
            short.push(format!("{name}: {value:.2} {unit}, {} is the goal", goal.bound.text()));
        }
    }
    short
}

/// Finds the figure a ratio is against: of those of one name the one of the same unit, or the last.
fn other_side<'a>(measured: &'a [Value], name: &str, unit: &str) -> Option<&'a Value> {
    let mut named = measured.iter().filter(|one| one["name"] == name);
    named.clone().find(|one| one["unit"] == unit).or_else(|| named.next_back())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn figure(name: &str, value: f64, unit: &str) -> Value {
        json!({ "name": name, "value": value, "unit": unit })
    }

    #[test]
    fn a_figure_is_judged_by_name_and_unit() {
        let name = "built-in mappings into report fields";
        assert_eq!(beside(name, 99_999.0, "changes per second"), " (at least 100000: SHORT)");
        assert_eq!(beside(name, 100_000.0, "changes per second"), " (at least 100000: met)");
        assert_eq!(beside(name, 1.0, "changes per CPU second"), "", "another unit, no goal");
    }

    #[test]
    fn a_ratio_names_its_other_side() {
        let mut results = [
            figure("sent to RabbitMQ, bare client", 100.0, "messages per second"),
            figure("sent to RabbitMQ, link against bare client", 0.5, "times"),
            figure("sent to Mosquitto, bare client", 10.0, "messages per second"),
        ];
        let short = judge(&mut results);
        assert_eq!(
            short,
            ["sent to RabbitMQ, link against bare client: 0.50 times, at least 0.8 is the goal"]
        );
        assert_eq!(results[1]["against"]["value"], 100.0);
        assert_eq!(results[1]["outcome"], "short");
        assert!(results[0].get("goal").is_none());
    }

    #[test]
    fn an_unreadable_figure_falls_short() {
        let mut results = [figure("appending against bare SQLite", f64::NAN, "times")];
        assert_eq!(judge(&mut results).len(), 1);
    }
}
