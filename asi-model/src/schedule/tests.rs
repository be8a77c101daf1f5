//! Plans whose times are known by hand.

use serde_json::{Value, json};

use super::*;

/// Operations as (id, planned start hour, planned end hour), relations as (from, to, type, conditions).
fn network(
    operations: &[(&str, Option<u32>, Option<u32>)],
    relations: &[(&str, &str, &str, Value)],
) -> OperationNetwork {
    let hour = |hour: &Option<u32>| hour.map(|h| format!("2026-01-{:02}T{:02}:00:00Z", 1 + h / 24, h % 24));
    let operations: Vec<Value> = operations
        .iter()
        .map(|(id, start, end)| {
            json!({ "operationId": id, "operationType": "PRODUCTION", "plannedStart": hour(start),
                "plannedEnd": hour(end) })
        })
        .collect();
    let relations: Vec<Value> = relations
        .iter()
        .enumerate()
        .map(|(index, (from, to, relation_type, conditions))| {
            json!({ "operationRelationId": format!("r{index}"), "relationType": relation_type,
                "predecessorOperationId": from, "successorOperationId": to, "conditionList": conditions })
        })
        .collect();
    serde_json::from_value(json!({ "operationNetworkId": "n", "operationList": operations,
        "operationRelationList": relations }))
    .expect("a network")
}

fn duration(kind: &str, text: &str) -> Value {
    json!([{ "conditionId": "c", "conditionKind": kind, "duration": text }])
}

fn hours(time: Option<DateTime>) -> Option<i64> {
    let start: DateTime = "2026-01-01T00:00:00Z".parse().expect("valid");
    time.map(|time| (time.ticks() - start.ticks()) / 36_000_000_000)
}

#[test]
fn times_run_forward_and_backward() {
    // a(0-4) -> b(5-7) -> d(10-12); a -> c (free, 3 h as planned later) -> d.
    let network = network(
        &[("a", Some(0), Some(4)), ("b", Some(5), Some(7)), ("c", None, None), ("d", Some(10), Some(12))],
        &[
            ("a", "b", "FINISH_TO_START", json!([])),
            ("a", "c", "FINISH_TO_START", duration("MINIMUM_GAP", "PT2H")),
            ("b", "d", "FINISH_TO_START", json!([])),
            ("c", "d", "FINISH_TO_START", duration("MINIMUM_GAP", "PT4H")),
        ],
    );
    let schedule = Schedule::of(&network);
    assert_eq!(schedule.conflicts, []);
    let found: Vec<_> = schedule
        .operations
        .iter()
        .map(|times| {
            let slack = times.slack.map(|slack| slack.to_string()).unwrap_or_default();
            (hours(times.earliest_start), hours(times.latest_finish), slack, times.is_critical)
        })
        .collect();
    assert_eq!(
        found,
        [
            (Some(0), Some(4), "PT0S".to_owned(), true),
            (Some(5), Some(10), "PT3H".to_owned(), false),
            (Some(6), Some(6), "PT0S".to_owned(), true),
            (Some(10), Some(12), "PT0S".to_owned(), true),
        ]
    );
    let path: Vec<&str> = schedule.critical_path.iter().map(OperationId::as_str).collect();
    assert_eq!(path, ["a", "c", "d"]);
}

#[test]
fn conflicts_are_found() {
    let start_by = |time: &str| json!([{ "conditionId": "c", "conditionKind": "START_NO_LATER_THAN", "time": time }]);
    for (operations, relation, expected) in [
        // Begins before its predecessor ends.
        (
            [("a", Some(0), Some(4)), ("b", Some(3), Some(7))],
            ("FINISH_TO_START", json!([])),
            Some(ConflictPlace::PlannedStart { operation: 1 }),
        ),
        ([("a", Some(0), Some(4)), ("b", Some(3), Some(7))], ("START_TO_START", json!([])), None),
        // Only the end is planned, and too early.
        (
            [("a", Some(0), Some(4)), ("b", None, Some(3))],
            ("FINISH_TO_START", json!([])),
            Some(ConflictPlace::PlannedEnd { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(2), Some(3))],
            ("FINISH_TO_FINISH", json!([])),
            Some(ConflictPlace::PlannedStart { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(4), Some(5))],
            ("FINISH_TO_START", duration("MINIMUM_GAP", "PT1H")),
            Some(ConflictPlace::PlannedStart { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(9), Some(10))],
            ("FINISH_TO_START", duration("MAXIMUM_GAP", "PT4H")),
            Some(ConflictPlace::Condition { relation: 0, condition: 0 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", None, None)],
            ("FINISH_TO_START", start_by("2026-01-01T03:00:00Z")),
            Some(ConflictPlace::Condition { relation: 0, condition: 0 }),
        ),
        ([("a", None, None), ("b", None, None)], ("FINISH_TO_START", json!([])), None),
        ([("a", None, None), ("b", Some(1), Some(2))], ("START_TO_FINISH", json!([])), None),
    ] {
        let network = network(&operations, &[("a", "b", relation.0, relation.1.clone())]);
        let places: Vec<_> = Schedule::of(&network).conflicts.into_iter().map(|conflict| conflict.place).collect();
        assert_eq!(places, expected.into_iter().collect::<Vec<_>>(), "{operations:?} {relation:?}");
    }
}

#[test]
fn a_cycle_does_not_hang_it() {
    let relations = [("a", "b", "FINISH_TO_START", json!([])), ("b", "a", "FINISH_TO_START", json!([]))];
    let schedule = Schedule::of(&network(&[("a", Some(0), Some(1)), ("b", Some(2), Some(3))], &relations));
    assert_eq!(schedule.operations.len(), 2);
    assert_eq!(schedule.critical_path, []);
}
