//! Cycles: no operation may depend on itself, directly or through others.

use std::collections::HashMap;

use super::{FaultCode, reader::Reader};
use crate::{ids::OperationId, network::OperationNetwork};

/// Most operations of a cycle that its fault names.
const NAMED_MAX: usize = 12;
/// Most cycles reported, each as one fault.
const CYCLES_MAX: usize = 10;

/// Notes each cycle once, at a relation that closes it. True where there is none.
pub(super) fn check(
    network: &OperationNetwork,
    operations: &HashMap<&OperationId, usize>,
    pointer: &str,
    reader: &mut Reader,
) -> bool {
    let edges: Vec<Option<(usize, usize)>> = network
        .operation_relation_list
        .iter()
        .map(|relation| {
            let from = *operations.get(&relation.predecessor_operation_id)?;
            let to = *operations.get(&relation.successor_operation_id)?;
            // A relation of an operation with itself has its own fault.
            (from != to).then_some((from, to))
        })
        .collect();
    let mut is_settled = vec![false; network.operation_list.len()];
    let mut is_acyclic = true;
    for _ in 0..CYCLES_MAX {
        settle(&edges, &mut is_settled);
        let Some(cycle) = find_cycle(&edges, &is_settled) else { return is_acyclic };
        is_acyclic = false;
        let names: Vec<&str> = cycle
            .iter()
            .take(NAMED_MAX)
            .map(|(_, operation)| network.operation_list[*operation].operation_id.as_str())
            .collect();
        let more = if cycle.len() > NAMED_MAX { ", ..." } else { "" };
        let message = format!(
            "The relations form a cycle through {}{more}; remove one of them.",
            names.join(", ")
        );
        let relation = cycle.iter().map(|(relation, _)| *relation).max().unwrap_or_default();
        reader.faults.push(
            format!("{pointer}/operationRelationList/{relation}"),
            FaultCode::Cycle,
            message,
        );
        for (_, operation) in cycle {
            is_settled[operation] = true;
        }
    }
    is_acyclic
}

/// Settles every operation whose predecessors are all settled (Kahn's algorithm).
fn settle(edges: &[Option<(usize, usize)>], is_settled: &mut [bool]) {
    let mut successors = vec![Vec::new(); is_settled.len()];
    let mut open_predecessors = vec![0_usize; is_settled.len()];
    for &(from, to) in edges.iter().flatten() {
        if !is_settled[from] {
            successors[from].push(to);
            open_predecessors[to] += 1;
        }
    }
    let mut ready: Vec<usize> = (0..is_settled.len())
        .filter(|at| !is_settled[*at] && open_predecessors[*at] == 0)
        .collect();
    while let Some(at) = ready.pop() {
        is_settled[at] = true;
        for &to in &successors[at] {
            open_predecessors[to] -= 1;
            if open_predecessors[to] == 0 && !is_settled[to] {
                ready.push(to);
            }
        }
    }
}

/// A cycle among the operations that are not settled: each with the relation that leads to it.
/// Every one of them has a predecessor that is not settled either, so walking backwards must come
/// round.
fn find_cycle(
    edges: &[Option<(usize, usize)>],
    is_settled: &[bool],
) -> Option<Vec<(usize, usize)>> {
    let mut predecessor: Vec<Option<(usize, usize)>> = vec![None; is_settled.len()];
    for (relation, edge) in edges.iter().enumerate() {
        if let Some((from, to)) = *edge
            && !is_settled[from]
            && !is_settled[to]
        {
            predecessor[to] = Some((relation, from));
        }
    }
    let start = is_settled.iter().position(|settled| !settled)?;
    let mut visited_at = vec![None; is_settled.len()];
    let mut path = Vec::new();
    let mut at = start;
    while visited_at[at].is_none() {
        visited_at[at] = Some(path.len());
        let (relation, from) = predecessor[at]?;
        path.push((relation, at));
        at = from;
    }
    let mut cycle = path.split_off(visited_at[at]?);
    cycle.reverse();
    Some(cycle)
}
