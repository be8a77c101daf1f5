//! The passes over a network, and their result.

use std::time::Duration;

use super::{
    OperationTimes, Schedule,
    earliest::Earliest,
    graph::{Graph, Time},
    latest::Latest,
};
use crate::{
    network::{IsoDuration, OperationNetwork},
    values::DateTime,
};

impl Schedule {
    /// Computes the time frames. Relations that name unknown operations are left out, and where the
    /// relations form a cycle, so are the operations on it (the validation reports both).
    #[must_use]
    pub fn of(network: &OperationNetwork) -> Self {
        let graph = Graph::of(network);
        let earliest = Earliest::of(&graph);
        let latest = Latest::of(&graph, &earliest);
        let operations: Vec<OperationTimes> = (0..network.operation_list.len())
            .map(|at| times(&graph, &earliest, &latest, at))
            .collect();
        let mut critical: Vec<usize> =
            graph.order.iter().copied().filter(|at| operations[*at].is_critical).collect();
        critical.sort_by_key(|at| (earliest.start[*at], earliest.finish[*at]));
        let critical_path =
            critical.into_iter().map(|at| operations[at].operation_id.clone()).collect();
        Self { operations, critical_path, conflicts: earliest.conflicts }
    }
}

fn times(
    graph: &Graph<'_>,
    earliest: &Earliest<'_, '_>,
    latest: &Latest,
    at: usize,
) -> OperationTimes {
    let time = |time: Time| time.map(DateTime::from_ticks);
    let slack = earliest.finish[at]
        .or(earliest.start[at])
        .zip(latest.finish[at].or(latest.start[at]))
        .and_then(|(earliest, latest)| u64::try_from(latest.saturating_sub(earliest)).ok());
    // A negative slack belongs to a conflict; such an operation is critical all the same.
    let is_planned = earliest.finish[at].is_some() && latest.finish[at].is_some();
    OperationTimes {
        operation_id: graph.operation(at).operation_id.clone(),
        earliest_start: time(earliest.start[at]),
        earliest_finish: time(earliest.finish[at]),
        latest_start: time(latest.start[at]),
        latest_finish: time(latest.finish[at]),
        slack: slack.map(|ticks| {
            IsoDuration(Duration::new(
                ticks / 10_000_000,
                u32::try_from(ticks % 10_000_000).unwrap_or(0) * 100,
            ))
        }),
        is_critical: is_planned && slack.is_none_or(|slack| slack == 0),
    }
}
