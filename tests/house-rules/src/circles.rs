//! Import circles: files of which each needs another one, back to the first.

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    finding::{Finding, Rule},
    imports::{Import, ImportGraph},
};

/// Reports each set of files that import each other in a circle, with the imports that make it.
pub(crate) fn check(graph: &ImportGraph) -> Vec<Finding> {
    let mut edges: BTreeMap<usize, BTreeMap<usize, &Import>> = BTreeMap::new();
    for import in graph.imports.iter().filter(|import| !import.is_reexport) {
        let (from, to) = (file_of(graph, import.from), file_of(graph, import.to));
        if from != to {
            edges.entry(from).or_default().entry(to).or_insert(import);
        }
    }
    circles(&edges).into_iter().map(|circle| finding(graph, &edges, &circle)).collect()
}

fn file_of(graph: &ImportGraph, module: usize) -> usize {
    graph.tree.modules[module].file
}

fn finding(
    graph: &ImportGraph,
    edges: &BTreeMap<usize, BTreeMap<usize, &Import>>,
    circle: &BTreeSet<usize>,
) -> Finding {
    let mut text = format!("circle of {} files:", circle.len());
    let mut first_line = None;
    for from in circle {
        for (to, import) in edges.get(from).into_iter().flatten() {
            if circle.contains(to) {
                first_line.get_or_insert(import.line);
                let (from, to) = (&graph.files[*from], &graph.files[*to]);
                text.push_str(&format!("\n    {from}:{}: {} -> {to}", import.line, import.path));
            }
        }
    }
    Finding {
        file: circle.first().map(|file| graph.files[*file].clone()).unwrap_or_default(),
        line: first_line.unwrap_or(1),
        rule: Rule::ImportCircle,
        text,
    }
}

/// Returns the strongly connected sets of more than one file. A few hundred files need no cleverer
/// algorithm than reachability from each.
fn circles(edges: &BTreeMap<usize, BTreeMap<usize, &Import>>) -> Vec<BTreeSet<usize>> {
    let reachable: BTreeMap<usize, BTreeSet<usize>> =
        edges.keys().map(|from| (*from, reachable_from(edges, *from))).collect();
    let mut placed: BTreeSet<usize> = BTreeSet::new();
    let mut circles = Vec::new();
    for (file, reached) in &reachable {
        if placed.contains(file) || !reached.contains(file) {
            continue;
        }
        let circle: BTreeSet<usize> = reached
            .iter()
            .copied()
            .filter(|other| reachable.get(other).is_some_and(|back| back.contains(file)))
            .collect();
        placed.extend(&circle);
        circles.push(circle);
    }
    circles
}

/// Returns the files reached by at least one import, `from` itself only through a circle.
fn reachable_from(
    edges: &BTreeMap<usize, BTreeMap<usize, &Import>>,
    from: usize,
) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        for next in edges.get(&file).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(*next) {
                open.push(*next);
            }
        }
    }
    reached
}
