//! Status codes and bits of "not a number", which machine, script or client choose freely.

use super::*;

/// A script returns `{ value: 0, status: 0x40000000 + v }`.
#[test]
fn a_script_made_status_carries_no_value_past_the_gate() {
    let mut gate = gate(r#"{"roundingStep":100}"#);
    let mut released = Vec::new();
    for (base, count) in [(0x4000_0000, 40_u32), (0x0000_0000, 40), (0x8000_0000, 40)] {
        for secret in 0..count {
            let made = DataValue { status: StatusCode(base + secret * 7919), ..candidate(0, 0) };
            gate.on(at(0), made);
            if gate.take_released() {
                released.push(gate.disclosed().map(|value| value.status));
            }
        }
    }
    let expected = [StatusCode::UNCERTAIN, StatusCode::GOOD, StatusCode::BAD];
    assert_eq!(released, expected.map(Some));
}

#[test]
fn a_status_from_before_the_policy_knew_them_is_coarsened_at_the_start() {
    let fine = |ms| DataValue { status: StatusCode::BAD_SENSOR_FAILURE, ..candidate(ms, 0) };
    let state = GateState {
        disclosed: Some(Released::by_gate(fine(0))),
        waiting: [(at(0), fine(1))].into(),
        ..GateState::default()
    };
    let policy: DisclosurePolicy = serde_json::from_str(r#"{"delayMs":1000}"#).expect("a policy");
    let gate = Gate::new(Arc::new(policy), BuiltInType::Int64, state, at(1));
    let GateState { disclosed, waiting, .. } = gate.state();
    let statuses =
        waiting.iter().map(|(_, value)| value).chain(disclosed.as_deref()).map(|v| v.status);
    assert!(statuses.eq([StatusCode::BAD; 2]));
}

#[test]
fn not_a_number_carries_no_bits() {
    let mut gate = Gate::new(Arc::default(), BuiltInType::Double, GateState::default(), at(0));
    gate.on(at(0), DataValue::good(f64::from_bits(f64::NAN.to_bits() | 4711), at(0)));
    let shown = gate.disclosed().and_then(|value| value.value.as_f64()).expect("a number");
    assert_eq!(shown.to_bits(), f64::NAN.to_bits());
}
