//! Each function alone, on the values of one or more inputs.

use super::*;

#[test]
fn numbers_are_coerced_converted_and_computed() {
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
        "Int64",
        json!([{"function": "expression", "expression": "value * 2 + 1"}]),
        json!([20, "x"]),
        json!(["41", "!BadTypeMismatch"]),
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
fn signals_pass_when_they_change() {
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
        json!([{"function": "deadband"}, {"function": "constant", "value": "fixed"}]),
        json!([1]),
        json!(["fixed"]),
    );
}

#[test]
fn tables_bits_and_texts_have_a_meaning() {
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
        "the same value does not start the wait again"
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
