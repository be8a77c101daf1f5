//! Module walls: modules that must not know another module or an external crate.

use crate::{
    finding::{Finding, Rule},
    imports::ImportGraph,
    package::Package,
};

/// A wall inside a package: `from` and the modules below it never import `to`.
#[derive(Debug, Clone, Copy)]
pub struct Wall {
    pub package: &'static str,
    /// Module path from the root, for instance `store::rows`; empty for the whole package.
    pub from: &'static str,
    /// Module path likewise; with a leading `::` a path of another crate, for instance
    /// `::std::time::SystemTime::now`.
    pub to: &'static str,
    /// Reason, printed with each finding.
    pub reason: &'static str,
}

/// Reports imports through the walls of this package, and walls between modules that are gone.
#[must_use]
pub fn check_walls(package: &Package, walls: &[Wall]) -> Vec<Finding> {
    let graph = ImportGraph::of(package);
    let mut findings = Vec::new();
    for wall in walls.iter().filter(|wall| wall.package == package.name) {
        findings.extend(stale(package, &graph, wall));
        let mut breach = |module: usize, line: usize, path: &str| {
            findings.push(Finding {
                file: graph.files[graph.tree.modules[module].file].clone(),
                line,
                rule: Rule::ModuleWall,
                text: format!("{} imports {path}: {}", name(wall.from), wall.reason),
            });
        };
        let path_of = |module: usize| graph.tree.modules[module].path.as_str();
        if let Some(external) = wall.to.strip_prefix("::") {
            for used in &graph.external {
                if is_within(path_of(used.from), wall.from) && is_within(&used.path, external) {
                    breach(used.from, used.line, &used.path);
                }
            }
        } else {
            for import in &graph.imports {
                if is_within(path_of(import.from), wall.from)
                    && is_within(path_of(import.to), wall.to)
                    && !is_within(path_of(import.from), wall.to)
                {
                    breach(import.from, import.line, &import.path);
                }
            }
        }
    }
    findings.sort();
    findings.dedup();
    findings
}

/// Reports a side of a wall that no module is on: the table would prove nothing.
fn stale(package: &Package, graph: &ImportGraph, wall: &Wall) -> Vec<Finding> {
    [wall.from, wall.to]
        .into_iter()
        .filter(|path| !path.starts_with("::"))
        .filter(|path| !graph.tree.modules.iter().any(|module| module.path == **path))
        .map(|path| Finding {
            file: package.files.first().map(|file| file.path.clone()).unwrap_or_default(),
            line: 1,
            rule: Rule::ModuleWall,
            text: format!("a wall names the module {path}, which {} has not", package.name),
        })
        .collect()
}

fn is_within(path: &str, ancestor: &str) -> bool {
    ancestor.is_empty()
        || path.strip_prefix(ancestor).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

fn name(module: &str) -> &str {
    if module.is_empty() { "the package" } else { module }
}
