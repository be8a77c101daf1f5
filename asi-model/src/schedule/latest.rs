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
    bounds: Vec<Bounds>,
}

/// The greatest times of an operation's ends.
#[derive(Clone, Copy, Default)]
struct Bounds {
    start: Time,
    finish: Time,
    /// Bounds by the maximum gaps after predecessors, which stay where they are.
    gap_start: GapBound,
    gap_finish: GapBound,
    /// The distance of the ends; `None` where nothing bounds the start, which may then be as early
    /// as it likes.
    duration: Option<i64>,
}

/// The least of several bounds, of which those by one predecessor can be left out.
#[derive(Clone, Copy, Default)]
struct GapBound {
    /// The least, and the predecessor that it is by.
    least: Option<(i64, usize)>,
    /// The least by any other predecessor.
    other: Time,
}

impl GapBound {
    fn add(&mut self, time: i64, from: usize) {
        match &mut self.least {
            Some((least, by)) if *by == from => *least = time.min(*least),
            Some((least, _)) if *least <= time => lower(&mut self.other, time),
            least => {
                self.other = least.map(|(time, _)| time);
                *least = Some((time, from));
            }
        }
    }

    fn without(&self, from: Option<usize>) -> Time {
        match self.least {
            Some((_, by)) if Some(by) == from => self.other,
            least => least.map(|(time, _)| time),
        }
    }
}

impl Bounds {
    /// Adds the times that predecessors, as planned or at their earliest, and the maximum gaps after
    /// them allow.
    fn add_maximum_gaps(&mut self, graph: &Graph<'_>, earliest: &Earliest<'_, '_>, at: usize) {
        for &index in &graph.incoming[at] {
            let edge = &graph.edges[index];
            let (by_finish, bounds_start) = ends(graph.relation(edge).relation_type);
            let times = if by_finish { &earliest.finish } else { &earliest.start };
            if let (Some(from), Some((maximum, _))) = (times[edge.from], edge.maximum_gap) {
                let bound = if bounds_start { &mut self.gap_start } else { &mut self.gap_finish };
                bound.add(from.saturating_add(maximum), edge.from);
            }
        }
    }

    /// The latest start and finish, where a predecessor moves along or none does.
    fn latest(&self, moved: Option<usize>) -> (Time, Time) {
        let (mut start, mut finish) = (self.start, self.finish);
        if let Some(time) = self.gap_start.without(moved) {
            lower(&mut start, time);
        }
        if let Some(time) = self.gap_finish.without(moved) {
            lower(&mut finish, time);
        }
        let Some(duration) = self.duration else {
            if let Some(finish) = finish {
                lower(&mut start, finish);
            }
            return (start, finish);
        };
        if let Some(start) = start {
            lower(&mut finish, start.saturating_add(duration));
        }
        (finish.map(|finish| finish.saturating_sub(duration)), finish)
    }
}

impl Latest {
    /// Goes backward over the operations, from the last to the first.
    pub(super) fn of(graph: &Graph<'_>, earliest: &Earliest<'_, '_>) -> Self {
        let count = graph.network.operation_list.len();
        let mut latest = Self {
            start: vec![None; count],
            finish: vec![None; count],
            bounds: vec![Bounds::default(); count],
        };
        let end = earliest.finish.iter().flatten().max().copied();
        for &at in graph.order.iter().rev() {
            let (earliest_start, earliest_finish) = (earliest.start[at], earliest.finish[at]);
            // Without an earliest time it is bound to nothing, and has no slack to tell.
            if earliest_start.is_none() && earliest_finish.is_none() {
                continue;
            }
            let mut bounds = latest.bounds(graph, at, end);
            bounds.add_maximum_gaps(graph, earliest, at);
            // The length that the earliest times gave it: relations may hold its ends further apart
            // than its plan does.
            bounds.duration = earliest_start
                .zip(earliest_finish)
                .map(|(start, finish)| finish.saturating_sub(start));
            (latest.start[at], latest.finish[at]) = bounds.latest(None);
            latest.bounds[at] = bounds;
        }
        latest
    }

    /// The greatest start and finish that successors and conditions leave an operation.
    fn bounds(&self, graph: &Graph<'_>, at: usize, end: Time) -> Bounds {
        let (mut start, mut finish): (Time, Time) = (None, end);
        for &index in &graph.outgoing[at] {
            let edge = &graph.edges[index];
            let (by_finish, bounds_start) = ends(graph.relation(edge).relation_type);
            // A successor that must follow soon follows a late operation as soon.
            let (latest_start, latest_finish) = self.bounds[edge.to].latest(Some(at));
            let bound = if bounds_start { latest_start } else { latest_finish };
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
        Bounds { start, finish, ..Bounds::default() }
    }
}

fn lower(bound: &mut Time, time: i64) {
    *bound = Some(bound.map_or(time, |known| known.min(time)));
}
