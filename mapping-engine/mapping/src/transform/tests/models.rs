//! Naive models that the functions are compared with.

use std::time::Duration;

use asi_model::units as unece;

use super::*;

/// Multiplier and offset of a unit in the ontology QUDT (`asi-model/tests/units`).
fn qudt(code: &str) -> Option<(f64, f64)> {
    let table = include_str!("../../../../../asi-model/tests/units/qudt.tsv");
    let columns = |line: &'static str| line.split('\t').collect::<Vec<_>>();
    let found = table.lines().map(columns).find(|columns| columns[0] == code)?;
    Some((found[2].parse().ok()?, found[3].parse().ok()?))
}

pub(super) fn any_value() -> impl Strategy<Value = Variant> {
    prop_oneof![
        any::<i32>().prop_map(Variant::from),
        any::<u64>().prop_map(Variant::from),
        any::<bool>().prop_map(Variant::from),
        any::<f64>().prop_filter("comparable", |v| !v.is_nan()).prop_map(Variant::from),
        "[a-z0-9]{0,4}".prop_map(Variant::from),
        Just(Variant::Null),
    ]
}

pub(super) fn any_step() -> impl Strategy<Value = Json> {
    prop::sample::select(vec![
        json!({"function": "convert", "to": "Int32"}),
        json!({"function": "convert", "to": "String"}),
        json!({"function": "scale", "factor": 3, "divisor": 7, "offset": 1}),
        json!({"function": "increment", "modulus": 256}),
        json!({"function": "counter", "resetBy": "b"}),
        json!({"function": "edge", "direction": "both"}),
        json!({"function": "threshold", "limit": 5}),
        json!({"function": "debounce", "quietMs": 300}),
        json!({"function": "deadband", "absolute": 1}),
        json!({"function": "rate"}),
        json!({"function": "window", "aggregate": "mean", "durationMs": 2000}),
        json!({"function": "window", "aggregate": "count", "samples": 2}),
        json!({"function": "bit", "bit": 63}),
        json!({"function": "format", "template": "{value}-{c}"}),
        json!({"function": "parse", "to": "Double"}),
        json!({"function": "expression", "expression": "value * 2 - b"}),
        json!({"function": "merge", "rule": "newest"}),
        json!({"function": "merge", "rule": "firstGood", "inputs": ["b", "c"]}),
        json!({"function": "merge", "rule": "sum"}),
    ])
}

/// Late, but within the window, and of any sign.
fn samples() -> impl Strategy<Value = Vec<(i64, i64)>> {
    prop::collection::vec((any::<i64>(), 1_i64..400), 1..60)
}

fn aggregate(name: &str, values: &[i64]) -> Option<Json> {
    let text = |value: i128| Some(json!(value.to_string()));
    let sum: i128 = values.iter().map(|v| i128::from(*v)).sum();
    match name {
        "minimum" => text((*values.iter().min()?).into()),
        "maximum" => text((*values.iter().max()?).into()),
        "last" => text((*values.last()?).into()),
        "count" => text(values.len() as i128),
        "mean" if values.is_empty() => None,
        "mean" => Some(json!(sum as f64 / values.len() as f64)),
        // Beyond 64 bits the result is a double and the Int64 target says so.
        "sum" => match i64::try_from(sum) {
            Ok(sum) => text(sum.into()),
            Err(_) => Some(json!("!BadOutOfRange")),
        },
        _ => None,
    }
}

const AGGREGATES: [&str; 6] = ["minimum", "maximum", "last", "count", "mean", "sum"];

fn target(name: &str) -> &'static str {
    if name == "mean" { "Double" } else { "Int64" }
}

