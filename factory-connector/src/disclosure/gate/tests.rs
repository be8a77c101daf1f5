use asi_model::{Scalar, StatusCode, Variant};
use proptest::prelude::*;

use super::*;

const START: i64 = 1_800_000_000_000_000;

fn at(ms: u64) -> DateTime {
    DateTime::from_unix_micros(START).after(Duration::from_millis(ms))
}

fn gate(policy: &str) -> Gate {
    let policy = serde_json::from_str(policy).expect("a policy");
    Gate::new(Arc::new(policy), BuiltInType::Int64, GateState::default(), at(0))
}

fn candidate(ms: u64, value: i64) -> DataValue {
    DataValue::good(value, at(ms))
}

fn shown(gate: &Gate) -> Option<i128> {
    gate.disclosed().and_then(|value| value.value.as_scalar()).and_then(Scalar::as_i128)
}

#[test]
fn an_open_policy_lets_every_change_pass_once() {
    let mut gate = gate("{}");
    assert_eq!(gate.on(at(0), candidate(0, 1)), Outcome::Disclosed { is_coarsened: false });
    assert!(gate.take_news());
    assert_eq!(gate.on(at(1), candidate(1, 1)), Outcome::Unchanged { is_coarsened: false });
    assert!(!gate.take_news());
    assert_eq!(gate.on(at(2), candidate(2, 2)), Outcome::Disclosed { is_coarsened: false });
}

#[test]
fn rounding_does_not_let_the_changes_below_it_show() {
    let mut gate = gate(r#"{"roundingStep":10}"#);
    let mut news = Vec::new();
    for value in 0..=25 {
        gate.on(at(u64::try_from(value).expect("positive")), candidate(0, value));
        if gate.take_news() {
            news.push(shown(&gate));
        }
    }
    assert_eq!(news, [Some(0), Some(10), Some(20), Some(30)]);
}

#[test]
fn the_latest_value_leaves_when_the_interval_is_over() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    assert!(gate.take_news());
    assert_eq!(gate.on(at(100), candidate(100, 2)), Outcome::Withheld { until: at(1000) });
    assert_eq!(gate.on(at(900), candidate(900, 3)), Outcome::Withheld { until: at(1000) });
    gate.on_time(at(999));
    assert!(!gate.take_news());
    gate.on_time(at(1000));
    assert!(gate.take_news());
    assert_eq!(shown(&gate), Some(3));
    assert_eq!(gate.due(), None);
    gate.on(at(1100), candidate(1100, 4));
    assert_eq!(gate.on(at(1200), candidate(1200, 3)), Outcome::Unchanged { is_coarsened: false });
}

#[test]
fn what_waits_survives_a_restart_and_a_clock_set_back() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(5000), candidate(0, 1));
    gate.on(at(5100), candidate(0, 2));
    let mut again = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(5200));
    again.on_time(at(5200));
    assert!(!again.take_news());
    again.on_time(at(6000));
    assert_eq!(shown(&again), Some(2));
    let mut earlier = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(1000));
    earlier.on_time(at(1999));
    assert!(!earlier.take_news());
    earlier.on_time(at(2000));
    assert_eq!(shown(&earlier), Some(2));
}

#[test]
fn delay_releases_each_value_late_and_in_order() {
    let mut gate = gate(r#"{"delayMs":1000}"#);
    assert_eq!(gate.on(at(0), candidate(0, 1)), Outcome::Withheld { until: at(1000) });
    gate.on(at(500), candidate(500, 2));
    gate.on_time(at(1000));
    assert_eq!(shown(&gate), Some(1));
    assert_eq!(gate.due(), Some(at(1500)));
    gate.on_time(at(1500));
    assert_eq!(shown(&gate), Some(2));
}

#[test]
fn a_closed_gate_forgets_what_waited() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(10), candidate(10, 2));
    gate.close();
    assert_eq!((gate.due(), gate.disclosed()), (None, None));
    assert_eq!(gate.on(at(500), candidate(500, 3)), Outcome::Withheld { until: at(1000) });
}

#[test]
fn a_lost_source_shows_as_its_status() {
    let mut gate = gate("{}");
    gate.on(at(0), candidate(0, 1));
    let mut lost = candidate(0, 1);
    lost.status = StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE;
    assert_eq!(gate.on(at(1), lost.clone()), Outcome::Disclosed { is_coarsened: false });
    assert_eq!(gate.disclosed(), Some(&lost));
}

