//! Operations and relations as a graph in dependency order.

use std::{collections::HashMap, time::Duration};

use crate::{
    ids::OperationId,
    network::{ConditionKind, Operation, OperationNetwork, OperationRelation, RelationType},
};

/// Ticks of 100 ns; `None` is unknown. Sums saturate: a chain of long gaps leads beyond all time.
pub(super) type Time = Option<i64>;

/// A relation between two known operations, by their positions.
pub(super) struct Edge {
    pub(super) relation: usize,
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) minimum_gap: i64,
    /// The tightest maximum gap, with the position of its condition.
    pub(super) maximum_gap: Option<(i64, usize)>,
}

/// The operations of a network with the edges between them.
pub(super) struct Graph<'n> {
    pub(super) network: &'n OperationNetwork,
    pub(super) edges: Vec<Edge>,
    /// The edges into and out of each operation.
    pub(super) incoming: Vec<Vec<usize>>,
    pub(super) outgoing: Vec<Vec<usize>>,
    /// Dependency order; operations on a cycle are left out.
    pub(super) order: Vec<usize>,
    /// The length of operations whose plan has both ends.
    pub(super) duration: Vec<Option<i64>>,
}

fn ticks(duration: Duration) -> i64 {
    i64::try_from(duration.as_nanos() / 100).unwrap_or(i64::MAX / 4)
}

/// The gaps of a relation of one kind, each with the position of its condition.
pub(super) fn gaps(
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
pub(super) const fn ends(relation_type: RelationType) -> (bool, bool) {
    match relation_type {
        RelationType::FinishToStart => (true, true),
        RelationType::StartToStart => (false, true),
        RelationType::FinishToFinish => (true, false),
        RelationType::StartToFinish => (false, false),
    }
}

impl<'n> Graph<'n> {
    pub(super) fn of(network: &'n OperationNetwork) -> Self {
        let count = network.operation_list.len();
        let positions: HashMap<&OperationId, usize> = network
            .operation_list
            .iter()
            .enumerate()
            .map(|(index, o)| (&o.operation_id, index))
            .collect();
        let mut graph = Self {
            network,
            edges: Vec::new(),
            incoming: vec![Vec::new(); count],
            outgoing: vec![Vec::new(); count],
            order: Vec::with_capacity(count),
            duration: vec![None; count],
        };
        for (index, relation) in network.operation_relation_list.iter().enumerate() {
            let ends = (
                positions.get(&relation.predecessor_operation_id),
                positions.get(&relation.successor_operation_id),
            );
            if let (Some(&from), Some(&to)) = ends
                && from != to
            {
                graph.incoming[to].push(graph.edges.len());
                graph.outgoing[from].push(graph.edges.len());
                // Of several the tightest: all have to hold.
                let minimum_gap = gaps(relation, ConditionKind::MinimumGap)
                    .map(|(_, gap)| gap)
                    .max()
                    .unwrap_or(0);
                let maximum_gap = gaps(relation, ConditionKind::MaximumGap)
                    .map(|(condition, gap)| (gap, condition))
                    .min();
                graph.edges.push(Edge { relation: index, from, to, minimum_gap, maximum_gap });
            }
        }
        for (index, operation) in network.operation_list.iter().enumerate() {
            if let (Some(start), Some(end)) = (operation.planned_start, operation.planned_end) {
                graph.duration[index] = Some((end.ticks() - start.ticks()).max(0));
            }
        }
        graph.sort();
        graph
    }

    fn sort(&mut self) {
        let mut open: Vec<usize> = self.incoming.iter().map(Vec::len).collect();
        // From the back, since the last one is taken first: of equals, those written first come first.
        let mut ready: Vec<usize> = (0..open.len()).rev().filter(|at| open[*at] == 0).collect();
        while let Some(at) = ready.pop() {
            self.order.push(at);
            for &edge in &self.outgoing[at] {
                let to = self.edges[edge].to;
                open[to] -= 1;
                if open[to] == 0 {
                    ready.push(to);
                }
            }
        }
    }

    pub(super) fn operation(&self, at: usize) -> &'n Operation {
        &self.network.operation_list[at]
    }

    pub(super) fn relation(&self, edge: &Edge) -> &'n OperationRelation {
        &self.network.operation_relation_list[edge.relation]
    }
}
