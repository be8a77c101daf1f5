//! The passes over a network.

use std::{collections::HashMap, time::Duration};

use super::{Conflict, ConflictPlace, OperationTimes, Schedule};
use crate::{
    ids::OperationId,
    network::{ConditionKind, IsoDuration, OperationNetwork, OperationRelation, RelationType},
    values::DateTime,
};

/// Most conflicts reported.
const CONFLICTS_MAX: usize = 100;

/// Most passes forward. With fewer maximum gaps than this every conflict is found, else those that
/// this many tell.
const PASSES_MAX: usize = 64;

/// Ticks of 100 ns; `None` is unknown. Sums saturate: a chain of long gaps leads beyond all time.
type Time = Option<i64>;

struct Link {
    relation: usize,
    from: usize,
    to: usize,
    minimum_gap: i64,
    /// The tightest maximum gap, with the position of its condition.
    maximum_gap: Option<(i64, usize)>,
}

/// The least that the ends of an operation may be, as the maximum gaps after it demand.
#[derive(Debug, Clone, Copy)]
struct Floor {
    start: Time,
    finish: Time,
}

/// The times while they are found.
pub(super) struct Pass<'n> {
    network: &'n OperationNetwork,
    links: Vec<Link>,
    /// The links into and out of each operation.
    incoming: Vec<Vec<usize>>,
    outgoing: Vec<Vec<usize>>,
    order: Vec<usize>,
    /// The length of operations whose plan has both ends.
    duration: Vec<Option<i64>>,
    floor: Vec<Floor>,
    start: Vec<Time>,
    finish: Vec<Time>,
    conflicts: Vec<Conflict>,
}

fn ticks(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos() / 100).unwrap_or(i64::MAX / 4)
}

fn gap(
    relation: &OperationRelation,
    kind: ConditionKind,
) -> impl Iterator<Item = (usize, i64)> + '_ {
    relation
        .condition_list
        .iter()
        .enumerate()
        .filter(move |(_, condition)| condition.condition_kind == kind)
        .filter_map(|(index, condition)| {
            condition.duration.map(|duration| (index, ticks(duration.0)))
        })
}

/// True where the relation binds the predecessor's finish (else its start), and the successor's
/// start (else finish).
const fn ends(relation_type: RelationType) -> (bool, bool) {
    match relation_type {
        RelationType::FinishToStart => (true, true),
        RelationType::StartToStart => (false, true),
        RelationType::FinishToFinish => (true, false),
        RelationType::StartToFinish => (false, false),
    }
}

impl<'n> Pass<'n> {
    pub(super) fn new(network: &'n OperationNetwork) -> Self {
        let count = network.operation_list.len();
        let positions: HashMap<&OperationId, usize> = network
            .operation_list
            .iter()
            .enumerate()
            .map(|(index, o)| (&o.operation_id, index))
            .collect();
        let mut pass = Self {
            network,
            links: Vec::new(),
            incoming: vec![Vec::new(); count],
            outgoing: vec![Vec::new(); count],
            order: Vec::with_capacity(count),
            duration: vec![None; count],
            floor: Vec::new(),
            start: vec![None; count],
            finish: vec![None; count],
            conflicts: Vec::new(),
        };
        for (index, relation) in network.operation_relation_list.iter().enumerate() {
            let ends = (
                positions.get(&relation.predecessor_operation_id),
                positions.get(&relation.successor_operation_id),
            );
            if let (Some(&from), Some(&to)) = ends
                && from != to
            {
                pass.incoming[to].push(pass.links.len());
                pass.outgoing[from].push(pass.links.len());
                let minimum_gap =
                    gap(relation, ConditionKind::MinimumGap).map(|(_, gap)| gap).max().unwrap_or(0);
                let maximum_gap = gap(relation, ConditionKind::MaximumGap)
                    .map(|(condition, gap)| (gap, condition))
                    .min();
                pass.links.push(Link { relation: index, from, to, minimum_gap, maximum_gap });
            }
        }
        for (index, operation) in network.operation_list.iter().enumerate() {
            if let (Some(start), Some(end)) = (operation.planned_start, operation.planned_end) {
                pass.duration[index] = Some((end.ticks() - start.ticks()).max(0));
            }
        }
        pass.sort();
        pass
    }

