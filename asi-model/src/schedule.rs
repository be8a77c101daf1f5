//! The time frames of a network: earliest and latest times, slack and the critical path.
//!
//! One pass forward over the operations in dependency order gives the earliest times, one backward the latest. Planned
//! times are what an operation waits for: it does not start before its planned start, and lasts as long as its plan.
//! The passes take time linear in operations and relations.

use std::{collections::HashMap, time::Duration};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    ids::OperationId,
    network::{ConditionKind, IsoDuration, OperationNetwork, OperationRelation, RelationType},
    values::DateTime,
};

/// The result of the passes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Schedule {
    /// One entry per operation, in the network's order.
    pub operations: Vec<OperationTimes>,
    /// The operations whose delay delays the whole, in order of time. Empty where nothing is planned.
    pub critical_path: Vec<OperationId>,
    /// Bounds that cannot hold together.
    pub conflicts: Vec<Conflict>,
}

/// When an operation can take place. Times are absent where neither it nor what it depends on is planned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperationTimes {
    /// The operation.
    pub operation_id: OperationId,
    /// Not before this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earliest_start: Option<DateTime>,
    /// Not done before this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub earliest_finish: Option<DateTime>,
    /// To be begun by then, or the whole is late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest_start: Option<DateTime>,
    /// To be done by then, or the whole is late.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latest_finish: Option<DateTime>,
    /// How much later it may be without delaying the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slack: Option<IsoDuration>,
    /// True where there is no slack.
    pub is_critical: bool,
}

/// A bound that cannot hold together with the others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// The bound.
    pub place: ConflictPlace,
    /// A sentence that names the operations and times.
    pub message: String,
}

/// Where a bound stands in the network, by position in its lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ConflictPlace {
    PlannedStart { operation: usize },
    PlannedEnd { operation: usize },
    Condition { relation: usize, condition: usize },
}

/// Most conflicts reported.
const CONFLICTS_MAX: usize = 100;

impl Schedule {
    /// Computes the time frames. Relations that name unknown operations are left out, and where the relations form a
    /// cycle, so are the operations on it (the validation reports both).
    #[must_use]
    pub fn of(network: &OperationNetwork) -> Self {
        Pass::new(network).run()
    }
}

/// Ticks of 100 ns; `None` is unknown.
type Time = Option<i64>;

struct Link {
    relation: usize,
    from: usize,
    to: usize,
    minimum_gap: i64,
}

struct Pass<'n> {
    network: &'n OperationNetwork,
    links: Vec<Link>,
    /// The links into and out of each operation.
    incoming: Vec<Vec<usize>>,
    outgoing: Vec<Vec<usize>>,
    order: Vec<usize>,
    duration: Vec<i64>,
    start: Vec<Time>,
    finish: Vec<Time>,
    conflicts: Vec<Conflict>,
}

fn ticks(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos() / 100).unwrap_or(i64::MAX / 4)
}

fn gap(relation: &OperationRelation, kind: ConditionKind) -> impl Iterator<Item = (usize, i64)> + '_ {
    relation
        .condition_list
        .iter()
        .enumerate()
        .filter(move |(_, condition)| condition.condition_kind == kind)
        .filter_map(|(index, condition)| condition.duration.map(|duration| (index, ticks(duration.0))))
}

/// True where the relation binds the predecessor's finish (else its start), and the successor's start (else finish).
const fn ends(relation_type: RelationType) -> (bool, bool) {
    match relation_type {
        RelationType::FinishToStart => (true, true),
        RelationType::StartToStart => (false, true),
        RelationType::FinishToFinish => (true, false),
        RelationType::StartToFinish => (false, false),
    }
}

