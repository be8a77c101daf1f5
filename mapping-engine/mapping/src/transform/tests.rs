use asi_model::{BuiltInType, Scalar, values::Array};
use proptest::prelude::*;
use serde_json::{Value as Json, json};

use super::*;
use crate::document::{Literal, Mapping};

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

/// What a reaction says: the value in JSON with 64-bit integers as text, `null` for silence,
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
fn single_functions() {
    let max = "18446744073709551615";
    check("UInt64", json!([]), json!([typed("UInt64", json!(max))]), json!([max]));
    check("String", json!([]), json!(["00123"]), json!(["00123"]));
    check("Int32", json!([]), json!(["00123"]), json!(["!BadTypeMismatch"]));
    check("Byte", json!([]), json!([300, 7]), json!(["!BadOutOfRange", 7]));
    check(
        "UInt16",
        json!([{"function": "convert", "to": "UInt16", "overflow": "clamp"}]),
        json!([70000, -1]),
        json!([65535, 0]),
    );
    check(
        "UInt64",
        json!([{"function": "scale", "factor": 1, "offset": -1}]),
        json!([typed("UInt64", json!(max))]),
        json!(["18446744073709551614"]),
    );
    check(
        "Double",
        json!([{"function": "scale", "factor": 0.1, "offset": 5}]),
        json!([15]),
        json!([6.5]),
    );
    check(
        "Int64",
        json!([{"function": "scale", "divisor": 4}]),
        json!([8, 9]),
        json!(["2", "!BadOutOfRange"]),
    );
    check(
        "Int64",
        json!([{"function": "unitConversion", "from": "MTR", "to": "MMT"}]),
        json!([9007199254740993_i64]),
        json!(["9007199254740993000"]),
    );
    check(
        "Double",
        json!([{"function": "unitConversion", "from": "MIN", "to": "SEC"}]),
        json!([1.5]),
        json!([90.0]),
    );
    check(
        "Boolean",
        json!([{"function": "threshold", "limit": 80, "release": 70}]),
        json!([79, 80, 75, 69, 75]),
        json!([false, true, true, false, false]),
    );
    check(
        "String",
        json!([{"function": "threshold", "limit": 1, "above": "hot", "below": "cold"}]),
        json!([2, 0]),
        json!(["hot", "cold"]),
    );
    check(
        "Boolean",
        json!([{"function": "edge", "direction": "rising"}]),
        json!([true, false, true, true, false]),
        json!([null, null, true, null, null]),
    );
    check(
        "Boolean",
        json!([{"function": "edge", "direction": "both"}]),
        json!([1, 0, 0, 5]),
        json!([null, false, null, true]),
    );
    check(
        "Int32",
        json!([{"function": "deadband"}]),
        json!([1, 1, 2, 2]),
        json!([1, null, 2, null]),
    );
    check(
        "Int32",
        json!([{"function": "deadband", "absolute": 2}]),
        json!([1, 3, 4, 2, 1]),
        json!([1, null, 4, null, 1]),
    );
    check(
        "Double",
        json!([{"function": "deadband", "percent": 10}]),
        json!([100.5, 110.5, 111.5]),
        json!([100.5, null, 111.5]),
    );
    check(
        "Double",
        json!([{"function": "rate", "per": "minute"}]),
        json!([0, 1, 1, 0]),
        json!([null, 600.0, 0.0, -600.0]),
    );
    check(
        "String",
        json!([{"function": "enumeration", "texts": [{"value": 0, "text": "idle"}, {"value": 3, "text": "run"}]}]),
        json!([3, 0, 7]),
        json!(["run", "idle", "7"]),
    );
    check(
        "Boolean",
        json!([{"function": "bit", "bit": 3}]),
        json!([8, 7, -1]),
        json!([true, false, true]),
    );
    check(
        "String",
        json!([{"function": "bitTexts", "bits": [{"bit": 2, "text": "door"}, {"bit": 0, "text": "stop"}], "none": "ok"}]),
        json!([5, 0, 4]),
        json!(["stop, door", "ok", "door"]),
    );
    check(
        "String",
        json!([{"function": "lookup", "entries": [{"from": 1, "to": "a"}, {"from": 2.5, "to": "b"}, {"from": "x", "to": "c"}]}]),
        json!([1.0, 2.5, "x", 9]),
        json!(["a", "b", "c", "!BadOutOfRange"]),
    );
    check(
        "Double",
        json!([{"function": "lookup", "interpolate": true, "entries": [{"from": 10, "to": 100}, {"from": 0, "to": 0}]}]),
        json!([5, -3, 12, 10]),
        json!([50.0, 0.0, 100.0, 100.0]),
    );
    check(
        "String",
        json!([{"function": "format", "template": "{value:04} of {a}"}]),
        json!([7]),
        json!(["0007 of 7"]),
    );
    check(
        "Int32",
        json!([{"function": "parse", "to": "Int32", "pattern": "n={};"}]),
        json!(["n=42;", "n=x;"]),
        json!([42, "!BadDecodingError"]),
    );
    check(
        "Int64",
        json!([{"function": "expression", "expression": "value * 2 + 1"}]),
        json!([20, "x"]),
        json!(["41", "!BadTypeMismatch"]),
    );
    check(
        "String",
        json!([{"function": "deadband"}, {"function": "constant", "value": "fixed"}]),
        json!([1]),
        json!(["fixed"]),
    );
    check("Double", json!([{"function": "merge", "rule": "mean"}]), json!([4]), json!([4.0]));
    check(
        "Double",
        json!([{"function": "script", "source": "(v) => v"}]),
        json!([4]),
        json!(["call"]),
    );
}