proptest! {
    #[test]
    fn windows_of_samples_are_slices(samples in samples(), size in 1_usize..10) {
        for name in AGGREGATES {
            let steps = json!([{"function": "window", "aggregate": name, "samples": size}]);
            let mut window = transform(1, target(name), &steps);
            let mut time = 0;
            for (index, (value, gap)) in samples.iter().enumerate() {
                time += gap;
                let got = said(window.on(at(time), 0, DataValue::good(*value, at(time)), None));
                let all: Vec<i64> = samples[..=index].iter().map(|(v, _)| *v).collect();
                let expected = aggregate(name, &all[all.len().saturating_sub(size)..]).unwrap_or(Json::Null);
                prop_assert_eq!(got, expected, "{} at {}", name, index);
            }
        }
    }

    #[test]
    fn windows_of_time_are_filters(samples in samples(), span in 100_i64..1000) {
        for name in AGGREGATES {
            let steps = json!([{"function": "window", "aggregate": name, "durationMs": span}]);
            let mut window = transform(1, target(name), &steps);
            let mut time = 0;
            let mut seen: Vec<(i64, i64)> = Vec::new();
            for (value, gap) in &samples {
                time += gap;
                seen.push((time, *value));
                let got = said(window.on(at(time), 0, DataValue::good(*value, at(time)), None));
                let inside: Vec<i64> = seen.iter().filter(|(t, _)| *t > time - span).map(|(_, v)| *v).collect();
                prop_assert_eq!(got, aggregate(name, &inside).unwrap_or(Json::Null), "{} at {}", name, time);
            }
        }
    }

    #[test]
    fn time_alone_empties_windows_as_the_filter_does(samples in samples(), span in 100_i64..1000) {
        let steps = json!([{"function": "window", "aggregate": "count", "durationMs": span}]);
        let mut window = transform(1, "Int64", &steps);
        let mut times = Vec::new();
        let mut time = 0;
        for (value, gap) in &samples {
            time += gap;
            times.push(time);
            window.on(at(time), 0, DataValue::good(*value, at(time)), None);
        }
        while let Some(due) = window.due() {
            let now = (due.unix_micros() - at(0).unix_micros()) / 1000;
            let inside = times.iter().filter(|t| **t > now - span).count();
            prop_assert_eq!(said(window.on_timer(due, None)), json!(inside.to_string()));
        }
    }

    #[test]
    fn a_counter_is_the_sum_of_what_was_counted(
        steps in prop::collection::vec(0_u64..30_000, 1..50),
        start in any::<u16>(),
        modulus in prop::sample::select(vec![65_536_u64, 100_000]),
    ) {
        // Less than half of the modulus between two values, so that a wrap can be told from a
        // reset.
        let chain = json!([{"function": "counter", "modulus": modulus}]);
        let mut counter = transform(1, "UInt64", &chain);
        let mut raw = u64::from(start) % modulus;
        let mut total = 0;
        counter.on(at(0), 0, DataValue::good(raw, at(0)), None);
        for (index, step) in steps.iter().enumerate() {
            let time = at(index as i64 + 1);
            raw = (raw + step) % modulus;
            total += step;
            prop_assert_eq!(said(counter.on(time, 0, DataValue::good(raw, time), None)), json!(total.to_string()));
        }
    }

    #[test]
    fn debounce_shows_what_held_long_enough(values in prop::collection::vec((0_i32..3, 1_i64..200), 1..40)) {
        let quiet = 100;
        let mut debounce = transform(1, "Int32", &json!([{"function": "debounce", "quietMs": quiet}]));
        let (mut time, mut held): (i64, Option<(i32, i64)>) = (0, None);
        let (mut expected, mut got): (Vec<i32>, Vec<i32>) = (Vec::new(), Vec::new());
        let take = |reaction, got: &mut Vec<i32>| if let Reaction::Candidate(value) = reaction {
            got.extend(value.value.as_scalar().and_then(Scalar::as_i128).and_then(|v| i32::try_from(v).ok()));
        };
        for (value, gap) in values {
            time += gap;
            while let Some(due) = debounce.due().filter(|due| *due <= at(time)) {
                take(debounce.on_timer(due, None), &mut got);
            }
            // The model: a value that has stood for the span when the next one comes is shown,
            // unless it is already.
            if let Some((old, since)) = held
                && time - since >= quiet
                && expected.last() != Some(&old)
            {
                expected.push(old);
            }
            if held.is_none_or(|(old, _)| old != value) {
                held = Some((value, time));
            }
            take(debounce.on(at(time), 0, DataValue::good(value, at(time)), None), &mut got);
        }
        prop_assert_eq!(got, expected);
    }

    #[test]
    fn rates_are_difference_quotients(a in any::<i32>(), b in any::<i32>(), gap in 1_i64..100_000) {
        let mut rate = transform(1, "Double", &json!([{"function": "rate", "per": "hour"}]));
        rate.on(at(0), 0, DataValue::good(a, at(0)), None);
        let Reaction::Candidate(value) = rate.on(at(gap), 0, DataValue::good(b, at(gap)), None) else {
            panic!("two values have a rate")
        };
        let expected = (f64::from(b) - f64::from(a)) / (gap as f64 / 1000.0) * 3600.0;
        let got = value.value.as_f64().expect("a double");
        prop_assert!((got - expected).abs() <= expected.abs() * 1e-12);
    }

    #[test]
    fn unit_conversions_agree_with_the_table(value in -1.0e6_f64..1.0e6, from in any::<prop::sample::Index>(), to in any::<prop::sample::Index>()) {
        let units: Vec<_> = unece::EngineeringUnit::all().collect();
        let from = units[from.index(units.len())];
        let alike: Vec<_> = units.iter().filter(|unit| unece::convert(0.0, &from, unit).is_ok()).collect();
        prop_assume!(!alike.is_empty());
        let to = alike[to.index(alike.len())];
        let steps = json!([{"function": "unitConversion", "from": from.code, "to": to.code}]);
        let mut conversion = transform(1, "Double", &steps);
        let expected = unece::convert(value, &from, to).expect("alike");
        let Reaction::Candidate(got) = conversion.on(at(0), 0, DataValue::good(value, at(0)), None) else {
            panic!("a conversion yields")
        };
        let got = got.value.as_f64().expect("a double");
        let scale = expected.abs().max(unece::convert(0.0, &from, to).expect("alike").abs());
        prop_assert!((got - expected).abs() <= scale * 1e-12, "{} {} to {}: {} not {}", value, from.code, to.code, got, expected);
        // Others' factors are rounded, and some units are ours alone.
        if let (Some((multiplier, offset)), Some((divisor, subtrahend))) = (qudt(from.code), qudt(to.code)) {
            let expected = (value + offset) * multiplier / divisor - subtrahend;
            prop_assert!((got - expected).abs() <= scale * 3e-6, "{} {} to {}: {} not {}", value, from.code, to.code, got, expected);
        }
        // Integers: the same value, exactly where it is one.
        let integer = value.trunc();
        let Reaction::Candidate(got) = conversion.on(at(1), 0, DataValue::good(integer as i64, at(1)), None) else {
            panic!("a conversion yields")
        };
        let expected = unece::convert(integer, &from, to).expect("alike");
        let got = got.value.as_f64().expect("a double");
        prop_assert!((got - expected).abs() <= scale * 1e-9);
    }

    #[test]
    fn deadbands_bound_the_error(values in prop::collection::vec(-1000_i32..1000, 1..60), band in 0_u32..50) {
        let mut deadband = transform(1, "Int32", &json!([{"function": "deadband", "absolute": band}]));
        let mut shown = None;
        for (index, value) in values.into_iter().enumerate() {
            let time = at(index as i64);
            if let Reaction::Candidate(candidate) = deadband.on(time, 0, DataValue::good(value, time), None) {
                prop_assert!(shown.is_none_or(|old: f64| (old - f64::from(value)).abs() > f64::from(band)));
                shown = candidate.value.as_f64();
            }
            prop_assert!(shown.is_some_and(|shown| (shown - f64::from(value)).abs() <= f64::from(band)));
        }
    }
}

#[test]
fn a_window_keeps_at_most_so_many_samples() {
    let steps = json!([{"function": "window", "aggregate": "count", "durationMs": 3_600_000}]);
    let mut window = transform(1, "Int64", &steps);
    let mut last = Json::Null;
    for index in 0..5000 {
        last = said(window.on(at(index), 0, DataValue::good(index, at(index)), None));
    }
    assert_eq!(last, json!("4096"));
    assert!(window.due().is_some_and(|due| due > at(0).after(Duration::from_secs(3600))));
}
