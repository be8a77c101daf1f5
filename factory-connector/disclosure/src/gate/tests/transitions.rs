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
    gate.close(at(1000));
    gate.on_time(at(90_000));
    assert_eq!((gate.disclosed(), gate.due()), (None, None));
    let mut lost = candidate(90_000, 0);
    lost.status = StatusCode::BAD_NO_DATA;
    assert_eq!(gate.on(at(90_000), lost), GateOutcome::Suppressed, "its state is not known");
}

const HOUR_MS: u64 = 3_600_000;
const HOURLY_MEAN: &str = r#"{"aggregate":{"function":"MEAN","windowMs":3600000}}"#;

/// Returns a gate whose consent begins at this time, with values before and after.
fn consented_at(ms: u64) -> Gate {
    let mut gate = gate(HOURLY_MEAN);
    gate.on(at(0), candidate(0, 50));
    gate.close(at(ms));
    gate.change_policy(policy(HOURLY_MEAN), at(ms));
    gate.on(at(ms), candidate(ms, 10));
    gate.on(at(ms + 1_000), candidate(ms + 1_000, 30));
    gate
}

#[test]
fn a_consent_that_begins_within_a_window_releases_no_part_of_it() {
    let mut gate = consented_at(HOUR_MS - 60_000);
    gate.on_time(at(HOUR_MS));
    assert_eq!(gate.disclosed(), None, "the mean of a minute");
    assert_eq!(gate.due(), Some(at(2 * HOUR_MS)), "without another candidate");
    gate.on_time(at(2 * HOUR_MS));
    assert_eq!(shown(&gate), Some(30), "the first window that is covered whole");
    // After a restart, and where nobody looked at the gate for long, too.
    let begun = consented_at(HOUR_MS - 60_000);
    let stored = gate_from_json(&gate_to_json(&begun.state())).expect("it reads what it wrote");
    let mut gate = Gate::new(policy(HOURLY_MEAN), BuiltInType::Int64, stored, at(HOUR_MS));
    gate.on(at(2 * HOUR_MS + HOUR_MS / 2), candidate(0, 70));
    assert_eq!(shown(&gate), Some(30));
    gate.on_time(at(3 * HOUR_MS));
    assert_eq!(shown(&gate), Some(50), "half of the window 30, half 70");
    // A consent on the boundary covers its first window.
    let mut gate = consented_at(HOUR_MS);
    gate.on_time(at(2 * HOUR_MS));
    assert!(shown(&gate).is_some_and(|mean| mean >= 29));
}

#[test]
fn windows_of_another_policy_begin_whole() {
    let mut gate = gate("{}");
    gate.on(at(0), candidate(0, 1));
    gate.change_policy(policy(HOURLY_MEAN), at(HOUR_MS - 1));
    gate.on(at(HOUR_MS - 1), candidate(0, 7));
    gate.on_time(at(HOUR_MS));
    assert_eq!(gate.disclosed(), None);
    gate.on_time(at(2 * HOUR_MS));
    assert_eq!(shown(&gate), Some(7));
}

#[test]
fn consents_that_toggle_get_at_most_one_mean_per_whole_window() {
    let mut gate = gate(HOURLY_MEAN);
    let mut released = Vec::new();
    for minute in 0..4 * 60 {
        let now = minute * 60_000;
        gate.on(at(now), candidate(now, i64::try_from(minute).expect("small")));
        if gate.take_released() {
            released.push((minute, shown(&gate)));
        }
        // The partner changes its request every few minutes of the second hour.
        if (60..120).contains(&minute) && minute % 7 == 3 {
            gate.close(at(now + 1));
            gate.change_policy(policy(HOURLY_MEAN), at(now + 1));
        }
    }
    assert_eq!(released, [(60, Some(30)), (180, Some(150))], "of the second hour nothing");
}

#[test]
fn rates_and_intervals_go_on_for_values_of_another_type() {
    for limits in
        [r#"{"minimumIntervalMs":1000}"#, r#"{"rateLimits":[{"values":1,"periodMs":1000}]}"#]
    {
        let mut gate = gate(limits);
        gate.on(at(0), candidate(0, 1));
        gate.change_type(BuiltInType::Double, at(10));
        gate.change_policy(policy("{}"), at(20));
        gate.change_policy(policy(limits), at(30));
        gate.on(at(40), DataValue::good(2.5, at(40)));
        assert_eq!((gate.disclosed(), gate.due()), (None, Some(at(1000))), "{limits}");
    }
}

#[test]
fn a_rate_goes_on_after_a_policy_with_fewer_values() {
    let (many, few) = (
        r#"{"rateLimits":[{"values":3,"periodMs":1000}]}"#,
        r#"{"rateLimits":[{"values":1,"periodMs":10}]}"#,
    );
    let mut gate = gate(many);
    for ms in 0..3 {
        gate.on(at(ms), candidate(ms, i64::try_from(ms).expect("small")));
    }
    assert_eq!(shown(&gate), Some(2));
    gate.change_policy(policy(few), at(50));
    gate.on(at(60), candidate(60, 3));
    assert_eq!(shown(&gate), Some(3));
    gate.change_policy(policy(many), at(100));
    gate.on(at(110), candidate(110, 4));
    // At 2, at 50 - what was shown waits for the new policy, and leaves again by it - and at 60.
    assert_eq!(gate.due(), Some(at(1002)), "three of the last second count, by whichever policy");
}

#[test]
fn a_rate_goes_on_after_a_policy_without_one() {
    let limits = r#"{"rateLimits":[{"values":1,"periodMs":1000}]}"#;
    let mut gate = gate(limits);
    gate.on(at(0), candidate(0, 1));
    gate.change_policy(policy(r#"{"timeStepMs":10}"#), at(10));
    gate.on(at(20), candidate(20, 2));
    assert_eq!(shown(&gate), Some(2));
    gate.change_policy(policy(limits), at(30));
    gate.on(at(40), candidate(40, 3));
    assert_eq!((shown(&gate), gate.due()), (None, Some(at(1000))), "one in a second");
}
