//! Guarantees of the gate as properties: for every policy, all candidates and any order of events, a
//! released value is never finer, faster or earlier than the policy allows. The checks compare only
//! candidates and released values; none of them depends on the gate's implementation.

use asi_model::Variant;
use proptest::prelude::*;

use super::{
    strategies::{HOUR_MS, START_MS, Step, at, other, policies, steps},
    *,
};
use crate::{RoundingStep, StateValue, WithholdCondition, gate_from_json, gate_to_json};

/// Released values with their times.
pub(super) type Left = Vec<(u64, DataValue)>;

/// Runs a gate through steps. It is woken in time, or (`is_late`) only at the next event.
pub(super) fn run(policy: &DisclosurePolicy, steps: &[(u64, Step)], is_late: bool) -> Left {
    let policy = Arc::new(policy.clone());
    let mut gate = Gate::new(Arc::clone(&policy), BuiltInType::Int64, GateState::default(), at(0));
    let (mut now, mut left) = (0, Vec::new());
    let mut note = |gate: &mut Gate, now| {
        if gate.take_released() {
            let released = gate.disclosed().expect("a released value is disclosed");
            left.push((now, DataValue::clone(released)));
        }
    };
    for (pause, step) in steps {
        let next = now + pause;
        while let Some(due) = gate.due().filter(|due| !is_late && *due < at(next)) {
            now = now.max(u64::try_from(due.unix_millis() - START_MS).expect("later"));
            gate.on_time(at(now));
            note(&mut gate, now);
        }
        now = next;
        // Due values are released before the next candidate, so that each release is observed.
        gate.on_time(at(now));
        note(&mut gate, now);
        match step {
            Step::Candidate(value) => {
                gate.on(at(now), DataValue { source_timestamp: Some(at(now)), ..value.clone() });
            }
            Step::State(is_withheld) => {
                gate.on_state(at(now), &other(), *is_withheld);
            }
            Step::Wake => gate.on_time(at(now)),
            Step::Restart => {
                let stored =
                    gate_from_json(&gate_to_json(&gate.state())).expect("it reads what it wrote");
                gate = Gate::new(Arc::clone(&policy), BuiltInType::Int64, stored, at(now));
            }
        }
        note(&mut gate, now);
    }
    left
}

fn numbers(value: &DataValue) -> Vec<i128> {
    match &value.value {
        Variant::Null => Vec::new(),
        Variant::Scalar(scalar) => vec![scalar.as_i128().expect("a whole number, as the field is")],
        Variant::Array(array) => {
            array.elements.iter().map(|e| e.as_i128().expect("whole numbers")).collect()
        }
    }
}

fn significant(number: i128) -> usize {
    number.unsigned_abs().to_string().trim_end_matches('0').len()
}

/// Returns whether a time is within the only hours tested: Monday and Wednesday, 05:00 to 13:30 UTC.
pub(super) fn is_working(ms: u64) -> bool {
    let (day, of_day) = (ms / (24 * HOUR_MS) % 7, ms % (24 * HOUR_MS));
    (day == 0 || day == 2) && (5 * HOUR_MS..13 * HOUR_MS + HOUR_MS / 2).contains(&of_day)
}

/// Candidates with their times, true for those in a withheld state, computed from the steps alone.
fn arrivals(policy: &DisclosurePolicy, steps: &[(u64, Step)]) -> Vec<(u64, DataValue, bool)> {
    let (mut now, mut own, mut foreign) = (0, false, true);
    let mut all = Vec::new();
    let looks_at_other = policy.withhold_while.iter().any(|condition| condition.field.is_some());
    for (pause, step) in steps {
        now += pause;
        match step {
            Step::State(is_withheld) => foreign = is_withheld.unwrap_or(true),
            Step::Candidate(value) => {
                if !value.status.is_bad() && !value.value.is_null() {
                    let elements = match &value.value {
                        Variant::Array(array) => array.elements.clone(),
                        Variant::Scalar(scalar) => vec![scalar.clone()],
                        Variant::Null => Vec::new(),
                    };
                    own = policy
                        .withhold_while
                        .iter()
                        .filter(|condition| condition.field.is_none())
                        .any(|condition| {
                            condition.states.iter().any(|state| {
                                let StateValue::Integer(state) = state else {
                                    panic!("only whole states are tested")
                                };
                                elements.iter().any(|element| {
                                    element.as_f64().is_some_and(|number| number == *state as f64)
                                })
                            })
                        });
                }
                all.push((now, value.clone(), own || (looks_at_other && foreign)));
            }
            Step::Wake | Step::Restart => {}
        }
    }
    all
}

