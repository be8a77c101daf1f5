//! Parts of policies by themselves.

use super::*;

/// All hours of a policy apply. The tests begin on a Friday at 08:00.
#[test]
fn a_value_leaves_within_further_hours_only() {
    let mut gate = gate(
        r#"{"workingHours":{"days":["FRIDAY"],"from":"06:00","until":"22:00"},
            "furtherHours":[{"days":["FRIDAY"],"from":"08:10","until":"20:00"}]}"#,
    );
    let until = at(600_000);
    assert_eq!(gate.on(at(0), candidate(0, 1)), GateOutcome::Withheld { until });
    gate.on_time(at(300_000));
    assert_eq!(shown(&gate), None);
    gate.on_time(until);
    assert_eq!(shown(&gate), Some(1));
}

/// 10 holds for ten seconds and 40 for twenty; the state of the other field for thirty.
#[test]
fn a_mean_does_not_weigh_the_time_in_a_withheld_state_of_another_field() {
    let other: FieldName = "state".parse().expect("a name");
    let mut gate = gate(
        r#"{"aggregate":{"function":"MEAN","windowMs":60000},
            "withholdWhile":[{"field":"state","states":["SETUP"]}]}"#,
    );
    gate.on_state(at(0), &other, Some(false));
    gate.on(at(0), candidate(0, 10));
    gate.on_state(at(10_000), &other, Some(true));
    gate.on_state(at(40_000), &other, Some(false));
    gate.on(at(40_000), candidate(40_000, 40));
    gate.on_time(at(60_000));
    assert_eq!(shown(&gate), Some(30));
}

/// 10 holds for ten seconds, the state in which nothing is shown for thirty, and 40 for twenty.
#[test]
fn a_mean_does_not_weigh_the_time_in_a_withheld_state_of_its_own() {
    let mut gate = gate(
        r#"{"aggregate":{"function":"MEAN","windowMs":60000},"withholdWhile":[{"states":[7]}]}"#,
    );
    gate.on(at(0), candidate(0, 10));
    assert_eq!(gate.on(at(10_000), candidate(10_000, 7)), GateOutcome::Suppressed);
    gate.on(at(40_000), candidate(40_000, 40));
    gate.on_time(at(60_000));
    assert_eq!(shown(&gate), Some(30));
}
