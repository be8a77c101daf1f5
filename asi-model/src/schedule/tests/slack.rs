//! Slack where maximum gaps bind.

use proptest::prelude::*;

use super::{Schedule, drawn, draws, duration, hours, network};
use crate::{network::IsoDuration, schedule::graph};

fn slacks(schedule: &Schedule) -> Vec<String> {
    let text = |slack: Option<IsoDuration>| slack.map_or("-".to_owned(), |slack| slack.to_string());
    schedule.operations.iter().map(|times| text(times.slack)).collect()
}

#[test]
fn an_operation_stays_within_the_maximum_gap_after_its_predecessor() {
    // The last operation ends much later than both.
    let operations = [("a", Some(0), Some(4)), ("b", Some(5), Some(7)), ("z", Some(19), Some(20))];
    for (relation_type, gap, expected) in [
        ("FINISH_TO_START", "PT2H", ["PT14H", "PT1H"]),
        ("START_TO_START", "PT7H", ["PT16H", "PT2H"]),
        ("FINISH_TO_FINISH", "PT6H", ["PT16H", "PT3H"]),
        ("START_TO_FINISH", "PT11H", ["PT16H", "PT4H"]),
    ] {
        let network =
            network(&operations, &[("a", "b", relation_type, duration("MAXIMUM_GAP", gap))]);
        let schedule = Schedule::of(&network);
        assert_eq!(schedule.conflicts, []);
        // Where the first is late, the second is late with it: that does not delay the whole.
        let [first, second, _] = slacks(&schedule).try_into().expect("three operations");
        assert_eq!([&*first, &*second], expected, "{relation_type}");
        assert_eq!(
            hours(schedule.operations[1].latest_finish),
            Some(match relation_type {
                "FINISH_TO_START" => 8,
                "START_TO_START" => 9,
                "FINISH_TO_FINISH" => 10,
                _ => 11,
            })
        );
    }
}

#[test]
fn the_tightest_of_several_gaps_binds() {
    let operations = [
        ("a", Some(0), Some(4)),
        ("b", Some(0), Some(3)),
        ("c", Some(5), Some(7)),
        ("z", Some(19), Some(20)),
    ];
    let within = |from: &'static str, gap: &str| {
        (from, "c", "FINISH_TO_START", duration("MAXIMUM_GAP", gap))
    };
    let network =
        network(&operations, &[within("a", "PT9H"), within("b", "PT4H"), within("a", "PT5H")]);
    let schedule = Schedule::of(&network);
    // The third follows the second within 4 hours, and the first by then only if it starts late:
    // by 7 it must have begun, whichever of both is late.
    assert_eq!(slacks(&schedule), ["PT3H", "PT6H", "PT2H", "PT0S"]);
}

proptest! {
    #![proptest_config(ProptestConfig {
        max_global_rejects: 20_000,
        ..ProptestConfig::with_cases(2_000)
    })]

    /// An operation that is late by its slack, while all others are at their earliest, keeps every
    /// maximum gap after its predecessors; and without conflicts no slack is negative.
    #[test]
    fn slack_keeps_maximum_gaps((operations, relations) in draws()) {
        let network = drawn(&operations, &relations);
        let schedule = Schedule::of(&network);
        prop_assume!(schedule.conflicts.is_empty());
        let graph = graph::Graph::of(&network);
        let ticks = |slack: IsoDuration| i64::try_from(slack.0.as_nanos() / 100).expect("hours");
        for edge in &graph.edges {
            let (by_finish, bounds_start) = graph::ends(graph.relation(edge).relation_type);
            let (from, to) = (&schedule.operations[edge.from], &schedule.operations[edge.to]);
            let from = if by_finish { from.earliest_finish } else { from.earliest_start };
            let reached = if bounds_start { to.earliest_start } else { to.earliest_finish };
            if let (Some(from), Some(reached), Some(slack), Some((maximum, _))) =
                (from, reached, to.slack, edge.maximum_gap)
            {
                let gap = reached.ticks() + ticks(slack) - from.ticks();
                prop_assert!(gap <= maximum, "{gap} is more than {maximum}");
            }
        }
        for times in &schedule.operations {
            let is_bound = times.earliest_finish.or(times.earliest_start).is_some()
                && times.latest_finish.is_some();
            prop_assert_eq!(times.slack.is_some(), is_bound, "{:?}", times);
        }
    }
}