/// Checks released values against the policy: each one, each pair of neighbours, and the rates.
fn check(
    policy: &DisclosurePolicy,
    steps: &[(u64, Step)],
    left: &Left,
) -> Result<(), TestCaseError> {
    let arrivals = arrivals(policy, steps);
    for (when, value) in left {
        check_precision(policy, value)?;
        check_time(policy, &arrivals, *when, value)?;
        check_states(policy, &arrivals, *when)?;
    }
    check_intervals(policy, left)?;
    check_rates(policy, left)
}

fn check_precision(policy: &DisclosurePolicy, value: &DataValue) -> Result<(), TestCaseError> {
    for number in numbers(value) {
        if let Some(digits) = policy.significant_digits {
            prop_assert!(
                significant(number) <= usize::from(digits),
                "{number} is finer than {digits} digits"
            );
        } else if let Some(step) = policy.rounding_step.and_then(RoundingStep::to_integer) {
            prop_assert_eq!(number % step, 0, "not a multiple");
        } else if !policy.bands.is_empty() {
            prop_assert!([-100, 0, 100].contains(&number));
        }
    }
    prop_assert_eq!((value.server_timestamp, value.source_picoseconds), (None, 0));
    Ok(())
}

fn check_time(
    policy: &DisclosurePolicy,
    arrivals: &[(u64, DataValue, bool)],
    when: u64,
    value: &DataValue,
) -> Result<(), TestCaseError> {
    let delay = policy.delay_ms.unwrap_or(0);
    let source = value.source_timestamp.expect("a source time").unix_millis();
    let millis = |ms: u64| i64::try_from(ms).expect("small");
    let left_at = START_MS + millis(when);
    if let Some(step) = policy.time_step_ms {
        prop_assert_eq!(source.rem_euclid(millis(step)), 0, "a time between the steps");
    }
    let windowed = policy.aggregate.map_or(0, |aggregate| aggregate.window_ms);
    if windowed == 0 {
        // An earlier candidate, long enough ago and in no withheld state, explains the value.
        let is_explained = arrivals.iter().any(|(came, candidate, is_withheld)| {
            let is_alike = candidate.status.is_bad() == value.status.is_bad()
                || candidate.value.built_in_type() != Some(BuiltInType::Int64);
            came + delay <= when && !is_withheld && is_alike
        });
        prop_assert!(is_explained, "{value:?} was released at {when}");
        prop_assert!(source + millis(delay) <= left_at, "released before its delay");
    } else if policy.time_step_ms.is_none() {
        prop_assert_eq!(source.rem_euclid(millis(windowed)), 0, "a time within a window");
        prop_assert!(
            source + millis(windowed + delay) <= left_at,
            "released before its window's end or its delay"
        );
    }
    if policy.working_hours.is_some() {
        prop_assert!(is_working(when), "released outside of working hours");
    }
    Ok(())
}

/// Checks that the last state known before a release was not a withheld one.
fn check_states(
    policy: &DisclosurePolicy,
    arrivals: &[(u64, DataValue, bool)],
    when: u64,
) -> Result<(), TestCaseError> {
    if let Some((came, _, true)) = arrivals.iter().rev().find(|(came, ..)| *came < when) {
        let is_over = arrivals
            .iter()
            .any(|(later, _, is_withheld)| came < later && *later <= when && !is_withheld);
        prop_assert!(
            is_over || policy.withhold_while.iter().any(|c| c.field.is_some()),
            "released in its own withheld state"
        );
    }
    Ok(())
}