#[test]
fn a_constant_speaks_once() {
    let mut constant = transform(0, "String", &json!([{"function": "constant", "value": "fixed"}]));
    assert_eq!(constant.start(at(7), None), Reaction::Candidate(DataValue::good("fixed", at(7))));
}

#[test]
fn counters_go_on_across_wraps_and_resets() {
    let wrap = json!([{"function": "increment", "modulus": 65536}]);
    check("Int64", wrap, json!([65530, 65535, 4, 4, 3]), json!([null, "5", "5", "0", "3"]));
    check(
        "Int64",
        json!([{"function": "increment", "onDecrease": "set"}]),
        json!([5, 3, 7]),
        json!([null, "0", "4"]),
    );
    check(
        "Int64",
        json!([{"function": "increment", "onDecrease": "subtract"}]),
        json!([5, 3]),
        json!([null, "-2"]),
    );
    check(
        "UInt64",
        json!([{"function": "counter", "start": 100}]),
        json!([7, 9, 2, 3]),
        json!(["100", "102", "104", "105"]),
    );
    check(
        "Int32",
        json!([{"function": "counter"}]),
        json!([true, false, true, true, false, true]),
        json!([0, 0, 1, 1, 1, 2]),
    );
    check(
        "Int32",
        json!([{"function": "counter", "counts": "values"}]),
        json!(["x", "x"]),
        json!([1, 2]),
    );
}

#[test]
fn a_counter_is_reset_by_an_input() {
    let steps = json!([{"function": "counter", "resetBy": "b"}]);
    let mut transform = transform(2, "Int64", &steps);
    let mut feed = |input, value: Variant, millis| {
        said(transform.on(at(millis), input, DataValue::good(value, at(millis)), None))
    };
    assert_eq!(feed(0, 5_i32.into(), 0), Json::Null, "b has not come yet");
    assert_eq!(feed(1, false.into(), 1), Json::Null);
    assert_eq!(feed(0, 8_i32.into(), 2), json!("0"));
    assert_eq!(feed(0, 10_i32.into(), 3), json!("2"));
    assert_eq!(feed(1, true.into(), 4), json!("0"));
    assert_eq!(feed(0, 11_i32.into(), 5), json!("1"));
}

