//! Plans whose times are known by hand.

mod slack;

use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;
use crate::network::OperationNetwork;

/// Operations as (id, planned start hour, planned end hour), relations as (from, to, type,
/// conditions).
fn network(
    operations: &[(&str, Option<u32>, Option<u32>)],
    relations: &[(&str, &str, &str, Value)],
) -> OperationNetwork {
    let hour = |hour: &Option<u32>| {
        hour.map(|h| format!("2026-01-{:02}T{:02}:00:00Z", 1 + h / 24, h % 24))
    };
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
        &[
            ("a", Some(0), Some(4)),
            ("b", Some(5), Some(7)),
            ("c", None, None),
            ("d", Some(10), Some(12)),
        ],
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
            Some(ConflictOrigin::PlannedStart { operation: 1 }),
        ),
        ([("a", Some(0), Some(4)), ("b", Some(3), Some(7))], ("START_TO_START", json!([])), None),
        // Only the end is planned, and too early.
        (
            [("a", Some(0), Some(4)), ("b", None, Some(3))],
            ("FINISH_TO_START", json!([])),
            Some(ConflictOrigin::PlannedEnd { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(2), Some(3))],
            ("FINISH_TO_FINISH", json!([])),
            Some(ConflictOrigin::PlannedStart { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(4), Some(5))],
            ("FINISH_TO_START", duration("MINIMUM_GAP", "PT1H")),
            Some(ConflictOrigin::PlannedStart { operation: 1 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", Some(9), Some(10))],
            ("FINISH_TO_START", duration("MAXIMUM_GAP", "PT4H")),
            Some(ConflictOrigin::Condition { relation: 0, condition: 0 }),
        ),
        (
            [("a", Some(0), Some(4)), ("b", None, None)],
            ("FINISH_TO_START", start_by("2026-01-01T03:00:00Z")),
            Some(ConflictOrigin::Condition { relation: 0, condition: 0 }),
        ),
        // Without a planned end, an operation may last until its predecessor is done.
        ([("a", Some(0), Some(4)), ("b", Some(3), None)], ("FINISH_TO_FINISH", json!([])), None),
        ([("a", None, None), ("b", None, None)], ("FINISH_TO_START", json!([])), None),
        ([("a", None, None), ("b", Some(1), Some(2))], ("START_TO_FINISH", json!([])), None),
    ] {
        let network = network(&operations, &[("a", "b", relation.0, relation.1.clone())]);
        let origins: Vec<_> =
            Schedule::of(&network).conflicts.into_iter().map(|conflict| conflict.origin).collect();
        assert_eq!(
            origins,
            expected.into_iter().collect::<Vec<_>>(),
            "{operations:?} {relation:?}"
        );
    }
}

#[test]
fn maximum_gaps_bind_backwards() {
    let by = |kind: &str, hour: u32| json!([{ "conditionId": "c", "conditionKind": kind, "time": format!("2026-01-01T{hour:02}:00:00Z") }]);
    // b follows a within an hour and starts at 10, so that a cannot be done by 5.
    let operations = [("x", None, None), ("a", None, None), ("b", Some(10), None)];
    let late = ("a", "b", "FINISH_TO_START", duration("MAXIMUM_GAP", "PT1H"));
    let conflicts = |relations: &[(&str, &str, &str, Value)], operations| {
        let found = Schedule::of(&network(operations, relations)).conflicts;
        found.into_iter().map(|conflict| conflict.origin).collect::<Vec<_>>()
    };
    let origin = |relation| vec![ConflictOrigin::Condition { relation, condition: 0 }];
    let early = ("x", "a", "FINISH_TO_START", by("FINISH_NO_LATER_THAN", 5));
    assert_eq!(conflicts(&[early, late.clone()], &operations), origin(0));
    let early = ("x", "a", "FINISH_TO_START", by("FINISH_NO_LATER_THAN", 9));
    assert_eq!(conflicts(&[early, late], &operations), []);
    // The way round takes longer than the direct one may, whenever that is.
    let operations = [("a", None, None), ("b", None, None), ("c", None, None)];
    let round = |maximum: &str| {
        [
            ("a", "b", "START_TO_START", duration("MINIMUM_GAP", "PT5H")),
            ("b", "c", "START_TO_START", duration("MINIMUM_GAP", "PT5H")),
            ("a", "c", "START_TO_START", duration("MAXIMUM_GAP", maximum)),
        ]
    };
    assert_eq!(conflicts(&round("PT9H"), &operations), origin(2));
    assert_eq!(conflicts(&round("PT10H"), &operations), []);
}

#[test]
fn endless_chains_do_not_overflow() {
    let ids: Vec<String> = (0..500).map(|n| n.to_string()).collect();
    let operations: Vec<_> = ids.iter().map(|id| (id.as_str(), None, None)).collect();
    let relations: Vec<_> = ids
        .windows(2)
        .map(|pair| (&*pair[0], &*pair[1], "FINISH_TO_START", duration("MINIMUM_GAP", "P36500D")))
        .collect();
    let mut chain = network(&operations, &relations);
    assert_eq!(Schedule::of(&chain).conflicts, []);
    chain.operation_list[0].planned_end = Some(DateTime::MAX);
    assert_eq!(Schedule::of(&chain).operations.len(), 500);
}

/// A random operation: start hour, length, and whether each end is planned.
type OperationDraw = (u32, u32, bool, bool);
/// A random relation: its ends, its type, and conditions of a kind with an hour or a length.
type RelationDraw = (usize, usize, usize, Vec<(usize, u32)>);

