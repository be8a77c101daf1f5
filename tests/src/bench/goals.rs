//! Goals of the figures: what each must reach, and the other side of each ratio.

use serde_json::{Value, json};

use self::Bound::{AtLeast, AtMost, Context};
use super::subject::Subject;

/// Bound of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    AtLeast(f64),
    AtMost(f64),
    /// No bound: the figure is measured for its ratio to another.
    Context,
}

/// Goal of a figure.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// Part of the product whose measurement yields the figure.
    pub subject: Subject,
    /// Name of the figure; one `*` stands for any text.
    pub figure: &'static str,
    /// Unit of the figure: one name may be measured in several.
    pub unit: &'static str,
    pub bound: Bound,
    /// Name of the figure that a ratio is against, with the text that `*` stood for.
    pub against: Option<&'static str>,
    /// Number of figures that one run yields for the name: several where `*` stands for each of
    /// what is compared.
    pub count: usize,
}

const fn goal(subject: Subject, figure: &'static str, bound: Bound, unit: &'static str) -> Goal {
    Goal { subject, figure, unit, bound, against: None, count: 1 }
}

impl Goal {
    const fn against(self, other: &'static str) -> Self {
        Self { against: Some(other), ..self }
    }

    const fn times(self, count: usize) -> Self {
        Self { count, ..self }
    }
}

/// All goals, in the order of the figures. Figures without a goal are context.
pub const GOALS: &[Goal] = &[
    goal(Subject::Reports, "slowest report of six fields encoded", AtMost(2.0), "microseconds"),
    goal(Subject::Reports, "slowest report of six fields decoded", AtMost(4.0), "microseconds"),
    goal(
        Subject::Path,
        "value changed on the machine -> on the buyer's live stream, median of *",
        AtMost(150.0),
        "ms",
    ),
    goal(
        Subject::Path,
        "request sent -> nodes browsable in the twin, slowest of *",
        AtMost(200.0),
        "ms",
    ),
    goal(Subject::Path, "drain rate after an outage against the live rate", AtLeast(1.0), "times")
        .against("reports stored by the platform"),
    goal(
        Subject::Twin,
        "twin: memory of a field, its document included, 100 000 fields",
        AtMost(2_500.0),
        "bytes",
    ),
    goal(
        Subject::Twin,
        "twin: 100 000 fields parsed and shown again after a restart",
        AtMost(5.0),
        "s",
    ),
    goal(
        Subject::Twin,
        "connector: start with 100 000 fields in 10 000 networks, until all are shown",
        AtMost(5.0),
        "s",
    ),
    goal(Subject::Twin, "twin: reads meanwhile that took over 20 ms", AtMost(0.0), "reads"),
    goal(
        Subject::Twin,
        "twin: browsing an interface among 10 000 against among 10",
        AtMost(1.5),
        "times",
    )
    .against("twin: browsing an interface among 10, median"),
    goal(
        Subject::Twin,
        "twin: change to notification at 10 ms publishing, median of *",
        AtMost(15.0),
        "ms",
    ),
    goal(Subject::Twin, "node-opcua's processor time for one of the twin's", AtLeast(1.0), "times")
        .against("node-opcua: 5000 variables changing every 100 ms, processor"),
    goal(Subject::Twin, "node-opcua's memory for one of the twin's", AtLeast(1.0), "times")
        .against("node-opcua: 5000 variables changing every 100 ms, memory"),
    goal(Subject::Twin, "twin: of these lost", AtMost(0.0), "changes"),
    goal(Subject::Twin, "twin: of these out of order", AtMost(0.0), "changes"),
    goal(
        Subject::Mappings,
        "built-in mappings into report fields",
        AtLeast(100_000.0),
        "changes per second",
    )
    .against("bare subscription"),
    goal(
        Subject::Mappings,
        "JavaScript mappings into report fields",
        AtLeast(50_000.0),
        "changes per second",
    )
    .against("bare subscription"),
    goal(
        Subject::Mappings,
        "memory per JavaScript mapping, its worker's included",
        AtMost(250_000.0),
        "bytes",
    ),
    goal(
        Subject::Mappings,
        "built-in mappings against node-opcua",
        AtLeast(4.0),
        "times the values per CPU second",
    )
    .against("the same with node-opcua"),
    goal(
        Subject::Mappings,
        "JavaScript mappings against node-opcua",
        Context,
        "times the values per CPU second",
    )
    .against("the same with node-opcua"),
    goal(Subject::Mappings, "50 000 built-in mappings live after the start", AtMost(10.0), "s"),
    goal(
        Subject::Mappings,
        "memory per built-in mapping, subscription and field values included",
        AtMost(3_000.0),
        "bytes",
    ),
    goal(
        Subject::Ledger,
        "disclosed values through gate, ledger and spool, sustained",
        AtLeast(10_000.0),
        "per second",
    ),
    goal(Subject::Ledger, "appending against bare SQLite", AtLeast(0.7), "times")
        .against("the same rows into the same tables by bare SQLite"),
    goal(Subject::Ledger, "verification of a million entries", AtMost(10.0), "s"),
    goal(Subject::Ledger, "audit of a million entries", AtMost(10.0), "s"),
    // To and from each of three brokers.
    goal(Subject::Links, "*, link against bare client", AtLeast(0.8), "times")
        .against("*, bare client")
        .times(6),
    goal(
        Subject::Links,
        "the most memory up to a million messages against 200 000",
        AtMost(1.1),
        "times",
    )
    .against("memory of link and broker after 200 000 messages"),
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
            AtLeast(bound) => value >= bound,
            AtMost(bound) => value <= bound,
            Context => !value.is_nan(),
        }
    }

    fn text(self) -> String {
        match self {
            AtLeast(bound) => format!("at least {bound}"),
            AtMost(bound) => format!("at most {bound}"),
            Context => "no goal".to_owned(),
        }
    }
}

