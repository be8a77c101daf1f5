//! Changes of policy and source: nothing that waited under the former one is released, unless the
//! new one allows it.

use super::*;

fn policy(json: &str) -> Arc<DisclosurePolicy> {
    Arc::new(serde_json::from_str(json).expect("a policy"))
}

const MEAN: &str = r#"{"delayMs":1000,"aggregate":{"function":"MEAN","windowMs":1000}}"#;

#[test]
fn single_values_that_waited_never_leave_under_an_aggregate() {
    let mut gate = gate(r#"{"delayMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(10), candidate(10, 2));
    gate.change_policy(policy(MEAN), at(500));
    gate.on_time(at(90_000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
    // A value that waits only for an interval does not leave, either.
    let mut gate = super::gate(r#"{"minimumIntervalMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(10), candidate(10, 2));
    gate.change_policy(policy(MEAN), at(500));
    gate.on_time(at(90_000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
}

#[test]
fn values_of_short_windows_never_leave_under_longer_ones() {
    let mut gate = gate(MEAN);
    gate.on(at(0), candidate(0, 7));
    gate.on_time(at(1000));
    gate.change_policy(
        policy(r#"{"delayMs":1000,"aggregate":{"function":"MEAN","windowMs":60000}}"#),
        at(1500),
    );
    gate.on_time(at(90_000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
}

#[test]
fn values_from_before_a_condition_never_leave() {
    let other: FieldName = "state".parse().expect("a name");
    for (condition, is_own) in [
        (r#"{"delayMs":1000,"withholdWhile":[{"field":"state","states":["SETUP"]}]}"#, false),
        (r#"{"delayMs":1000,"withholdWhile":[{"states":[1,2]}]}"#, true),
        (
            r#"{"delayMs":1000,"withholdWhile":[{"states":[9]},{"field":"state","states":["SETUP"]}]}"#,
            false,
        ),
    ] {
        let mut gate = gate(r#"{"delayMs":1000,"withholdWhile":[{"states":[9]}]}"#);
        gate.on(at(0), candidate(0, 1));
        gate.on_time(at(1000));
        assert_eq!(shown(&gate), Some(1));
        gate.on(at(1100), candidate(1100, 2));
        gate.change_policy(policy(condition), at(1200));
        gate.on_state(at(1300), &other, Some(false));
        gate.on_time(at(90_000));
        assert_eq!((gate.disclosed(), gate.due()), (None, None), "{condition}");
        let mut lost = candidate(90_000, 0);
        lost.status = StatusCode::BAD_NO_DATA;
        let outcome = gate.on(at(90_000), lost);
        assert_eq!(outcome == GateOutcome::Suppressed, is_own, "the own state is not known yet");
        gate.on(at(90_001), candidate(90_001, 3));
        gate.on_time(at(99_000));
        assert_eq!(shown(&gate), Some(3));
    }
}

#[test]
fn conditions_that_are_taken_away_let_values_go_on() {
    let mut gate = gate(r#"{"delayMs":1000,"withholdWhile":[{"states":[9]},{"states":[8]}]}"#);
    gate.on(at(0), candidate(0, 1));
    gate.change_policy(policy(r#"{"delayMs":1000,"withholdWhile":[{"states":[8]}]}"#), at(100));
    gate.on_time(at(1000));
    assert_eq!(shown(&gate), Some(1));
}

#[test]
fn a_tightened_policy_shows_no_finer_value() {
    let mut gate = gate(r#"{"statusCodes":"FULL"}"#);
    let mut fine = candidate(17, 123);
    fine.status = StatusCode::UNCERTAIN_SUB_NORMAL;
    gate.on(at(17), fine);
    assert_eq!(shown(&gate), Some(123));
    gate.change_policy(policy(r#"{"roundingStep":100}"#), at(20));
    let coarse = DataValue { status: StatusCode::UNCERTAIN, ..candidate(17, 100) };
    assert_eq!(gate.disclosed().map(|shown| &**shown), Some(&coarse));
    assert_eq!(gate.due(), None, "nothing is left to release");
    gate.change_policy(policy(r#"{"roundingStep":100,"timeStepMs":1000}"#), at(30));
    assert_eq!((gate.disclosed(), gate.due()), (None, Some(at(1000))), "not between two steps");
    gate.on_time(at(1000));
    let coarse = DataValue { status: StatusCode::UNCERTAIN, ..candidate(0, 100) };
    assert_eq!(gate.disclosed().map(|shown| &**shown), Some(&coarse));
    // A single value is finer than any of a window.
    gate.change_policy(policy(MEAN), at(1030));
    assert_eq!(gate.disclosed(), None);
}

/// The report with the value may wait unsent, and is taken back; the next one must not bring the
/// value earlier than the new policy allows.
#[test]
fn a_policy_that_delays_more_holds_the_value_released_last_back() {
    for (later, due) in [
        (r#"{"delayMs":60000}"#, 60_000),
        (r#"{"minimumIntervalMs":60000}"#, 60_000),
        (r#"{"rateLimits":[{"values":1,"periodMs":60000}]}"#, 0),
        (r#"{"workingHours":{"days":["FRIDAY"],"from":"09:00","until":"10:00"}}"#, 3_600_000),
    ] {
        let mut gate = gate("{}");
        gate.on(at(0), candidate(0, 1));
        assert!(gate.take_released());
        gate.change_policy(policy(later), at(10));
        assert_eq!(gate.take_released(), due == 0, "{later}");
        assert_eq!(gate.due(), Some(at(due)).filter(|_| due > 0), "{later}");
        gate.on_time(at(due.max(10)));
        assert_eq!(shown(&gate), Some(1), "{later}");
    }
    // What waits behind it stays behind it.
    let mut gate = gate(r#"{"delayMs":1000}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(900), candidate(900, 2));
    gate.on_time(at(1000));
    gate.change_policy(policy(r#"{"delayMs":2000}"#), at(1100));
    assert_eq!((gate.disclosed(), gate.due()), (None, Some(at(2900))));
    let state = gate.state();
    let mut gate = Gate::new(gate.policy().clone(), BuiltInType::Int64, state, at(1200));
    gate.on_time(at(2900));
    assert_eq!(shown(&gate), Some(2));
    // A looser policy shows on what was shown.
    gate.change_policy(policy(r#"{"delayMs":500}"#), at(3000));
    assert_eq!((shown(&gate), gate.due()), (Some(2), None));
}

#[test]
fn a_policy_that_coarsens_alike_changes_no_value() {
    let mut gate = gate(r#"{"roundingStep":70,"significantDigits":1}"#);
    gate.on(at(0), candidate(0, 140));
    assert_eq!(shown(&gate), Some(100));
    let alike = r#"{"roundingStep":70,"significantDigits":1,"minimumIntervalMs":5}"#;
    gate.change_policy(policy(alike), at(1));
    // It may be released once the interval is over.
    gate.on_time(at(5));
    assert_eq!(shown(&gate), Some(100), "rounded once more it would be 70");
}

#[test]
fn another_source_begins_with_its_own_values() {
    let mut gate = gate(r#"{"delayMs":1000,"withholdWhile":[{"states":[9]}]}"#);
    gate.on(at(0), candidate(0, 1));
    gate.on(at(500), candidate(500, 2));
    gate.on_time(at(1000));
    gate.close();
    gate.on_time(at(90_000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
    let mut lost = candidate(90_000, 0);
    lost.status = StatusCode::BAD_NO_DATA;
    assert_eq!(gate.on(at(90_000), lost), GateOutcome::Suppressed, "its state is not known");
}