const TYPES: [&str; 4] =
    ["FINISH_TO_START", "START_TO_START", "FINISH_TO_FINISH", "START_TO_FINISH"];
const KINDS: [&str; 6] = [
    "START_NO_EARLIER_THAN",
    "START_NO_LATER_THAN",
    "FINISH_NO_EARLIER_THAN",
    "FINISH_NO_LATER_THAN",
    "MINIMUM_GAP",
    "MAXIMUM_GAP",
];

/// True where times exist that keep everything, found by relaxing each inequality `to >= from +
/// distance` until nothing changes.
fn is_feasible(operations: &[OperationDraw], relations: &[RelationDraw]) -> bool {
    let origin = 2 * operations.len();
    let (start, finish) = (|at: usize| 2 * at, |at: usize| 2 * at + 1);
    let mut bounds: Vec<(usize, usize, i64)> = Vec::new();
    let mut fix =
        |end: usize, hour: i64| bounds.extend([(origin, end, hour), (end, origin, -hour)]);
    for (at, &(hour, length, has_start, has_end)) in operations.iter().enumerate() {
        if has_start {
            fix(start(at), i64::from(hour));
        }
        if has_end {
            fix(finish(at), i64::from(hour + length));
        }
    }
    bounds.extend((0..operations.len()).map(|at| (start(at), finish(at), 0)));
    for (from, to, relation_type, conditions) in relations {
        let from = if [0, 2].contains(relation_type) { finish(*from) } else { start(*from) };
        let end = if [0, 1].contains(relation_type) { start(*to) } else { finish(*to) };
        bounds.push((from, end, 0));
        for (kind, number) in conditions {
            let number = i64::from(*number);
            bounds.push(match kind {
                0 => (origin, start(*to), number),
                1 => (start(*to), origin, -number),
                2 => (origin, finish(*to), number),
                3 => (finish(*to), origin, -number),
                4 => (from, end, number),
                _ => (end, from, -number),
            });
        }
    }
    let mut least = vec![-1_000_000; origin + 1];
    least[origin] = 0;
    for _ in 0..=least.len() {
        let mut is_moved = false;
        for &(from, to, distance) in &bounds {
            if least[from] + distance > least[to] {
                least[to] = least[from] + distance;
                is_moved = true;
            }
        }
        if !is_moved {
            return least[origin] == 0;
        }
    }
    false
}

/// Random operations and relations between them without a cycle.
fn draws() -> impl Strategy<Value = (Vec<OperationDraw>, Vec<RelationDraw>)> {
    let operation = (0_u32..20, 0_u32..6, any::<bool>(), any::<bool>());
    let conditions = proptest::collection::vec((0_usize..6, 0_u32..20), 0..3);
    let relation = (0_usize..6, 0_usize..6, 0_usize..4, conditions);
    let lists =
        (proptest::collection::vec(operation, 2..6), proptest::collection::vec(relation, 0..7));
    lists.prop_map(|(operations, relations)| {
        let count = operations.len();
        let relations = relations
            .into_iter()
            .map(|(a, b, relation_type, conditions)| {
                let (a, b) = (a % count, b % count);
                (a.min(b), a.max(b), relation_type, conditions)
            })
            .filter(|(from, to, ..)| from != to)
            .collect();
        (operations, relations)
    })
}

/// The network of such a draw.
fn drawn(operations: &[OperationDraw], relations: &[RelationDraw]) -> OperationNetwork {
    let ids: Vec<String> = (0..operations.len()).map(|n| n.to_string()).collect();
    let planned: Vec<_> = operations
        .iter()
        .zip(&ids)
        .map(|(&(hour, length, has_start, has_end), id)| {
            (id.as_str(), has_start.then_some(hour), has_end.then_some(hour + length))
        })
        .collect();
    let related: Vec<_> = relations
        .iter()
        .map(|(from, to, relation_type, conditions)| {
            let conditions: Vec<Value> = conditions
                .iter()
                .map(|(kind, number)| match kind {
                    4 | 5 => json!({ "conditionId": "c", "conditionKind": KINDS[*kind],
                        "duration": format!("PT{number}H") }),
                    _ => json!({ "conditionId": "c", "conditionKind": KINDS[*kind],
                        "time": format!("2026-01-01T{number:02}:00:00Z") }),
                })
                .collect();
            (ids[*from].as_str(), ids[*to].as_str(), TYPES[*relation_type], json!(conditions))
        })
        .collect();
    network(&planned, &related)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    /// Conflicts are found where no times keep everything, and only there.
    #[test]
    fn conflicts_are_exactly_what_cannot_hold((operations, relations) in draws()) {
        let conflicts = Schedule::of(&drawn(&operations, &relations)).conflicts;
        prop_assert_eq!(conflicts.is_empty(), is_feasible(&operations, &relations), "{:?}", conflicts);
    }
}

#[test]
fn a_cycle_does_not_hang_it() {
    let relations =
        [("a", "b", "FINISH_TO_START", json!([])), ("b", "a", "FINISH_TO_START", json!([]))];
    let schedule =
        Schedule::of(&network(&[("a", Some(0), Some(1)), ("b", Some(2), Some(3))], &relations));
    assert_eq!(schedule.operations.len(), 2);
    assert_eq!(schedule.critical_path, []);
}