#[test]
fn debounce_waits_for_quiet() {
    let mut transform = transform(1, "Int32", &json!([{"function": "debounce", "quietMs": 100}]));
    let good = |value: i32, millis| DataValue::good(value, at(millis));
    assert_eq!(transform.on(at(0), 0, good(1, 0), None), Reaction::Quiet);
    assert_eq!(transform.due(), Some(at(100)));
    assert_eq!(transform.on(at(50), 0, good(2, 50), None), Reaction::Quiet);
    assert_eq!(
        transform.on(at(90), 0, good(2, 90), None),
        Reaction::Quiet,
        "the same value does not start anew"
    );
    assert_eq!(transform.on_timer(at(149), None), Reaction::Quiet);
    assert_eq!(transform.on_timer(at(150), None), Reaction::Candidate(good(2, 90)));
    assert_eq!(transform.due(), None);
    assert_eq!(transform.on(at(200), 0, good(3, 200), None), Reaction::Quiet);
    assert_eq!(
        transform.on(at(210), 0, good(2, 210), None),
        Reaction::Quiet,
        "back to what is shown"
    );
    assert_eq!(transform.due(), None);
}

#[test]
fn windows_of_time_empty_by_themselves() {
    let steps = json!([{"function": "window", "aggregate": "count", "durationMs": 1000}]);
    let mut counting = transform(1, "Int64", &steps);
    // The source's clock is an hour behind.
    let source = |millis| at(millis - 3_600_000);
    for (millis, expected) in [(0, "1"), (400, "2")] {
        let value = DataValue::good(f64::from(millis as i32), source(millis));
        assert_eq!(said(counting.on(at(millis), 0, value, None)), json!(expected));
    }
    assert_eq!(counting.due(), Some(at(1000)));
    let one = counting.on_timer(at(1000), None);
    let Reaction::Candidate(value) = &one else { panic!("{one:?}") };
    assert_eq!((value.value.clone(), value.source_timestamp), (1_i64.into(), Some(source(400))));
    assert_eq!(counting.due(), Some(at(1400)));
    assert_eq!(said(counting.on_timer(at(1400), None)), json!("0"));
    assert_eq!(counting.due(), None);

    let steps = json!([{"function": "window", "aggregate": "maximum", "durationMs": 1000}]);
    let mut greatest = transform(1, "Int32", &steps);
    for (millis, value) in [(0, 9), (400, 3)] {
        greatest.on(at(millis), 0, DataValue::good(value, at(millis)), None);
    }
    assert_eq!(said(greatest.on_timer(at(1000), None)), json!(3));
    assert_eq!(greatest.due(), None, "what does not change still holds");
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
fn merges_pick_or_combine() {
    let good = |value: i32, millis| DataValue::good(value, at(millis));
    let mut first = transform(2, "Int32", &json!([{"function": "merge", "rule": "firstGood"}]));
    assert_eq!(
        first.on(at(0), 1, good(20, 0), None),
        Reaction::Candidate(good(20, 0)),
        "one of them is enough"
    );
    assert_eq!(first.on(at(1), 0, good(10, 1), None), Reaction::Candidate(good(10, 1)));
    let away = DataValue::status_only(StatusCode::BAD_NOT_CONNECTED, None);
    assert_eq!(
        first.on(at(2), 0, away.clone(), None),
        Reaction::Candidate(good(20, 0)),
        "the other one takes over"
    );
    let mut sum = transform(2, "Int64", &json!([{"function": "merge", "rule": "sum"}]));
    assert_eq!(sum.on(at(0), 0, good(10, 0), None), Reaction::Quiet, "all are needed");
    assert_eq!(said(sum.on(at(1), 1, good(20, 1), None)), json!("30"));
    let Reaction::Candidate(value) = sum.on(at(2), 1, away, None) else {
        panic!("the status is worse")
    };
    assert_eq!(value.status, StatusCode::UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE);
    assert_eq!(value.source_timestamp, Some(at(1)));
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
fn late_and_repeated_values_are_told_apart() {
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
fn arrays_pass_and_are_selected() {
    let array = Variant::Array(Arc::new(Array {
        element_type: BuiltInType::Int32,
        elements: vec![1_i32.into(), 2_i32.into()],
        dimensions: None,
    }));
    let mut element = transform(1, "Int32", &json!([{"function": "select", "path": "[1]"}]));
    assert_eq!(said(element.on(at(0), 0, DataValue::good(array.clone(), at(0)), None)), json!(2));
    let mut whole = transform(1, "Int32", &json!([]));
    assert_eq!(
        said(whole.on(at(0), 0, DataValue::good(array, at(0)), None)),
        json!("!BadTypeMismatch")
    );
}

#[test]
fn wrong_mappings_are_told_everything_at_once() {
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
