//! Earliest times, with the bounds that they break.

use super::{
    Conflict, ConflictOrigin,
    graph::{Edge, Graph, Time, ends, gaps},
};
use crate::{network::ConditionKind, values::DateTime};

/// Most conflicts reported of one network.
const CONFLICTS_MAX: usize = 100;

/// Most passes forward. With fewer maximum gaps than this every conflict is found, else those that
/// so many passes show.
const PASSES_MAX: usize = 64;

/// The least that the ends of an operation may be, as the maximum gaps after it demand.
#[derive(Debug, Clone, Copy)]
struct LowerBound {
    start: Time,
    finish: Time,
}

/// The earliest times while they are found.
pub(super) struct Earliest<'g, 'n> {
    graph: &'g Graph<'n>,
    lower_bounds: Vec<LowerBound>,
    pub(super) start: Vec<Time>,
    pub(super) finish: Vec<Time>,
    pub(super) conflicts: Vec<Conflict>,
}

impl<'g, 'n> Earliest<'g, 'n> {
    /// Finds the earliest times and all conflicts.
    pub(super) fn of(graph: &'g Graph<'n>) -> Self {
        let count = graph.network.operation_list.len();
        let mut earliest = Self {
            graph,
            lower_bounds: Vec::new(),
            start: vec![None; count],
            finish: vec![None; count],
            conflicts: Vec::new(),
        };
        // Nothing happens before time begins: so conflicts of gaps show where no time is planned at
        // all.
        let unsettled = earliest.settle(Some(DateTime::MIN.ticks()));
        for &at in &graph.order {
            earliest.forward(at, true);
        }
        for edge in &graph.edges {
            earliest.check_conditions(edge);
            earliest.check_maximum_gaps(edge);
        }
        if earliest.conflicts.is_empty() {
            earliest.note_unsettled(&unsettled);
        }
        // The conflicts are found. The times are shown without that beginning: an operation that
        // nothing bounds has none.
        earliest.settle(None);
        earliest
    }

    /// Passes forward until no maximum gap is broken, with nothing before `base`. Returns the
    /// edges whose maximum gaps never are.
    fn settle(&mut self, base: Time) -> Vec<usize> {
        self.lower_bounds = vec![LowerBound { start: base, finish: base }; self.start.len()];
        let gaps = self.graph.edges.iter().filter(|edge| edge.maximum_gap.is_some()).count();
        let mut raised = Vec::new();
        for _ in 0..(gaps + 1).min(PASSES_MAX) {
            for &at in &self.graph.order {
                self.forward(at, false);
            }
            raised = self.raise_lower_bounds();
            if raised.is_empty() {
                break;
            }
        }
        // As many passes as gaps settle everything that can be.
        if gaps < PASSES_MAX { raised } else { Vec::new() }
    }

    /// Lets each predecessor be no earlier than the maximum gap to its successor allows. Returns
    /// the edges that did.
    fn raise_lower_bounds(&mut self) -> Vec<usize> {
        let mut raised = Vec::new();
        for (index, edge) in self.graph.edges.iter().enumerate() {
            let Some((maximum, _)) = edge.maximum_gap else { continue };
            let (by_finish, bounds_start) = ends(self.graph.relation(edge).relation_type);
            let reached = if bounds_start { self.start[edge.to] } else { self.finish[edge.to] };
            let Some(least) = reached.map(|reached| reached.saturating_sub(maximum)) else {
                continue;
            };
            let predecessor = self.graph.operation(edge.from);
            let (planned, found, lower_bound) = if by_finish {
                (
                    predecessor.planned_end,
                    self.finish[edge.from],
                    &mut self.lower_bounds[edge.from].finish,
                )
            } else {
                (
                    predecessor.planned_start,
                    self.start[edge.from],
                    &mut self.lower_bounds[edge.from].start,
                )
            };
            // An operation that is late enough already needs no bound: so the passes end.
            // A plan does not give way; that it breaks the gap is found later.
            if planned.is_none() && found.is_none_or(|found| found < least) {
                *lower_bound = (*lower_bound).max(Some(least));
                raised.push(index);
            }
        }
        raised
    }

    /// Maximum gaps that the minimum gaps around them exceed, whatever the times.
    fn note_unsettled(&mut self, edges: &[usize]) {
        for &index in edges {
            let edge = &self.graph.edges[index];
            let relation = self.graph.relation(edge);
            let Some((_, condition)) = edge.maximum_gap else { continue };
            let message = format!(
                "The relations between {} and {} need more time than their maximum gap leaves.",
                relation.predecessor_operation_id, relation.successor_operation_id
            );
            let origin = ConflictOrigin::Condition { relation: edge.relation, condition };
            self.conflict(origin, message);
        }
    }