impl<'n> Pass<'n> {
    fn new(network: &'n OperationNetwork) -> Self {
        let count = network.operation_list.len();
        let positions: HashMap<&OperationId, usize> =
            network.operation_list.iter().enumerate().map(|(index, o)| (&o.operation_id, index)).collect();
        let mut pass = Self {
            network,
            links: Vec::new(),
            incoming: vec![Vec::new(); count],
            outgoing: vec![Vec::new(); count],
            order: Vec::with_capacity(count),
            duration: vec![0; count],
            start: vec![None; count],
            finish: vec![None; count],
            conflicts: Vec::new(),
        };
        for (index, relation) in network.operation_relation_list.iter().enumerate() {
            let ends =
                (positions.get(&relation.predecessor_operation_id), positions.get(&relation.successor_operation_id));
            if let (Some(&from), Some(&to)) = ends
                && from != to
            {
                pass.incoming[to].push(pass.links.len());
                pass.outgoing[from].push(pass.links.len());
                let minimum_gap = gap(relation, ConditionKind::MinimumGap).map(|(_, gap)| gap).max().unwrap_or(0);
                pass.links.push(Link { relation: index, from, to, minimum_gap });
            }
        }
        for (index, operation) in network.operation_list.iter().enumerate() {
            if let (Some(start), Some(end)) = (operation.planned_start, operation.planned_end) {
                pass.duration[index] = (end.ticks() - start.ticks()).max(0);
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

    fn run(mut self) -> Schedule {
        for position in 0..self.order.len() {
            self.forward(self.order[position]);
        }
        self.check_upper_bounds();
        let (latest_start, latest_finish) = self.backward();
        self.result(&latest_start, &latest_finish)
    }

    /// The earliest times of one operation from those of what it depends on.
    fn forward(&mut self, at: usize) {
        let operation = &self.network.operation_list[at];
        let (mut start, mut finish): (Time, Time) = (None, None);
        for &index in &self.incoming[at] {
            let link = &self.links[index];
            let relation = &self.network.operation_relation_list[link.relation];
            let (by_finish, bounds_start) = ends(relation.relation_type);
            let from = if by_finish { self.finish[link.from] } else { self.start[link.from] };
            let bound = from.map(|time| time + link.minimum_gap);
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
        let duration = self.duration[at];
        // A late finish moves the start of a plan of fixed length.
        let forced_start = start.max(finish.map(|finish| finish - duration));
        if let (Some(planned), Some(forced)) = (operation.planned_start.map(DateTime::ticks), forced_start)
            && forced > planned
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
        // A conflict is reported where it arises; what follows is judged by the plan, lest one fault breeds many.
        let start = if planned_start.is_some() { planned_start } else { forced_start };
        let earliest_finish = start.map(|start| start + duration).max(finish);
        if planned_start.is_none()
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
                let place = ConflictPlace::Condition { relation: relation_index, condition: condition_index };
                let (what, earliest) = match condition.condition_kind {
                    ConditionKind::StartNoLaterThan => ("start", self.start[to]),
                    ConditionKind::FinishNoLaterThan => ("finish", self.finish[to]),
                    _ => continue,
                };
                if let (Some(bound), Some(earliest)) = (condition.time, earliest)
                    && earliest > bound.ticks()
                {
                    let earliest = DateTime::from_ticks(earliest);
                    let message = format!("{successor} must {what} by {bound}, but cannot {what} before {earliest}.");
                    self.conflict(place, message);
                }
            }
            // The predecessor may be later than its earliest time unless its plan fixes it.
            let predecessor = &self.network.operation_list[from];
            let fixed = if by_finish { predecessor.planned_end } else { predecessor.planned_start };
            let reached = if bounds_start { self.start[to] } else { self.finish[to] };
            for (condition_index, maximum) in gap(relation, ConditionKind::MaximumGap).collect::<Vec<_>>() {
                if let (Some(fixed), Some(reached)) = (fixed, reached)
                    && reached - fixed.ticks() > maximum
                {
                    let message = format!(
                        "Between {} at {fixed} and {successor} at {} lies more than the maximum gap.",
                        relation.predecessor_operation_id,
                        DateTime::from_ticks(reached)
                    );
                    let place = ConflictPlace::Condition { relation: relation_index, condition: condition_index };
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
            let lower = |bound: &mut Time, time: i64| *bound = Some(bound.map_or(time, |known| known.min(time)));
            for &index in &self.outgoing[at] {
                let link = &self.links[index];
                let (by_finish, bounds_start) = ends(self.network.operation_relation_list[link.relation].relation_type);
                let bound = if bounds_start { latest_start[link.to] } else { latest_finish[link.to] };
                if let Some(bound) = bound {
                    let bound: i64 = bound;
                    lower(if by_finish { &mut finish } else { &mut start }, bound - link.minimum_gap);
                }
            }
            for &index in &self.incoming[at] {
                for condition in &self.network.operation_relation_list[self.links[index].relation].condition_list {
                    match (condition.condition_kind, condition.time) {
                        (ConditionKind::StartNoLaterThan, Some(time)) => lower(&mut start, time.ticks()),
                        (ConditionKind::FinishNoLaterThan, Some(time)) => lower(&mut finish, time.ticks()),
                        _ => {}
                    }
                }
            }
            let duration = match (self.start[at], self.finish[at]) {
                (Some(start), Some(finish)) => finish - start,
                _ => self.duration[at],
            };
            if let Some(start) = start {
                lower(&mut finish, start + duration);
            }
            latest_finish[at] = finish;
            latest_start[at] = finish.map(|finish| finish - duration);
        }
        (latest_start, latest_finish)
    }

    fn result(self, latest_start: &[Time], latest_finish: &[Time]) -> Schedule {
        let time = |time: Time| time.map(DateTime::from_ticks);
        let mut operations = Vec::with_capacity(self.start.len());
        for (at, operation) in self.network.operation_list.iter().enumerate() {
            let slack = match (self.finish[at].or(self.start[at]), latest_finish[at].or(latest_start[at])) {
                (Some(earliest), Some(latest)) => u64::try_from(latest - earliest).ok(),
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
                    IsoDuration(Duration::new(ticks / 10_000_000, u32::try_from(ticks % 10_000_000).unwrap_or(0) * 100))
                }),
                is_critical: is_planned && slack.is_none_or(|slack| slack == 0),
            });
        }
        let mut critical: Vec<usize> = self.order.iter().copied().filter(|at| operations[*at].is_critical).collect();
        critical.sort_by_key(|at| (self.start[*at], self.finish[*at]));
        let critical_path = critical.into_iter().map(|at| operations[at].operation_id.clone()).collect();
        Schedule { operations, critical_path, conflicts: self.conflicts }
    }
}

#[cfg(test)]
mod tests;