/// Returns what stands beside a figure when it is printed; empty without a goal.
pub(super) fn beside(name: &str, value: f64, unit: &str) -> String {
    let judged = goal_of(name, unit).filter(|(goal, _)| goal.bound != Context);
    judged.map_or_else(String::new, |(goal, _)| {
        let outcome = if goal.bound.is_met(value) { "met" } else { "SHORT" };
        format!(" ({}: {outcome})", goal.bound.text())
    })
}

/// Adds goal, outcome and the other side of ratios to the results. Returns a line for each figure
/// that falls short, and for each that these subjects should have yielded and did not.
pub(super) fn judge(results: &mut [Value], subjects: &[Subject]) -> Vec<String> {
    let measured: Vec<Value> = results.to_vec();
    let mut short = Vec::new();
    for result in results {
        let name = result["name"].as_str().unwrap_or_default().to_owned();
        let unit = result["unit"].as_str().unwrap_or_default().to_owned();
        let value = result["value"].as_f64().unwrap_or(f64::NAN);
        let Some((goal, middle)) = goal_of(&name, &unit) else { continue };
        let is_met = goal.bound.is_met(value);
        result["goal"] = json!(goal.bound.text());
        result["outcome"] = json!(match (goal.bound, is_met) {
            (Context, true) => "measured",
            (_, true) => "met",
            (_, false) => "short",
        });
        if let Some(other) = goal.against.map(|other| other.replace('*', middle)) {
            match other_side(&measured, &other, &unit) {
                Some(other) => result["against"] = other.clone(),
                None => short.push(format!("{name}: \"{other}\", its other side, is missing")),
            }
        }
        if !is_met {
            short.push(format!("{name}: {value:.2} {unit}, {} is the goal", goal.bound.text()));
        }
    }
    short.extend(missing(&measured, subjects));
    short
}

/// Returns a line for each judged figure: value, goal, outcome and the other side of a ratio.
pub(super) fn summary(results: &[Value]) -> Vec<String> {
    let text = |figure: &Value| {
        let value = figure["value"].as_f64().unwrap_or(f64::NAN);
        format!("{value:.2} {}", figure["unit"].as_str().unwrap_or_default())
    };
    let line = |figure: &Value| {
        let name = figure["name"].as_str().unwrap_or_default();
        let (goal, outcome) = (figure["goal"].as_str()?, figure["outcome"].as_str()?);
        let mut line = format!("{name}: {} ({goal}: {outcome})", text(figure));
        if let Some(other) = figure.get("against") {
            let name = other["name"].as_str().unwrap_or_default();
            line.push_str(&format!(", beside {} of {name}", text(other)));
        }
        Some(line)
    };
    results.iter().filter_map(line).collect()
}