fn policies() -> impl Strategy<Value = DisclosurePolicy> {
    let period = || prop_oneof![Just(None), (1_u64..5_000).prop_map(Some)];
    (prop_oneof![Just(None), (1_u32..500).prop_map(Some)], period(), period(), period(), any::<bool>()).prop_map(
        |(step, minimum_interval_ms, time_step_ms, delay_ms, is_banded)| {
            let mut policy = DisclosurePolicy { minimum_interval_ms, time_step_ms, delay_ms, ..Default::default() };
            if is_banded {
                policy.bands = vec![-100.0, 0.0, 100.0];
            } else {
                policy.rounding_step = step.map(|step| f64::from(step).try_into().expect("positive"));
            }
            policy
        },
    )
}

/// What left of a gate: when, and what.
fn run(policy: &DisclosurePolicy, steps: &[(u64, Option<i64>)]) -> Vec<(u64, DataValue)> {
    let mut gate = Gate::new(Arc::new(policy.clone()), BuiltInType::Int64, GateState::default(), at(0));
    let (mut now, mut left) = (0, Vec::new());
    for (pause, value) in steps {
        now += pause;
        match value {
            Some(value) => drop(gate.on(at(now), candidate(now, *value))),
            None => gate.on_time(at(now)),
        }
        if gate.take_news() {
            left.push((now, gate.disclosed().expect("news is a value").clone()));
        }
    }
    left
}

proptest! {
    /// For any policy and any course of candidates and wake-ups: never finer, faster or earlier than allowed.
    #[test]
    fn what_leaves_is_never_more_than_the_policy_allows(
        policy in policies(),
        steps in proptest::collection::vec((0_u64..2_000, prop_oneof![3 => (-1000_i64..1000).prop_map(Some), 1 => Just(None)]), 0..60),
    ) {
        let left = run(&policy, &steps);
        let mut arrivals = Vec::new();
        let mut now = 0;
        for (pause, value) in &steps {
            now += pause;
            arrivals.extend(value.map(|value| (now, value)));
        }
        for (when, value) in &left {
            let Variant::Scalar(scalar) = &value.value else { panic!("a scalar left") };
            let number = scalar.as_i128().expect("an integer");
            if let Some(step) = policy.rounding_step {
                prop_assert_eq!(number % step.to_integer().expect("whole"), 0);
            }
            if !policy.bands.is_empty() {
                prop_assert!([-100, 0, 100].contains(&number));
            }
            let source = value.source_timestamp.expect("a source time");
            prop_assert_eq!(source, source.floor_to(policy.time_step()));
            let allowed = source.after(policy.delay());
            prop_assert!(allowed <= at(*when), "left before its delay");
        }
        for pair in left.windows(2) {
            prop_assert!(pair[1].0 - pair[0].0 >= policy.minimum_interval_ms.unwrap_or(0));
            prop_assert!((&pair[0].1.value, pair[0].1.status) != (&pair[1].1.value, pair[1].1.status));
            if let Some(step) = policy.time_step_ms {
                prop_assert!(at(pair[0].0).floor_to(Duration::from_millis(step)) < at(pair[1].0));
            }
        }
    }

    /// Without a clock's limits nothing is lost: after enough time the newest value is shown.
    #[test]
    fn the_newest_value_leaves_in_the_end(policy in policies(), values in proptest::collection::vec((0_u64..2_000, -1000_i64..1000), 1..40)) {
        let mut steps: Vec<_> = values.iter().map(|(pause, value)| (*pause, Some(*value))).collect();
        steps.extend([(20_000, None), (20_000, None)]);
        let left = run(&policy, &steps);
        let last = values.last().expect("not empty");
        let expected = coarsen(&policy, BuiltInType::Int64, DataValue::good(last.1, at(0))).value.value;
        prop_assert_eq!(&left.last().expect("something left").1.value, &expected);
    }

    /// A restart at any moment does not let more out.
    #[test]
    fn a_restart_keeps_the_interval(pauses in proptest::collection::vec((0_u64..500, -9_i64..9), 1..30)) {
        let mut gate = gate(r#"{"minimumIntervalMs":700}"#);
        let (mut now, mut last) = (0, None);
        for (pause, value) in pauses {
            now += pause;
            gate = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(now));
            gate.on(at(now), candidate(now, value));
            if gate.take_news() {
                prop_assert!(last.is_none_or(|last| now - last >= 700));
                last = Some(now);
            }
        }
    }
}

#[test]
fn a_clock_set_back_keeps_the_interval_and_no_more() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(300_000), candidate(0, 1));
    assert!(gate.take_news());
    gate.set_clock_back(at(5_000));
    assert_eq!(gate.on(at(5_100), candidate(0, 2)), Outcome::Withheld { until: at(6_000) });
    gate.on_time(at(6_000));
    assert_eq!(shown(&gate), Some(2));
}