    /// Dependency order; operations on a cycle stay out.
    fn sort(&mut self) {
        let mut open: Vec<usize> = self.incoming.iter().map(Vec::len).collect();
        let mut ready: Vec<usize> = (0..open.len()).rev().filter(|at| open[*at] == 0).collect();
        while let Some(at) = ready.pop() {
            self.order.push(at);
            for &link in &self.outgoing[at] {
                let to = self.links[link].to;
                open[to] -= 1;
                if open[to] == 0 {
                    ready.push(to);
                }
            }
        }
    }

    pub(super) fn run(mut self) -> Schedule {
        // Nothing happens before time begins: so conflicts of gaps show where no time is planned at
        // all.
        let unsettled = self.settle(Some(DateTime::MIN.ticks()));
        for position in 0..self.order.len() {
            self.forward(self.order[position], true);
        }
        self.check_upper_bounds();
        if self.conflicts.is_empty() {
            self.note_unsettled(&unsettled);
        }
        self.settle(None);
        let (latest_start, latest_finish) = self.backward();
        self.result(&latest_start, &latest_finish)
    }

    /// Passes forward until the maximum gaps are kept, with nothing before `base`. Returns the
    /// links whose maximum gaps never are.
    fn settle(&mut self, base: Time) -> Vec<usize> {
        self.floor = vec![Floor { start: base, finish: base }; self.start.len()];
        let gaps = self.links.iter().filter(|link| link.maximum_gap.is_some()).count();
        let mut raised = Vec::new();
        for _ in 0..(gaps + 1).min(PASSES_MAX) {
            for position in 0..self.order.len() {
                self.forward(self.order[position], false);
            }
            raised = self.raise_floors();
            if raised.is_empty() {
                break;
            }
        }
        // As many passes as gaps settle everything that can be.
        if gaps < PASSES_MAX { raised } else { Vec::new() }
    }

    /// Lets each predecessor be no earlier than the maximum gap to its successor allows. Returns
    /// the links that did.
    fn raise_floors(&mut self) -> Vec<usize> {
        let mut raised = Vec::new();
        for (index, link) in self.links.iter().enumerate() {
            let Some((maximum, _)) = link.maximum_gap else { continue };
            let (by_finish, bounds_start) =
                ends(self.network.operation_relation_list[link.relation].relation_type);
            let reached = if bounds_start { self.start[link.to] } else { self.finish[link.to] };
            let Some(least) = reached.map(|reached| reached.saturating_sub(maximum)) else {
                continue;
            };
            let predecessor = &self.network.operation_list[link.from];
            let (planned, found, floor) = if by_finish {
                (predecessor.planned_end, self.finish[link.from], &mut self.floor[link.from].finish)
            } else {
                (predecessor.planned_start, self.start[link.from], &mut self.floor[link.from].start)
            };
            // A plan does not give way; that it breaks the gap is found later.
            if planned.is_none() && found.is_none_or(|found| found < least) {
                *floor = (*floor).max(Some(least));
                raised.push(index);
            }
        }
        raised
    }

    /// Maximum gaps that the minimum gaps around them exceed, whatever the times.
    fn note_unsettled(&mut self, links: &[usize]) {
        for &index in links {
            let link = &self.links[index];
            let relation = &self.network.operation_relation_list[link.relation];
            let Some((_, condition)) = link.maximum_gap else { continue };
            let message = format!(
                "The relations between {} and {} need more time than their maximum gap leaves.",
                relation.predecessor_operation_id, relation.successor_operation_id
            );
            let place = ConflictPlace::Condition { relation: link.relation, condition };
            self.conflict(place, message);
        }
    }