/// Returns a line for each goal of these subjects that fewer figures were measured for than a run
/// yields: a figure that was renamed or left out must not pass for one that met its goal.
fn missing(measured: &[Value], subjects: &[Subject]) -> Vec<String> {
    let is_for = |result: &Value, goal: &Goal| {
        let (name, unit) = (result["name"].as_str(), result["unit"].as_str());
        goal_of(name.unwrap_or_default(), unit.unwrap_or_default())
            .is_some_and(|(of, _)| of.figure == goal.figure && of.unit == goal.unit)
    };
    let required = GOALS.iter().filter(|goal| subjects.contains(&goal.subject));
    required
        .filter_map(|goal| {
            let count = measured.iter().filter(|result| is_for(result, goal)).count();
            let Goal { figure, unit, count: expected, .. } = goal;
            (count < *expected)
                .then(|| format!("{figure} ({unit}): missing, {count} of {expected} were measured"))
        })
        .collect()
}

/// Finds the figure a ratio is against: of those of one name the one of the same unit, or the last.
fn other_side<'a>(measured: &'a [Value], name: &str, unit: &str) -> Option<&'a Value> {
    let mut named = measured.iter().filter(|one| one["name"] == name);
    named.clone().find(|one| one["unit"] == unit).or_else(|| named.next_back())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use clap::ValueEnum as _;

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
        let short = judge(&mut results, &[]);
        assert_eq!(
            short,
            ["sent to RabbitMQ, link against bare client: 0.50 times, at least 0.8 is the goal"]
        );
        assert_eq!(results[1]["against"]["value"], 100.0);
        assert_eq!(results[1]["outcome"], "short");
        assert_eq!(
            summary(&results),
            ["sent to RabbitMQ, link against bare client: 0.50 times (at least 0.8: short), \
              beside 100.00 messages per second of sent to RabbitMQ, bare client"]
        );
        assert!(results[0].get("goal").is_none());
    }

    #[test]
    fn a_ratio_without_its_other_side_is_listed() {
        let mut results = [figure("sent to RabbitMQ, link against bare client", 0.9, "times")];
        let other = "\"sent to RabbitMQ, bare client\", its other side, is missing";
        assert_eq!(
            judge(&mut results, &[]),
            [format!("sent to RabbitMQ, link against bare client: {other}")]
        );
    }

    #[test]
    fn an_unreadable_figure_falls_short() {
        let mut results = [figure("verification of a million entries", f64::NAN, "s")];
        assert_eq!(judge(&mut results, &[]).len(), 1);
    }

    /// Figures that meet all goals of a subject.
    fn all_of(subject: Subject) -> Vec<Value> {
        let mut results = Vec::new();
        for goal in GOALS.iter().filter(|goal| goal.subject == subject) {
            let value = match goal.bound {
                AtLeast(value) | AtMost(value) => value,
                Context => 1.0,
            };
            for number in 0..goal.count {
                let number = number.to_string();
                results.push(figure(&goal.figure.replace('*', &number), value, goal.unit));
                if let Some(other) = goal.against {
                    results.push(figure(&other.replace('*', &number), 1.0, "of the other side"));
                }
            }
        }
        results
    }

    #[test]
    fn a_figure_that_was_not_measured_is_listed() {
        let mut results = all_of(Subject::Ledger);
        assert_eq!(judge(&mut results, &[Subject::Ledger]), [""; 0]);
        results.retain(|result| result["name"] != "verification of a million entries");
        assert_eq!(
            judge(&mut results, &[Subject::Ledger]),
            ["verification of a million entries (s): missing, 0 of 1 were measured"]
        );
    }

    #[test]
    fn a_figure_in_another_unit_is_not_the_one_of_the_goal() {
        let mut results = all_of(Subject::Ledger);
        let name = "verification of a million entries";
        let result = results.iter_mut().find(|result| result["name"] == name).unwrap();
        result["unit"] = json!("ms");
        assert_eq!(
            judge(&mut results, &[Subject::Ledger]),
            ["verification of a million entries (s): missing, 0 of 1 were measured"]
        );
    }

    #[test]
    fn a_pattern_is_measured_for_each_of_what_is_compared() {
        let mut results = all_of(Subject::Links);
        assert_eq!(judge(&mut results, &[Subject::Links]), [""; 0]);
        results.retain(|result| result["name"] != "5, link against bare client");
        assert_eq!(
            judge(&mut results, &[Subject::Links]),
            ["*, link against bare client (times): missing, 5 of 6 were measured"]
        );
    }

    #[test]
    fn only_subjects_that_were_measured_are_required() {
        assert_eq!(judge(&mut [], &[]), [""; 0]);
        assert_eq!(judge(&mut [], Subject::value_variants()).len(), GOALS.len());
        let mut results = all_of(Subject::Mappings);
        assert_eq!(judge(&mut results, &[Subject::Mappings]), [""; 0]);
        assert!(!judge(&mut results, &[Subject::Mappings, Subject::Path]).is_empty());
    }
}
