//! Import circles: files of which each needs another one, back to the first, and the same among
//! the modules of one parent, each taken with all that lies below it.

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    finding::{Finding, Rule},
    imports::{Import, ImportGraph},
    module_tree::{ModuleId, ModuleTree},
};

type Edges<'a> = BTreeMap<usize, BTreeMap<usize, &'a Import>>;

/// Reports each set of files, and each set of modules of one parent, that import each other in a
/// circle, with the imports that make it.
pub(crate) fn check(graph: &ImportGraph) -> Vec<Finding> {
    let mut files = Edges::new();
    let mut siblings: BTreeMap<ModuleId, Edges<'_>> = BTreeMap::new();
    for import in graph.imports.iter().filter(|import| !import.is_reexport) {
        let (from, to) = (file_of(graph, import.from), file_of(graph, import.to));
        if from != to {
            files.entry(from).or_default().entry(to).or_insert(import);
        }
        if let Some((parent, from, to)) = branches(&graph.tree, import) {
            let edges = siblings.entry(parent).or_default();
            edges.entry(from).or_default().entry(to).or_insert(import);
        }
    }
    let mut findings: Vec<Finding> =
        circles(&files).iter().map(|circle| of_files(graph, &files, circle)).collect();
    for edges in siblings.values() {
        findings.extend(circles(edges).iter().map(|circle| of_modules(graph, edges, circle)));
    }
    findings
}

fn file_of(graph: &ImportGraph, module: ModuleId) -> usize {
    graph.tree.modules[module].file
}

/// Returns the module below which both ends of an import lie, and the two of its children that
/// hold them. None where one end lies below the other: a parent may use its children, and that they
/// do not use it is found by file.
fn branches(tree: &ModuleTree, import: &Import) -> Option<(ModuleId, ModuleId, ModuleId)> {
    let (from, to) = (lineage(tree, import.from), lineage(tree, import.to));
    let fork = from.iter().zip(&to).position(|(from, to)| from != to)?;
    // Another root is another program.
    (fork > 0).then(|| (from[fork - 1], from[fork], to[fork]))
}

/// Returns a module's ancestors, its root first, and the module itself.
fn lineage(tree: &ModuleTree, module: ModuleId) -> Vec<ModuleId> {
    let mut lineage: Vec<ModuleId> =
        std::iter::successors(Some(module), |module| tree.modules[*module].parent).collect();
    lineage.reverse();
    lineage
}

fn of_files(graph: &ImportGraph, edges: &Edges<'_>, circle: &BTreeSet<usize>) -> Finding {
    finding(graph, edges, circle, Rule::ImportCircle, "files")
}

fn of_modules(graph: &ImportGraph, edges: &Edges<'_>, circle: &BTreeSet<ModuleId>) -> Finding {
    finding(graph, edges, circle, Rule::ModuleCircle, "modules")
}

fn finding(
    graph: &ImportGraph,
    edges: &Edges<'_>,
    circle: &BTreeSet<usize>,
    rule: Rule,
    of: &str,
) -> Finding {
    let mut text = format!("circle of {} {of}:", circle.len());
    let mut first = None;
    for from in circle {
        for (to, import) in edges.get(from).into_iter().flatten() {
            if circle.contains(to) {
                let from = &graph.files[file_of(graph, import.from)];
                let to = &graph.files[file_of(graph, import.to)];
                first.get_or_insert((from.clone(), import.line));
                text.push_str(&format!("\n    {from}:{}: {} -> {to}", import.line, import.path));
            }
        }
    }
    let (file, line) = first.unwrap_or_default();
    Finding { file, line, rule, text }
}

/// Returns the strongly connected sets of more than one. A few hundred need no cleverer
/// algorithm than reachability from each.
fn circles(edges: &Edges<'_>) -> Vec<BTreeSet<usize>> {
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

/// Returns what is reached by at least one import, `from` itself only through a circle.
fn reachable_from(edges: &Edges<'_>, from: usize) -> BTreeSet<usize> {
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
