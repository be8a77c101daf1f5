mod explained;
mod fast_path;
mod model;
mod parts;
mod properties;
mod slots;
mod statuses;
mod strategies;
mod transitions;

use asi_model::{Scalar, StatusCode};

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
    assert_eq!(gate.on(at(0), candidate(0, 1)), GateOutcome::Disclosed { is_coarsened: false });
    assert!(gate.take_released());
    assert_eq!(gate.on(at(1), candidate(1, 1)), GateOutcome::Unchanged { is_coarsened: false });
    assert!(!gate.take_released());
    assert_eq!(gate.on(at(2), candidate(2, 2)), GateOutcome::Disclosed { is_coarsened: false });
}

#[test]
fn rounding_does_not_let_the_changes_below_it_show() {
    let mut gate = gate(r#"{"roundingStep":10}"#);
    let mut released = Vec::new();
    for value in 0..=25 {
        gate.on(at(u64::try_from(value).expect("positive")), candidate(0, value));
        if gate.take_released() {
            released.push(shown(&gate));
        }
    }
    assert_eq!(released, [Some(0), Some(10), Some(20), Some(30)]);
}

#[test]
fn the_latest_value_is_released_when_the_interval_is_over() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    assert!(gate.take_released());
    assert_eq!(gate.on(at(100), candidate(100, 2)), GateOutcome::Withheld { until: at(1000) });
    assert_eq!(gate.on(at(900), candidate(900, 3)), GateOutcome::Withheld { until: at(1000) });
    gate.on_time(at(999));
    assert!(!gate.take_released());
    gate.on_time(at(1000));
    assert!(gate.take_released());
    assert_eq!(shown(&gate), Some(3));
    assert_eq!(gate.due(), None);
    gate.on(at(1100), candidate(1100, 4));
    assert_eq!(
        gate.on(at(1200), candidate(1200, 3)),
        GateOutcome::Unchanged { is_coarsened: false }
    );
}

#[test]
fn waiting_values_survive_a_restart_and_a_clock_set_back() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(5000), candidate(0, 1));
    gate.on(at(5100), candidate(0, 2));
    let mut again = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(5200));
    again.on_time(at(5200));
    assert!(!again.take_released());
    again.on_time(at(6000));
    assert_eq!(shown(&again), Some(2));
    let mut earlier = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(1000));
    earlier.on_time(at(1999));
    assert!(!earlier.take_released());
    earlier.on_time(at(2000));
    assert_eq!(shown(&earlier), Some(2));
}

#[test]
fn delay_releases_each_value_late_and_in_order() {
    let mut gate = gate(r#"{"delayMs":1000}"#);
    assert_eq!(gate.on(at(0), candidate(0, 1)), GateOutcome::Withheld { until: at(1000) });
    gate.on(at(500), candidate(500, 2));
    gate.on_time(at(1000));
    assert_eq!(shown(&gate), Some(1));
    assert_eq!(gate.due(), Some(at(1500)));
    gate.on_time(at(1500));
    assert_eq!(shown(&gate), Some(2));
}

#[test]
fn a_closed_gate_drops_waiting_values() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(10), candidate(10, 2));
    gate.close(at(100));
    assert_eq!((gate.due(), gate.disclosed()), (None, None));
    assert_eq!(gate.on(at(500), candidate(500, 3)), GateOutcome::Withheld { until: at(1000) });
}

#[test]
fn the_status_of_a_lost_source_is_released() {
    let mut gate = gate("{}");
    gate.on(at(0), candidate(0, 1));
    let mut lost = candidate(0, 1);
    lost.status = StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE;
    assert_eq!(gate.on(at(1), lost.clone()), GateOutcome::Disclosed { is_coarsened: false });
    assert_eq!(gate.disclosed().map(|shown| &**shown), Some(&lost));
}

#[test]
fn a_value_due_within_the_hours_is_not_released_after_them() {
    // START is a Friday at 08:00 UTC.
    let mut gate = gate(
        r#"{"delayMs":1000,"workingHours":{"days":["FRIDAY"],"from":"06:00","until":"09:00"}}"#,
    );
    gate.on(at(0), candidate(0, 1));
    let late = at(2 * 3_600_000);
    gate.on_time(late);
    assert_eq!(gate.disclosed(), None, "noticed an hour after the hours ended");
    let due = gate.due().expect("it waits for the next opening");
    assert_eq!(due, at(7 * 86_400_000 - 2 * 3_600_000));
    gate.on_time(due);
    assert_eq!(shown(&gate), Some(1));
}

#[test]
fn an_aggregate_is_released_once_per_window_and_survives_a_restart() {
    let mut gate = gate(r#"{"roundingStep":5,"aggregate":{"function":"MEAN","windowMs":1000}}"#);
    assert_eq!(gate.on(at(0), candidate(0, 10)), GateOutcome::Withheld { until: at(1000) });
    gate.on(at(500), candidate(500, 30));
    let mut gate = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(600));
    gate.on_time(at(999));
    assert!(!gate.take_released());
    gate.on_time(at(1000));
    assert!(gate.take_released());
    assert_eq!(shown(&gate), Some(20));
    let source = gate.disclosed().and_then(|value| value.source_timestamp);
    assert_eq!(source, Some(at(0)), "the window's beginning");
    gate.on_time(at(2000));
    assert_eq!(shown(&gate), Some(30), "the value that held on");
    assert_eq!(gate.due(), None, "and nothing more to say");
}