    /// The earliest times of one operation from those of what it depends on.
    fn forward(&mut self, at: usize, is_reported: bool) {
        let operation = &self.network.operation_list[at];
        let Floor { mut start, mut finish } = self.floor[at];
        for &index in &self.incoming[at] {
            let link = &self.links[index];
            let relation = &self.network.operation_relation_list[link.relation];
            let (by_finish, bounds_start) = ends(relation.relation_type);
            let from = if by_finish { self.finish[link.from] } else { self.start[link.from] };
            let bound = from.map(|time| time.saturating_add(link.minimum_gap));
            let target = if bounds_start { &mut start } else { &mut finish };
            *target = (*target).max(bound);
            for condition in &relation.condition_list {
                let time = condition.time.map(DateTime::ticks);
                match condition.condition_kind {
                    ConditionKind::StartNoEarlierThan => start = start.max(time),
                    ConditionKind::FinishNoEarlierThan => finish = finish.max(time),
                    _ => {}
                }
            }
        }
        // A late finish moves the start of a plan of fixed length.
        let forced_by_finish =
            finish.zip(self.duration[at]).map(|(finish, duration)| finish.saturating_sub(duration));
        let forced_start = start.max(forced_by_finish);
        if let (Some(planned), Some(forced)) =
            (operation.planned_start.map(DateTime::ticks), forced_start)
            && forced > planned
            && is_reported
        {
            let message = format!(
                "{} is planned to start at {}, but its relations do not let it start before {}.",
                operation.operation_id,
                DateTime::from_ticks(planned),
                DateTime::from_ticks(forced)
            );
            self.conflict(ConflictPlace::PlannedStart { operation: at }, message);
        }
        let planned_start = operation.planned_start.map(DateTime::ticks);
        let planned_end = operation.planned_end.map(DateTime::ticks);
        // A conflict is reported where it arises; what follows is judged by the plan, lest one
        // fault breeds many.
        let start = if planned_start.is_some() { planned_start } else { forced_start };
        let length = self.duration[at].unwrap_or(0);
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
            self.conflict(ConflictPlace::PlannedEnd { operation: at }, message);
        }
        self.start[at] = start;
        self.finish[at] = if planned_end.is_some() { planned_end } else { earliest_finish };
    }

    fn conflict(&mut self, place: ConflictPlace, message: String) {
        if self.conflicts.len() < CONFLICTS_MAX {
            self.conflicts.push(Conflict { place, message });
        }
    }

    /// Conditions that the earliest times already break.
    fn check_upper_bounds(&mut self) {
        for index in 0..self.links.len() {
            let link = &self.links[index];
            let (relation_index, from, to) = (link.relation, link.from, link.to);
            let relation = &self.network.operation_relation_list[relation_index];
            let (by_finish, bounds_start) = ends(relation.relation_type);
            let successor = &relation.successor_operation_id;
            for (condition_index, condition) in relation.condition_list.iter().enumerate() {
                let place = ConflictPlace::Condition {
                    relation: relation_index,
                    condition: condition_index,
                };
                let (what, earliest) = match condition.condition_kind {
                    ConditionKind::StartNoLaterThan => ("start", self.start[to]),
                    ConditionKind::FinishNoLaterThan => ("finish", self.finish[to]),
                    _ => continue,
                };
                if let (Some(bound), Some(earliest)) = (condition.time, earliest)
                    && earliest > bound.ticks()
                {
                    let earliest = DateTime::from_ticks(earliest);
                    let message = format!(
                        "{successor} must {what} by {bound}, but cannot {what} before {earliest}."
                    );
                    self.conflict(place, message);
                }
            }
            // The predecessor may be later than its earliest time unless its plan fixes it.
            let predecessor = &self.network.operation_list[from];
            let fixed = if by_finish { predecessor.planned_end } else { predecessor.planned_start };
            let reached = if bounds_start { self.start[to] } else { self.finish[to] };
            for (condition_index, maximum) in
                gap(relation, ConditionKind::MaximumGap).collect::<Vec<_>>()
            {
                if let (Some(fixed), Some(reached)) = (fixed, reached)
                    && reached.saturating_sub(fixed.ticks()) > maximum
                {
                    let message = format!(
                        "Between {} at {fixed} and {successor} at {} lies more than the maximum gap.",
                        relation.predecessor_operation_id,
                        DateTime::from_ticks(reached)
                    );
                    let place = ConflictPlace::Condition {
                        relation: relation_index,
                        condition: condition_index,
                    };
                    self.conflict(place, message);
                }
            }
        }
    }

    /// The latest times that do not delay the whole, which ends with its last operation.
    fn backward(&self) -> (Vec<Time>, Vec<Time>) {
        let count = self.start.len();
        let (mut latest_start, mut latest_finish) = (vec![None; count], vec![None; count]);
        let end = self.finish.iter().flatten().max().copied();
        for &at in self.order.iter().rev() {
            if self.start[at].is_none() && self.finish[at].is_none() {
                continue;
            }
            let mut start: Time = None;
            let mut finish: Time = end;
            let lower = |bound: &mut Time, time: i64| {
                *bound = Some(bound.map_or(time, |known| known.min(time)))
            };
            for &index in &self.outgoing[at] {
                let link = &self.links[index];
                let (by_finish, bounds_start) =
                    ends(self.network.operation_relation_list[link.relation].relation_type);
                let bound =
                    if bounds_start { latest_start[link.to] } else { latest_finish[link.to] };
                if let Some(bound) = bound {
                    let bound: i64 = bound;
                    let bound = bound.saturating_sub(link.minimum_gap);
                    lower(if by_finish { &mut finish } else { &mut start }, bound);
                }
            }
            for &index in &self.incoming[at] {
                for condition in
                    &self.network.operation_relation_list[self.links[index].relation].condition_list
                {
                    match (condition.condition_kind, condition.time) {
                        (ConditionKind::StartNoLaterThan, Some(time)) => {
                            lower(&mut start, time.ticks())
                        }
                        (ConditionKind::FinishNoLaterThan, Some(time)) => {
                            lower(&mut finish, time.ticks())
                        }
                        _ => {}
                    }
                }
            }
            let duration = match (self.start[at], self.finish[at]) {
                (Some(start), Some(finish)) => finish.saturating_sub(start),
                _ => self.duration[at].unwrap_or(0),
            };
            if let Some(start) = start {
                lower(&mut finish, start.saturating_add(duration));
            }
            latest_finish[at] = finish;
            latest_start[at] = finish.map(|finish| finish.saturating_sub(duration));
        }
        (latest_start, latest_finish)
    }

    fn result(self, latest_start: &[Time], latest_finish: &[Time]) -> Schedule {
        let time = |time: Time| time.map(DateTime::from_ticks);
        let mut operations = Vec::with_capacity(self.start.len());
        for (at, operation) in self.network.operation_list.iter().enumerate() {
            let slack = match (
                self.finish[at].or(self.start[at]),
                latest_finish[at].or(latest_start[at]),
            ) {
                (Some(earliest), Some(latest)) => {
                    u64::try_from(latest.saturating_sub(earliest)).ok()
                }
                _ => None,
            };
            // A negative slack belongs to a conflict; such an operation is critical all the same.
            let is_planned = self.finish[at].is_some() && latest_finish[at].is_some();
            operations.push(OperationTimes {
                operation_id: operation.operation_id.clone(),
                earliest_start: time(self.start[at]),
                earliest_finish: time(self.finish[at]),
                latest_start: time(latest_start[at]),
                latest_finish: time(latest_finish[at]),
                slack: slack.map(|ticks| {
                    IsoDuration(Duration::new(
                        ticks / 10_000_000,
                        u32::try_from(ticks % 10_000_000).unwrap_or(0) * 100,
                    ))
                }),
                is_critical: is_planned && slack.is_none_or(|slack| slack == 0),
            });
        }
        let mut critical: Vec<usize> =
            self.order.iter().copied().filter(|at| operations[*at].is_critical).collect();
        critical.sort_by_key(|at| (self.start[*at], self.finish[*at]));
        let critical_path =
            critical.into_iter().map(|at| operations[at].operation_id.clone()).collect();
        Schedule { operations, critical_path, conflicts: self.conflicts }
    }
}
