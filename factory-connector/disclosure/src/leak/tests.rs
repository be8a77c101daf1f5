use std::sync::Arc;

use asi_model::network::{Operation, ReportField};
use serde_json::{Value, json};

use super::*;
use crate::DisclosurePolicy;

fn operation() -> Operation {
    serde_json::from_value(
        json!({ "operationId": "op", "operationType": "PRODUCTION", "plannedQuantity": 100,
        "plannedStart": "2026-11-21T06:00:00Z", "plannedEnd": "2026-11-21T16:00:00Z" }),
    )
    .expect("an operation")
}

/// Computes the budget of fields, each a definition with its policy.
fn budget(fields: &[(Value, Value)]) -> LeakBudget {
    with_open(fields, leak_budget)
}

fn with_open<T>(fields: &[(Value, Value)], look: impl FnOnce(&[OpenField<'_>]) -> T) -> T {
    let operation = operation();
    let owned: Vec<(FieldKey, ReportField, DisclosurePolicy)> = fields
        .iter()
        .map(|(definition, policy)| {
            let definition: ReportField = serde_json::from_value(definition.clone()).expect("a field");
            let key = json!({ "operationNetworkId": "n", "operationId": "op", "dynamicDataRequestId": "R",
                "fieldName": definition.name });
            let key = serde_json::from_value(key).expect("a key");
            (key, definition, serde_json::from_value(policy.clone()).expect("a policy"))
        })
        .collect();
    let measured = MeasuredRelease { released: 10, hours: 2.0 };
    let open: Vec<OpenField<'_>> = owned
        .iter()
        .map(|(key, definition, policy)| OpenField {
            key,
            definition,
            operation: &operation,
            policy,
            variables: Arc::default(),
            measured,
        })
        .collect();
    look(&open)
}

fn conclusions(fields: &[(Value, Value)]) -> Vec<Conclusion> {
    budget(fields).warnings.into_iter().map(|warning| warning.conclusion).collect()
}

#[test]
fn conclusions_follow_from_what_is_open_together() {
    use Conclusion as C;
    let made = || json!({ "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" });
    let scrap = || json!({ "name": "scrap", "type": 9, "semantic": "SCRAP_QUANTITY" });
    let share = || json!({ "name": "share", "type": 11, "semantic": "PERCENT_COMPLETE" });
    let state = || json!({ "name": "robotState", "type": 12 });
    let hourly = || json!({ "timeStepMs": 3_600_000 });
    // A hundred pieces in ten hours: one takes six minutes.
    assert_eq!(conclusions(&[(made(), json!({}))]), [C::CycleTime]);
    assert_eq!(conclusions(&[(made(), json!({ "minimumIntervalMs": 300_000 }))]), [C::CycleTime]);
    assert_eq!(conclusions(&[(made(), json!({ "minimumIntervalMs": 360_000 }))]), []);
    assert_eq!(conclusions(&[(state(), json!({}))]), [C::Utilisation]);
    assert_eq!(conclusions(&[(state(), hourly())]), []);
    assert_eq!(conclusions(&[(made(), hourly()), (share(), hourly())]), [C::OrderQuantity]);
    assert_eq!(conclusions(&[(made(), hourly()), (scrap(), hourly())]), [C::Yield]);
    assert_eq!(conclusions(&[(share(), json!({}))]), []);
}

#[test]
fn neither_a_rounding_step_nor_a_rate_of_bursts_hides_the_cycle_time() {
    use Conclusion as C;
    let made = || json!({ "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" });
    // Ten pieces take an hour: the time between two steps is their mean.
    assert_eq!(conclusions(&[(made(), json!({ "roundingStep": 10 }))]), [C::CycleTime]);
    let hidden = json!({ "roundingStep": 10, "timeStepMs": 3_600_000 });
    assert_eq!(conclusions(&[(made(), hidden)]), []);
    // Longer than a piece takes, and shorter than ten.
    let coarse = json!({ "roundingStep": 10, "timeStepMs": 1_800_000 });
    assert_eq!(conclusions(&[(made(), coarse)]), [C::CycleTime]);
    // Ten an hour may be ten in a second.
    let burst = |values: u32, period_ms: u64| json!({ "rateLimits": [{ "values": values, "periodMs": period_ms }] });
    assert_eq!(conclusions(&[(made(), burst(10, 3_600_000))]), [C::CycleTime]);
    assert_eq!(conclusions(&[(made(), burst(1, 360_000))]), []);
}

#[test]
fn figures_add_up() {
    let temperature = json!({ "name": "temperature", "type": 11 });
    let share = json!({ "name": "share", "type": 11, "semantic": "PERCENT_COMPLETE" });
    let found = budget(&[
        (share.clone(), json!({ "roundingStep": 25, "minimumIntervalMs": 3_600_000 })),
        (
            temperature.clone(),
            json!({ "bands": [0, 20, 40, 60], "rateLimits": [{ "values": 3, "periodMs": 3_600_000 }] }),
        ),
    ]);
    assert_eq!(found.values_per_hour_max, Some(4.0));
    assert_eq!(found.values_per_hour_measured, 10.0);
    let bits = found.bits_per_hour_max.expect("both are limited");
    // Nine thousand years in ticks of 100 ns, and the milliseconds of an hour.
    let (source, slots) = (2_650_467_743_990_000_002_f64.log2(), 3_600_000_f64);
    // A share is a Double: rounding it bounds nothing. Four usable statuses with a value or without
    // one, five bad ones.
    let share_bits = ((64_f64.exp2() + 1.0) * 4.0 + 5.0).log2() + source;
    let share_times = (std::f64::consts::E * slots).log2();
    // Four bands and "not a number".
    let temperature_bits = ((5.0 + 1.0) * 4.0 + 5.0_f64).log2() + source;
    let temperature_times = 3.0 * (std::f64::consts::E * slots / 3.0).log2();
    let expected = share_bits + share_times + 3.0 * temperature_bits + temperature_times;
    assert!((bits - expected).abs() < 1e-6, "{bits} instead of {expected}");
    let found = budget(&[(share, json!({})), (temperature, json!({ "timeStepMs": 60_000 }))]);
    assert_eq!((found.values_per_hour_max, found.bits_per_hour_max), (None, None));
    let text =
        budget(&[(json!({ "name": "note", "type": 12 }), json!({ "timeStepMs": 3_600_000 }))]);
    assert_eq!(text.fields[0].bits_per_value, None);
}

#[test]
fn a_summary_has_the_totals_of_the_budget() {
    let made = json!({ "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" });
    let state = json!({ "name": "robotState", "type": 6 });
    let limited = |step: u64| json!({ "minimumIntervalMs": 60_000, "timeStepMs": step });
    for fields in [
        vec![(made.clone(), limited(60_000)), (state.clone(), limited(1000)), (state, json!({}))],
        vec![(made, limited(5000))],
        vec![],
    ] {
        let (budget, summary) = with_open(&fields, |open| (leak_budget(open), leak_summary(open)));
        assert_eq!(summary.field_count, budget.fields.len());
        assert_eq!(summary.values_per_hour_max, budget.values_per_hour_max);
        assert_eq!(summary.values_per_hour_measured, budget.values_per_hour_measured);
        assert_eq!(summary.bits_per_hour_max, budget.bits_per_hour_max);
        let finest = budget.fields.iter().map(|field| field.time_resolution_ms).min();
        assert_eq!(summary.time_resolution_ms, finest.unwrap_or(0));
        assert_eq!(summary.warning_count, budget.warnings.len());
        let mut conclusions: Vec<Conclusion> =
            budget.warnings.iter().map(|warning| warning.conclusion).collect();
        conclusions.dedup();
        assert_eq!(summary.conclusions, conclusions);
    }
}

#[test]
fn a_warning_contains_the_planned_time_of_a_piece() {
    let counter = json!({ "name": "count", "type": 9, "unit": "PIECE" });
    let planned = &budget(&[(counter, json!({}))]).warnings[0];
    assert_eq!((planned.piece_ms, planned.needed_ms), (Some(360_000), Some(360_000)));
}

/// Returns the bits per hour of a field.
fn bits(definition: Value, policy: Value) -> Option<f64> {
    budget(&[(definition, policy)]).bits_per_hour_max
}

#[test]
fn the_times_of_releases_are_information() {
    let running = || json!({ "name": "running", "type": 1 });
    let by_minute = |more: &str| -> Value {
        serde_json::from_str(&format!(r#"{{"minimumIntervalMs":60000{more}}}"#)).expect("JSON")
    };
    let free = bits(running(), by_minute("")).expect("limited");
    let seconds = bits(running(), by_minute(r#","timeStepMs":1000"#)).expect("limited");
    let minutes = bits(running(), by_minute(r#","timeStepMs":60000"#)).expect("limited");
    assert!(free > 60.0 * 17.0, "sixty events of a resolution of a millisecond: {free}");
    // Sixty times among 3600 seconds instead of milliseconds, and each source time in seconds.
    assert!(free - seconds > 60.0 * 10.0 + 500.0, "{free} {seconds}");
    assert!(minutes < seconds);
    // The mean over an hour tells one value and status, and whether there is one.
    let window = json!({ "aggregate": { "function": "LAST", "windowMs": 3_600_000 } });
    let hourly = bits(running(), window).expect("limited");
    assert!((hourly - (((2.0 + 1.0) * 4.0 + 5.0_f64).log2() + 1.0)).abs() < 1e-9, "{hourly}");
}

#[test]
fn no_meaning_of_a_field_is_trusted_to_bound_it() {
    let hourly = || json!({ "aggregate": { "function": "LAST", "windowMs": 3_600_000 }, "roundingStep": 25 });
    for semantic in ["PERCENT_COMPLETE", "PRODUCED_QUANTITY", "SCRAP_QUANTITY"] {
        let counted = json!({ "name": "a", "type": 9, "semantic": semantic });
        assert!(bits(counted, hourly()).expect("limited") > 59.0, "{semantic} in 64 bits");
        let measured = json!({ "name": "a", "type": 11, "semantic": semantic });
        assert!(bits(measured, hourly()).expect("limited") > 64.0, "{semantic} as a Double");
    }
}

#[test]
fn status_codes_are_information() {
    let with = |status: &str| {
        let policy = format!(
            r#"{{"aggregate":{{"function":"LAST","windowMs":3600000}},"statusCodes":"{status}"}}"#
        );
        let policy = serde_json::from_str(&policy).expect("JSON");
        bits(json!({ "name": "running", "type": 1 }), policy).expect("limited")
    };
    let (full, common, severity) = (with("FULL"), with("COMMON"), with("SEVERITY"));
    assert!(full > 33.0 && full < 35.0, "{full}");
    assert!(severity < common && common < 6.0, "{severity} {common}");
}

#[test]
fn the_facets_of_one_variable_add_up() {
    let hourly = || json!({ "aggregate": { "function": "LAST", "windowMs": 3_600_000 } });
    let fields =
        ["running", "paused", "other"].map(|name| (json!({ "name": name, "type": 1 }), hourly()));
    let key = |number: u8| -> VariableKey {
        let json = json!({ "sourceId": "mill", "nodeId": format!("nsu=urn:x;i={number}") });
        serde_json::from_value(json).expect("a variable")
    };
    with_open(&fields, |open| {
        let mut open = open.to_vec();
        open[0].variables = [key(1)].into();
        open[1].variables = [key(1), key(2)].into();
        let budget = leak_budget(&open);
        let names = |leak: &VariableLeak| -> Vec<String> {
            leak.fields.iter().map(|field| field.field_name.to_string()).collect()
        };
        let [one, two] = &budget.variables[..] else { panic!("{:?}", budget.variables) };
        assert_eq!(
            (&one.variable, names(one)),
            (&key(1), vec!["running".to_owned(), "paused".to_owned()])
        );
        assert_eq!((&two.variable, names(two)), (&key(2), vec!["paused".to_owned()]));
        let single = budget.fields[0].bits_per_hour_max.expect("limited");
        assert_eq!(one.bits_per_hour_max, Some(2.0 * single));
        assert_eq!((one.values_per_hour_max, two.bits_per_hour_max), (Some(2.0), Some(single)));
    });
}
