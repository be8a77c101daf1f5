//! Latest times.

use super::{
    earliest::Earliest,
    graph::{Graph, Time, ends},
};
use crate::network::ConditionKind;

/// The latest times that do not delay the whole, which ends with its last operation.
pub(super) struct Latest {
    pub(super) start: Vec<Time>,
    pub(super) finish: Vec<Time>,
}

impl Latest {
    /// Goes backward over the operations, from the last to the first.
    pub(super) fn of(graph: &Graph<'_>, earliest: &Earliest<'_, '_>) -> Self {
        let count = graph.network.operation_list.len();
        let mut latest = Self { start: vec![None; count], finish: vec![None; count] };
        let end = earliest.finish.iter().flatten().max().copied();
        for &at in graph.order.iter().rev() {
            let (earliest_start, earliest_finish) = (earliest.start[at], earliest.finish[at]);
            // Without an earliest time it is bound to nothing, and has no slack to tell.
            if earliest_start.is_none() && earliest_finish.is_none() {
                continue;
            }
            let (start, mut finish) = latest.bounds(graph, at, end);
            // The length that the earliest times gave it: relations may hold its ends further apart
            // than its plan does.
            let duration = match (earliest_start, earliest_finish) {
                (Some(start), Some(finish)) => finish.saturating_sub(start),
                _ => graph.duration[at].unwrap_or(0),
            };
            if let Some(start) = start {
                lower(&mut finish, start.saturating_add(duration));
            }
            latest.finish[at] = finish;
            latest.start[at] = finish.map(|finish| finish.saturating_sub(duration));
        }
        latest
    }

    /// The greatest start and finish that successors and conditions leave an operation.
    fn bounds(&self, graph: &Graph<'_>, at: usize, end: Time) -> (Time, Time) {
        let (mut start, mut finish): (Time, Time) = (None, end);
        for &index in &graph.outgoing[at] {
            let edge = &graph.edges[index];
            let (by_finish, bounds_start) = ends(graph.relation(edge).relation_type);
            let bound = if bounds_start { self.start[edge.to] } else { self.finish[edge.to] };
            if let Some(bound) = bound {
                let bound = bound.saturating_sub(edge.minimum_gap);
                lower(if by_finish { &mut finish } else { &mut start }, bound);
            }
        }
        for &index in &graph.incoming[at] {
            for condition in &graph.relation(&graph.edges[index]).condition_list {
                match (condition.condition_kind, condition.time) {
                    (ConditionKind::StartNoLaterThan, Some(time)) => {
                        lower(&mut start, time.ticks());
                    }
                    (ConditionKind::FinishNoLaterThan, Some(time)) => {
                        lower(&mut finish, time.ticks());
                    }
                    _ => {}
                }
            }
        }
        (start, finish)
    }
}

fn lower(bound: &mut Time, time: i64) {
    *bound = Some(bound.map_or(time, |known| known.min(time)));
}
