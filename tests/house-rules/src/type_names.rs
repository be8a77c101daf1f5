//! Names of types: one name stands for one thing wherever a reader can meet both.
//!
//! A package meets all types of its own, private ones as well, and the public ones of the packages
//! that it depends on, also through others. Two packages that no third one meets, such as connector
//! and platform, may use the same words.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Item, Visibility};

use crate::{
    finding::{Finding, Rule},
    imports::attributes_of,
    module_tree::is_test_only,
    package::{Package, Role},
};

/// A name that several types may share, with the reason.
#[derive(Debug, Clone, Copy)]
pub struct SharedName {
    pub name: &'static str,
    pub reason: &'static str,
}

/// The types that the library of a package declares, outside of its tests.
pub struct DeclaredTypes {
    pub package: String,
    dependencies: BTreeSet<String>,
    types: Vec<Declaration>,
}

struct Declaration {
    name: String,
    file: String,
    line: usize,
    is_public: bool,
}

impl DeclaredTypes {
    /// Collects the types of a package. Declarations in macros and blocks are not seen.
    #[must_use]
    pub fn of(package: &Package) -> Self {
        let mut types = Vec::new();
        for file in package.files.iter().filter(|file| file.role == Role::Library) {
            for item in file.syntax.items.iter().filter(|item| !is_test_only(attributes_of(item))) {
                let (visibility, name) = match item {
                    Item::Enum(item) => (&item.vis, &item.ident),
                    Item::Struct(item) => (&item.vis, &item.ident),
                    Item::Trait(item) => (&item.vis, &item.ident),
                    Item::Type(item) => (&item.vis, &item.ident),
                    _ => continue,
                };
                types.push(Declaration {
                    name: name.to_string(),
                    file: file.path.clone(),
                    line: name.span().start().line,
                    is_public: matches!(visibility, Visibility::Public(_)),
                });
            }
        }
        let dependencies = package.dependencies.clone();
        Self { package: package.name.clone(), dependencies, types }
    }
}

/// Reports each type with the name of another one where a package can meet both, and each listed
/// name that is not shared.
#[must_use]
pub fn check_type_names(packages: &[DeclaredTypes], shared: &[SharedName]) -> Vec<Finding> {
    let met = met_packages(packages);
    let mut by_name: BTreeMap<&str, Vec<(&DeclaredTypes, &Declaration)>> = BTreeMap::new();
    for package in packages {
        for declaration in &package.types {
            by_name.entry(&declaration.name).or_default().push((package, declaration));
        }
    }
    let mut findings = Vec::new();
    let mut unused: BTreeSet<&str> = shared.iter().map(|shared| shared.name).collect();
    for (name, declarations) in by_name {
        for (package, declaration) in &declarations {
            let other = declarations.iter().find(|(other, second)| {
                let meets = |met: &BTreeSet<&str>| {
                    met.contains(package.package.as_str()) && met.contains(other.package.as_str())
                };
                let is_met = match (declaration.is_public, second.is_public) {
                    (true, true) => met.values().any(meets),
                    (true, false) => met.get(other.package.as_str()).is_some_and(meets),
                    (false, true) => met.get(package.package.as_str()).is_some_and(meets),
                    (false, false) => package.package == other.package,
                };
                !std::ptr::eq(*second, *declaration) && is_met
            });
            let Some((_, other)) = other else { continue };
            if !unused.remove(name) && !shared.iter().any(|shared| shared.name == name) {
                findings.push(Finding {
                    file: declaration.file.clone(),
                    line: declaration.line,
                    rule: Rule::SharedTypeName,
                    text: format!("`{name}` is another type in {}:{}", other.file, other.line),
                });
            }
        }
    }
    findings.extend(unused.into_iter().map(|name| Finding {
        file: "Cargo.toml".to_owned(),
        line: 1,
        rule: Rule::SharedTypeName,
        text: format!("`{name}` is listed as shared and is not"),
    }));
    findings.sort();
    findings
}

/// Returns for each package itself and those that it depends on, directly or through others.
fn met_packages(packages: &[DeclaredTypes]) -> BTreeMap<&str, BTreeSet<&str>> {
    let direct: BTreeMap<&str, &BTreeSet<String>> =
        packages.iter().map(|package| (package.package.as_str(), &package.dependencies)).collect();
    let mut met = BTreeMap::new();
    for package in direct.keys() {
        let mut seen = BTreeSet::from([*package]);
        let mut open = vec![*package];
        while let Some(package) = open.pop() {
            for dependency in direct.get(package).into_iter().flat_map(|names| names.iter()) {
                if direct.contains_key(dependency.as_str()) && seen.insert(dependency.as_str()) {
                    open.push(dependency);
                }
            }
        }
        met.insert(*package, seen);
    }
    met
}
