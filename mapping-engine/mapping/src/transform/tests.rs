use asi_model::{BuiltInType, Scalar, values::Array};
use proptest::prelude::*;
use serde_json::{Value as Json, json};

use super::*;
use crate::document::{Literal, Mapping};

mod functions;
mod models;

/// A mapping of inputs `a`, `b`, ... with these steps to a field of this type.
fn mapping(inputs: usize, target: &str, steps: &Json) -> Mapping {
    let names = ["a", "b", "c", "d"];
    let inputs: Vec<Json> = names[..inputs]
        .iter()
        .map(|name| json!({ "name": name, "sourceId": "press", "nodeId": format!("nsu=urn:press;s={name}") }))
        .collect();
    serde_json::from_value(json!({
        "mappingId": "m", "targetType": target, "inputs": inputs, "steps": steps,
        "target": { "operationNetworkId": "n", "operationId": "o", "dynamicDataRequestId": "r", "fieldName": "f" },
    }))
    .expect("a mapping")
}

fn transform(inputs: usize, target: &str, steps: &Json) -> Transform {
    let (plan, diagnostics) = compile(&Arc::new(mapping(inputs, target, steps)));
    Transform::new(Arc::new(plan.unwrap_or_else(|| panic!("{diagnostics:?}"))), None, None)
}

fn at(millis: i64) -> DateTime {
    DateTime::from_unix_micros(1_600_000_000_000_000 + millis * 1000)
}

fn literal(json: &Json) -> Variant {
    Literal::from_json(json).expect("a literal").to_variant()
}

/// Returns a reaction as JSON: the value with 64-bit integers as text, `null` for silence,
/// `!Status` for Bad.
fn said(reaction: Reaction) -> Json {
    match reaction {
        Reaction::Quiet => Json::Null,
        Reaction::Candidate(value) if severity(value.status) < 2 => {
            let Variant::Scalar(scalar) = &value.value else { return json!("[]") };
            if let Scalar::Int64(value) = scalar {
                return json!(value.to_string());
            }
            let plain = Literal(scalar.clone()).to_json();
            plain.get("value").cloned().unwrap_or(plain)
        }
        Reaction::Candidate(value) | Reaction::Failed(value, _) => {
            json!(format!("!{}", value.status.symbol().unwrap_or("?")))
        }
        Reaction::Call(_) => json!("call"),
    }
}

/// Feeds values of the first input, one per 100 ms, and compares what comes out.
fn check(target: &str, steps: Json, values: Json, expected: Json) {
    let mut transform = transform(1, target, &steps);
    let mut got = Vec::new();
    for (index, value) in values.as_array().expect("an array").iter().enumerate() {
        let time = at(index as i64 * 100);
        got.push(said(transform.on(time, 0, DataValue::good(literal(value), time), None)));
    }
    assert_eq!(Json::Array(got), expected, "{steps} of {values}");
}

fn typed(name: &str, value: Json) -> Json {
    json!({ "type": name, "value": value })
}

#[test]
fn status_follows_the_rules() {
    let mut transform = transform(1, "Int32", &json!([{"function": "deadband", "absolute": 5}]));
    let lost = StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE;
    let mut on = |millis, value: DataValue| transform.on(at(millis), 0, value, None);
    let good = |value: i32, millis| DataValue::good(value, at(millis));
    let with = |status, value: i32, millis| DataValue { status, ..good(value, millis) };
    assert_eq!(on(0, DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None)), {
        Reaction::Candidate(DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None))
    });
    assert_eq!(on(1, good(10, 1)), Reaction::Candidate(good(10, 1)));
    // Rule 5: the value stays, and its time.
    let away = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, Some(at(2)));
    assert_eq!(on(2, away.clone()), Reaction::Candidate(with(lost, 10, 1)));
    assert_eq!(on(3, away), Reaction::Quiet, "said once");
    // Rule 8: the deadband holds the new value back, but the old one is Good again.
    assert_eq!(on(4, good(12, 4)), Reaction::Candidate(good(10, 1)));
    // Rule 3: Bad is not evaluated and has no value.
    let bad = with(StatusCode::BAD_SENSOR_FAILURE, 99, 5);
    let said_bad = DataValue { value: Variant::Null, ..bad.clone() };
    assert_eq!(on(5, bad), Reaction::Candidate(said_bad));
    assert_eq!(on(6, good(12, 6)), Reaction::Candidate(good(10, 1)));
    // Rule 4: Uncertain is evaluated, and a change of status passes the deadband.
    assert_eq!(
        on(7, with(StatusCode::UNCERTAIN, 13, 7)),
        Reaction::Candidate(with(StatusCode::UNCERTAIN, 13, 7))
    );
}