fn check_intervals(policy: &DisclosurePolicy, left: &Left) -> Result<(), TestCaseError> {
    for pair in left.windows(2) {
        let (before, after) = (pair[0].0, pair[1].0);
        prop_assert!(
            after - before >= policy.minimum_interval_ms.unwrap_or(0),
            "faster than the interval"
        );
        for period in policy
            .time_step_ms
            .into_iter()
            .chain(policy.aggregate.map(|aggregate| aggregate.window_ms))
        {
            let slot = |ms: u64| (START_MS.unsigned_abs() + ms) / period;
            prop_assert!(slot(before) < slot(after), "twice in one step or window");
        }
        let is_sum =
            policy.aggregate.is_some_and(|aggregate| aggregate.function == AggregateFunction::Sum);
        prop_assert!(
            is_sum || pair[0].1.value != pair[1].1.value || pair[0].1.status != pair[1].1.status
        );
    }
    Ok(())
}

fn check_rates(policy: &DisclosurePolicy, left: &Left) -> Result<(), TestCaseError> {
    for limit in &policy.rate_limits {
        for (first, _) in left {
            let count = left
                .iter()
                .filter(|(when, _)| when >= first && *when < first + limit.period_ms)
                .count();
            prop_assert!(
                count <= limit.values as usize,
                "{count} values within {} ms",
                limit.period_ms
            );
        }
    }
    Ok(())
}

/// A case that the properties found once.
#[test]
fn a_value_after_a_withheld_one_is_released() {
    let states = vec![StateValue::Integer(0), StateValue::Integer(7)];
    let withhold_while = vec![WithholdCondition { field: None, states }];
    let policy = DisclosurePolicy { withhold_while, ..DisclosurePolicy::default() };
    let candidate = |number: i64| Step::Candidate(DataValue::good(number, at(0)));
    let left = run(&policy, &[(0, candidate(7)), (1, candidate(8))], false);
    let values: Vec<&Variant> = left.iter().map(|(_, value)| &value.value).collect();
    assert_eq!(values, [&Variant::from(8_i64)]);
}

