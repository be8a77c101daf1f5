//! Rules of form for the sources of this workspace: module structure, documentation, size and
//! vocabulary.
//!
//! [`Package::read`] parses the Rust sources of one package, [`check`] returns all findings except
//! those of the module walls, which the caller hands to [`check_walls`]. [`check_texts`] reads what
//! is no Rust.

mod asserts;
mod circles;
mod columns;
mod docs;
mod exceptions;
mod finding;
mod imports;
mod lexer;
mod module_tree;
mod package;
mod resolve;
mod size;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
mod texts;
mod type_names;
mod types;
mod walls;
mod web_code;
mod words;

pub use exceptions::unneeded_exceptions;
pub use finding::{Finding, Rule};
pub use package::{Package, ReadError, Role, SourceFile};
pub use texts::check_texts;
pub use type_names::{DeclaredTypes, SharedName, check_type_names};
pub use types::{Exemption, check_type_sizes};
pub use walls::{Wall, check_walls};
pub use words::{BANNED_NAMES, BANNED_WORDS, BannedWord};

/// Returns the findings of every rule that needs no table, ordered by file and line.
#[must_use]
pub fn check(package: &Package) -> Vec<Finding> {
    let graph = imports::ImportGraph::of(package);
    let mut findings = circles::check(&graph);
    findings.extend(asserts::check(package));
    findings.extend(columns::check(package));
    findings.extend(docs::check(package, &graph));
    findings.extend(size::check(package));
    findings.extend(types::check_spread(package, &graph));
    findings.extend(words::check(package));
    findings.sort();
    findings
}