#[test]
fn a_side_input_enters_where_it_is_used() {
    let steps = json!([
        {"function": "counter", "counts": "values"},
        {"function": "expression", "expression": "value * b"},
    ]);
    let mut transform = transform(2, "Int64", &steps);
    let mut on = |input, value: i32, millis| {
        said(transform.on(at(millis), input, DataValue::good(value, at(millis)), None))
    };
    on(1, 10, 0);
    assert_eq!(on(0, 5, 1), json!("10"));
    assert_eq!(on(0, 6, 2), json!("20"));
    assert_eq!(on(1, 100, 3), json!("200"), "the counter before it did not count again");
}

#[test]
fn late_and_repeated_values_are_distinguished() {
    let mut transform = transform(1, "Int32", &json!([]));
    let mut on = |value: i32, millis| {
        transform.on(at(0), 0, DataValue::good(value, at(millis)), None) != Reaction::Quiet
    };
    assert!(on(1, 20_000));
    assert!(!on(1, 20_000), "a repeat");
    assert!(!on(2, 19_000), "late");
    assert!(on(3, 20_001));
    assert!(on(4, 5_000), "a clock that was set back");
    assert_eq!(transform.counters, Counters { late: 1, repeated: 1, clock_steps: 1 });
}

#[test]
fn state_is_restored_through_json() {
    let steps = json!([
        {"function": "counter"}, {"function": "window", "aggregate": "sum", "samples": 3},
        {"function": "debounce", "quietMs": 10}, {"function": "deadband", "absolute": 1}, {"function": "rate"},
    ]);
    let mut original = transform(1, "Double", &steps);
    let feed = |transform: &mut Transform, range: std::ops::Range<i64>| -> Vec<Json> {
        let mut said_all = Vec::new();
        for index in range {
            said_all.push(said(transform.on(
                at(index * 20),
                0,
                DataValue::good(index * index, at(index * 20)),
                None,
            )));
            said_all.push(said(transform.on_timer(at(index * 20 + 10), None)));
        }
        said_all
    };
    feed(&mut original, 0..5);
    let stored = serde_json::to_string(&original.state().expect("state")).expect("serialises");
    let state: TransformState = serde_json::from_str(&stored).expect("reads back");
    assert_eq!(Some(&state), original.state().as_ref());
    let mut restored = Transform::new(Arc::clone(original.plan()), Some(state), None);
    assert_eq!(feed(&mut restored, 5..9), feed(&mut original, 5..9));
    let other = transform(1, "Double", &json!([{"function": "rate"}, {"function": "counter"}]));
    let foreign = Transform::new(Arc::clone(other.plan()), original.state(), None);
    assert_eq!(foreign.state(), other.state(), "state of other functions is not taken");
}