proptest! {
    /// Never finer, faster or earlier. The pauses are short, so that windows, intervals and delays
    /// overlap.
    #[test]
    fn only_values_that_the_policy_allows_are_released(policy in policies(), steps in steps(2_000), is_late in any::<bool>()) {
        check(&policy, &steps, &run(&policy, &steps, is_late))?;
    }

    /// The same over days, for the hours.
    #[test]
    fn no_value_is_released_outside_of_the_hours(policy in policies(), steps in steps(8 * HOUR_MS), is_late in any::<bool>()) {
        check(&policy, &steps, &run(&policy, &steps, is_late))?;
    }

    /// Candidates in a withheld state leave no trace: without them, the same values are released at
    /// the same times.
    #[test]
    fn withheld_candidates_leave_no_trace(steps in steps(500), minimum_interval_ms in proptest::option::of(1_u64..2_000)) {
        let condition = WithholdCondition { field: Some(other()), states: vec![StateValue::Integer(1)] };
        let policy = DisclosurePolicy { minimum_interval_ms, withhold_while: vec![condition], ..Default::default() };
        let mut is_withheld = true;
        let mut pauses = 0;
        let mut without = Vec::new();
        for (pause, step) in &steps {
            if let Step::State(state) = step {
                is_withheld = state.unwrap_or(true);
            }
            if is_withheld && matches!(step, Step::Candidate(_)) {
                pauses += pause;
            } else {
                without.push((pauses + pause, step.clone()));
                pauses = 0;
            }
        }
        prop_assert_eq!(run(&policy, &steps, false), run(&policy, &without, false));
    }

    /// Two sequences that differ only below the rounding step release the same values at the same
    /// times.
    #[test]
    fn differences_below_the_step_are_not_observable(
        step in 1_i64..100,
        values in proptest::collection::vec((0_u64..2_000, -20_i64..20, 0_i64..100, 0_i64..100), 1..40),
        minimum_interval_ms in proptest::option::of(1_u64..5_000),
    ) {
        #[allow(clippy::cast_precision_loss)]
        let rounding_step = Some((step as f64).try_into().expect("positive"));
        let policy = DisclosurePolicy { rounding_step, minimum_interval_ms, ..Default::default() };
        // Offsets within half a step of the multiple, in both directions.
        let near = |multiple: i64, offset: i64| multiple * step + offset % ((step + 1) / 2);
        let course = |pick: fn(&(u64, i64, i64, i64)) -> i64| -> Vec<(u64, Step)> {
            values.iter().map(|v| (v.0, Step::Candidate(DataValue::good(near(v.1, pick(v)), at(0))))).collect()
        };
        let shown = |left: Left| -> Vec<(u64, Variant)> { left.into_iter().map(|(at, v)| (at, v.value)).collect() };
        prop_assert_eq!(shown(run(&policy, &course(|v| v.2), false)), shown(run(&policy, &course(|v| v.3), false)));
    }

    /// Two sequences that differ only in times within a time step release the same values.
    #[test]
    fn differences_within_a_time_step_are_not_observable(
        values in proptest::collection::vec((0_u64..3, -9_i64..9, 0_u64..100, 0_u64..100), 1..40),
    ) {
        let policy = DisclosurePolicy { time_step_ms: Some(1_000), ..Default::default() };
        let course = |pick: fn(&(u64, i64, u64, u64)) -> u64| -> Vec<(u64, Step)> {
            let mut slot = 0;
            let mut within = 0;
            let mut last = 0;
            let mut steps = Vec::new();
            for value in &values {
                slot += value.0;
                within = if value.0 > 0 { 0 } else { within + 1 };
                let now = slot * 1_000 + (within * 20 + pick(value) % 20).clamp(1, 999);
                let now = now.max(last);
                steps.push((now - last, Step::Candidate(DataValue::good(value.1, at(0)))));
                last = now;
            }
            steps.push((60_000, Step::Wake));
            steps
        };
        prop_assert_eq!(run(&policy, &course(|v| v.2), false), run(&policy, &course(|v| v.3), false));
    }

    /// The mean over a window equals that of one sample per millisecond.
    #[test]
    fn a_mean_is_the_mean(values in proptest::collection::vec((1_u64..700, -1000_i64..1000), 1..30)) {
        let policy: DisclosurePolicy =
            serde_json::from_str(r#"{"aggregate":{"function":"MEAN","windowMs":1000}}"#).expect("a policy");
        let steps: Vec<_> =
            values.iter().map(|(pause, value)| (*pause, Step::Candidate(DataValue::good(*value, at(0))))).collect();
        let left = run(&policy, &steps, false);
        for (when, value) in &left {
            let source = u64::try_from(value.source_timestamp.expect("a time").unix_millis() - START_MS).expect("later");
            prop_assert_eq!(source + 1_000, *when);
            let (mut sum, mut count) = (0, 0);
            for ms in source..*when {
                let mut came = 0;
                let mut held = None;
                for (pause, value) in &values {
                    came += pause;
                    held = if came <= ms { Some(*value) } else { held };
                }
                if let Some(held) = held {
                    sum += held;
                    count += 1;
                }
            }
            #[allow(clippy::cast_precision_loss)]
            let mean = sum as f64 / f64::from(count);
            let shown = value.value.as_f64().expect("a number");
            prop_assert!((shown - mean).abs() <= 0.5 + 1e-6, "{shown} instead of {mean}");
        }
    }

    /// After the last limit has passed, the newest value is shown.
    #[test]
    fn the_newest_value_is_released_in_the_end(policy in policies(), values in proptest::collection::vec((0_u64..2_000, -1000_i64..1000), 1..40)) {
        let policy = DisclosurePolicy { withhold_while: Vec::new(), aggregate: None, ..policy };
        let mut steps: Vec<_> =
            values.iter().map(|(pause, value)| (*pause, Step::Candidate(DataValue::good(*value, at(0))))).collect();
        steps.push((14 * 24 * HOUR_MS, Step::Wake));
        let left = run(&policy, &steps, false);
        let last = values.last().expect("not empty");
        let expected = coarsen(&policy, BuiltInType::Int64, DataValue::good(last.1, at(0))).value.value;
        prop_assert_eq!(&left.last().expect("something left").1.value, &expected);
    }

    /// A restart at any moment releases no other values.
    #[test]
    fn restarts_change_nothing(policy in policies(), steps in steps(900)) {
        let without: Vec<_> = steps
            .iter()
            .map(|(pause, step)| (*pause, if matches!(step, Step::Restart) { Step::Wake } else { step.clone() }))
            .collect();
        prop_assert_eq!(run(&policy, &steps, false), run(&policy, &without, false));
    }
}