#[test]
fn a_sum_is_released_for_every_window() {
    let mut gate = gate(r#"{"aggregate":{"function":"SUM","windowMs":1000}}"#);
    let mut released = Vec::new();
    for ms in [0, 400, 1100, 1500, 2000, 3000, 4000, 5000] {
        if ms < 2000 {
            gate.on(at(ms), candidate(ms, 5));
        } else {
            gate.on_time(at(ms))
        }
        if gate.take_released() {
            released.push((ms, shown(&gate)));
        }
    }
    assert_eq!(released, [(1100, Some(10)), (2000, Some(10)), (3000, Some(0))]);
}

#[test]
fn a_rate_limit_applies_to_any_period() {
    let mut gate = gate(r#"{"rateLimits":[{"values":2,"periodMs":1000}]}"#);
    let mut left = Vec::new();
    for ms in (0_u64..3000).step_by(100) {
        gate = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(ms));
        gate.on(at(ms), candidate(ms, i64::try_from(ms).expect("small")));
        if gate.take_released() {
            left.push(ms);
        }
    }
    assert_eq!(left, [0, 100, 1000, 1100, 2000, 2100]);
}

#[test]
fn candidates_in_a_withheld_state_are_never_released() {
    let mut gate =
        gate(r#"{"withholdWhile":[{"states":[-1]},{"field":"state","states":["SETUP"]}]}"#);
    let other: FieldName = "state".parse().expect("a name");
    assert_eq!(
        gate.on(at(0), candidate(0, 1)),
        GateOutcome::Suppressed,
        "the other field's state is not known"
    );
    gate.on_state(at(1), &other, Some(false));
    assert!(!gate.take_released());
    assert_eq!(gate.on(at(2), candidate(2, 2)), GateOutcome::Disclosed { is_coarsened: false });
    gate.on_state(at(3), &other, Some(true));
    assert_eq!(gate.on(at(4), candidate(4, 3)), GateOutcome::Suppressed);
    let mut gate = Gate::new(gate.policy().clone(), BuiltInType::Int64, gate.state(), at(5));
    assert_eq!(gate.on(at(5), candidate(5, 4)), GateOutcome::Suppressed, "still, after a restart");
    gate.on_state(at(6), &other, Some(false));
    assert_eq!((gate.due(), shown(&gate)), (None, Some(2)));
    assert_eq!(gate.on(at(7), candidate(7, -1)), GateOutcome::Suppressed, "its own state");
    let mut lost = candidate(8, 0);
    lost.status = StatusCode::BAD_NO_DATA;
    assert_eq!(
        gate.on(at(8), lost),
        GateOutcome::Suppressed,
        "a loss within the state is the state's"
    );
    assert_eq!(gate.on(at(9), candidate(9, 5)), GateOutcome::Disclosed { is_coarsened: false });
}

#[test]
fn waiting_values_are_not_released_in_a_withheld_state() {
    let mut gate = gate(r#"{"delayMs":100,"withholdWhile":[{"field":"state","states":[1]}]}"#);
    let other: FieldName = "state".parse().expect("a name");
    gate.on_state(at(0), &other, Some(false));
    gate.on(at(0), candidate(0, 1));
    gate.on_state(at(50), &other, Some(true));
    gate.on_time(at(200));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
    gate.on_state(at(300), &other, Some(false));
    assert_eq!(shown(&gate), Some(1));
}

#[test]
fn candidates_of_a_mean_are_never_released_individually() {
    let mut gate = gate(r#"{"aggregate":{"function":"MEAN","windowMs":1000}}"#);
    gate.on(at(0), candidate(0, 7));
    gate.change_policy(Arc::default(), at(10));
    gate.on_time(at(5000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
}

#[test]
fn a_clock_set_back_delays_by_one_interval_at_most() {
    let mut gate = gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(300_000), candidate(0, 1));
    assert!(gate.take_released());
    gate.set_clock_back(at(5_000));
    assert_eq!(gate.on(at(5_100), candidate(0, 2)), GateOutcome::Withheld { until: at(6_000) });
    gate.on_time(at(6_000));
    assert_eq!(shown(&gate), Some(2));
}

#[test]
fn a_late_wake_releases_on_the_step() {
    let mut gate = gate(r#"{"timeStepMs":60000}"#);
    gate.on(at(0), candidate(0, 1));
    assert!(gate.take_released(), "the start is on the step");
    gate.on(at(1000), candidate(1000, 2));
    assert_eq!(gate.due(), Some(at(60_000)));
    // The machine slept: the next thing that happens is a candidate within a step.
    gate.on(at(83_000), candidate(83_000, 3));
    assert!(!gate.take_released(), "its time within the step would show");
    assert_eq!(gate.due(), Some(at(120_000)));
    // A timer is never exact.
    gate.on_time(at(120_004));
    assert!(gate.take_released());
    assert_eq!(shown(&gate), Some(3));
    assert_eq!(gate.disclosed().and_then(|value| value.source_timestamp), Some(at(60_000)));
}