#[test]
fn all_faults_of_a_mapping_are_reported_at_once() {
    let wrong = json!([
        {"function": "scale", "divisor": 0},
        {"function": "window", "aggregate": "mean"},
        {"function": "expression", "expression": "value +\u{20}"},
        {"function": "lookup", "entries": [{"from": 1, "to": 2}, {"from": 1.0, "to": 3}]},
        {"function": "unitConversion", "from": "MTR", "to": "KGM"},
        {"function": "counter", "resetBy": "nobody"},
        {"function": "bit", "bit": 64},
        {"function": "parse", "to": "Int32", "pattern": "nothing"},
        {"function": "script", "source": ""},
    ]);
    let (plan, diagnostics) = compile(&Arc::new(mapping(1, "Int32", &wrong)));
    assert!(plan.is_none());
    let pointers: Vec<&str> = diagnostics.iter().map(|d| d.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/steps/0/divisor",
            "/steps/1/samples",
            "/steps/2/expression",
            "/steps/3/entries/1",
            "/steps/4",
            "/steps/5/resetBy",
            "/steps/6/bit",
            "/steps/7",
            "/steps/7/pattern",
            "/steps/8/source",
        ]
    );
    assert_eq!((diagnostics[2].line, diagnostics[2].column), (Some(1), Some(9)));
}

#[test]
fn types_are_followed_through_the_chain() {
    for (input, steps, target, pointer) in [
        ("String", json!([]), "Int32", Some("/targetType")),
        ("String", json!([{"function": "scale"}]), "Double", Some("/steps/0")),
        ("Int32", json!([{"function": "parse", "to": "Int32"}]), "Int32", Some("/steps/0")),
        ("Int32", json!([{"function": "convert", "to": "Guid"}]), "Guid", Some("/steps/0/to")),
        ("Boolean", json!([{"function": "counter"}]), "UInt64", None),
        ("Double", json!([{"function": "enumeration", "texts": []}]), "String", Some("/steps/0")),
        ("Int32", json!([{"function": "threshold", "limit": 1}]), "String", Some("/targetType")),
        ("Int32", json!([]), "UInt64", None),
    ] {
        let mut mapping = mapping(1, target, &steps);
        mapping.inputs[0].value_type = serde_json::from_value(json!(input)).expect("a type");
        let (_, diagnostics) = compile(&Arc::new(mapping));
        let errors: Vec<&str> =
            diagnostics.iter().filter(|d| d.is_error()).map(|d| d.pointer.as_str()).collect();
        assert_eq!(
            errors.first().copied(),
            pointer,
            "{input} through {steps} to {target}: {diagnostics:?}"
        );
    }
}

#[test]
fn a_window_over_time_is_fed_by_its_own_clock() {
    let steps = json!([{"function": "window", "aggregate": "sum", "durationMs": 1000}]);
    let mut mapping = mapping(1, "Int64", &steps);
    mapping.late_values = crate::document::LateValues::Use;
    let (plan, _) = compile(&Arc::new(mapping));
    let mut summing = Transform::new(Arc::new(plan.expect("compiles")), None, None);
    let mut on = |value: i32, millis| {
        said(summing.on(at(5000), 0, DataValue::good(value, at(millis)), None))
    };
    assert_eq!(on(1, 2000), json!("1"));
    assert_eq!(on(10, 2900), json!("11"));
    assert_eq!(on(100, 2500), json!("111"), "a late value takes its place");
    assert_eq!(on(1000, 3100), json!("1110"), "the first one left");
}

proptest! {
    #[test]
    fn chains_never_panic(
        steps in prop::collection::vec(models::any_step(), 0..5),
        values in prop::collection::vec((0_usize..3, models::any_value(), -50_000_i64..50_000), 0..20),
    ) {
        let (plan, _) = compile(&Arc::new(mapping(3, "Double", &Json::Array(steps))));
        if let Some(plan) = plan {
            let mut transform = Transform::new(Arc::new(plan), None, None);
            for (index, (input, value, millis)) in values.into_iter().enumerate() {
                let now = at(index as i64 * 500);
                let _ = transform.on(now, input, DataValue::good(value, at(millis)), None);
                let _ = transform.on_timer(now, None);
            }
            let state = transform.state();
            let json = serde_json::to_string(&state).expect("serialises");
            prop_assert_eq!(serde_json::from_str::<Option<TransformState>>(&json).expect("reads back"), state);
        }
    }
}