    /// The earliest times of one operation from those of what it depends on.
    fn forward(&mut self, at: usize, is_reported: bool) {
        let operation = self.graph.operation(at);
        let (start, finish) = self.bounds(at);
        // A late finish moves the start of a plan of fixed length.
        let forced_by_finish = finish
            .zip(self.graph.duration[at])
            .map(|(finish, duration)| finish.saturating_sub(duration));
        let forced_start = start.max(forced_by_finish);
        let planned_start = operation.planned_start.map(DateTime::ticks);
        let planned_end = operation.planned_end.map(DateTime::ticks);
        if is_reported
            && let (Some(planned), Some(forced)) = (planned_start, forced_start)
            && forced > planned
        {
            let message = format!(
                "{} is planned to start at {}, but its relations do not let it start before {}.",
                operation.operation_id,
                DateTime::from_ticks(planned),
                DateTime::from_ticks(forced)
            );
            self.conflict(ConflictOrigin::PlannedStart { operation: at }, message);
        }
        // A conflict is reported where it arises; what follows is judged by the plan, lest one
        // fault breeds many.
        let start = planned_start.or(forced_start);
        let length = self.graph.duration[at].unwrap_or(0);
        let earliest_finish = start.map(|start| start.saturating_add(length)).max(finish);
        if planned_start.is_none()
            && is_reported
            && let (Some(planned), Some(earliest)) = (planned_end, earliest_finish)
            && earliest > planned
        {
            let message = format!(
                "{} is planned to end at {}, but its relations do not let it finish before {}.",
                operation.operation_id,
                DateTime::from_ticks(planned),
                DateTime::from_ticks(earliest)
            );
            self.conflict(ConflictOrigin::PlannedEnd { operation: at }, message);
        }
        self.start[at] = start;
        self.finish[at] = planned_end.or(earliest_finish);
    }

    /// The least start and finish that lower bounds, relations and conditions leave an operation.
    fn bounds(&self, at: usize) -> (Time, Time) {
        let LowerBound { mut start, mut finish } = self.lower_bounds[at];
        for &index in &self.graph.incoming[at] {
            let edge = &self.graph.edges[index];
            let relation = self.graph.relation(edge);
            let (by_finish, bounds_start) = ends(relation.relation_type);
            let from = if by_finish { self.finish[edge.from] } else { self.start[edge.from] };
            let bound = from.map(|time| time.saturating_add(edge.minimum_gap));
            let target = if bounds_start { &mut start } else { &mut finish };
            *target = (*target).max(bound);
            // A relation's conditions bound its successor, whichever ends it binds.
            for condition in &relation.condition_list {
                let time = condition.time.map(DateTime::ticks);
                match condition.condition_kind {
                    ConditionKind::StartNoEarlierThan => start = start.max(time),
                    ConditionKind::FinishNoEarlierThan => finish = finish.max(time),
                    _ => {}
                }
            }
        }
        (start, finish)
    }

    fn conflict(&mut self, origin: ConflictOrigin, message: String) {
        if self.conflicts.len() < CONFLICTS_MAX {
            self.conflicts.push(Conflict { origin, message });
        }
    }

    /// Notes conditions whose latest time the earliest times already miss.
    fn check_conditions(&mut self, edge: &Edge) {
        let relation = self.graph.relation(edge);
        let successor = &relation.successor_operation_id;
        for (index, condition) in relation.condition_list.iter().enumerate() {
            let (what, earliest) = match condition.condition_kind {
                ConditionKind::StartNoLaterThan => ("start", self.start[edge.to]),
                ConditionKind::FinishNoLaterThan => ("finish", self.finish[edge.to]),
                _ => continue,
            };
            if let (Some(bound), Some(earliest)) = (condition.time, earliest)
                && earliest > bound.ticks()
            {
                let earliest = DateTime::from_ticks(earliest);
                let message = format!(
                    "{successor} must {what} by {bound}, but cannot {what} before {earliest}."
                );
                let origin =
                    ConflictOrigin::Condition { relation: edge.relation, condition: index };
                self.conflict(origin, message);
            }
        }
    }

    /// Notes maximum gaps that the plan of the predecessor breaks. Without a plan the predecessor
    /// may be later than its earliest time.
    fn check_maximum_gaps(&mut self, edge: &Edge) {
        let relation = self.graph.relation(edge);
        let (by_finish, bounds_start) = ends(relation.relation_type);
        let predecessor = self.graph.operation(edge.from);
        let fixed = if by_finish { predecessor.planned_end } else { predecessor.planned_start };
        let reached = if bounds_start { self.start[edge.to] } else { self.finish[edge.to] };
        let (Some(fixed), Some(reached)) = (fixed, reached) else { return };
        for (index, maximum) in gaps(relation, ConditionKind::MaximumGap) {
            if reached.saturating_sub(fixed.ticks()) > maximum {
                let message = format!(
                    "Between {} at {fixed} and {} at {} lies more than the maximum gap.",
                    relation.predecessor_operation_id,
                    relation.successor_operation_id,
                    DateTime::from_ticks(reached)
                );
                let origin =
                    ConflictOrigin::Condition { relation: edge.relation, condition: index };
                self.conflict(origin, message);
            }
        }
    }
}
