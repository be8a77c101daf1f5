//! Names of public types: one name stands for one thing wherever a reader can meet both.
//!
//! A package meets its own types and those of all packages that it depends on, also through others.
//! Two packages that no third one meets, such as connector and platform, may use the same words.

use std::collections::{BTreeMap, BTreeSet};

use syn::{Item, Visibility};

use crate::{
    finding::{Finding, Rule},
    imports::attributes_of,
    module_tree::is_test_only,
    package::{Package, Role},
};

/// A name that several public types may share, with the reason.
#[derive(Debug, Clone, Copy)]
pub struct SharedName {
    pub name: &'static str,
    pub reason: &'static str,
}

/// The public types that the library of a package declares.
pub struct PublicTypes {
    pub package: String,
    dependencies: BTreeSet<String>,
    types: Vec<Declaration>,
}

struct Declaration {
    name: String,
    file: String,
    line: usize,
}

impl PublicTypes {
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
                if matches!(visibility, Visibility::Public(_)) {
                    let line = name.span().start().line;
                    types.push(Declaration {
                        name: name.to_string(),
                        file: file.path.clone(),
                        line,
                    });
                }
            }
        }
        let dependencies = package.dependencies.clone();
        Self { package: package.name.clone(), dependencies, types }
    }
}

/// Reports each public type with the name of another one where a package can meet both, and each
/// listed name that is not shared.
#[must_use]
pub fn check_type_names(packages: &[PublicTypes], shared: &[SharedName]) -> Vec<Finding> {
    let met = met_packages(packages);
    let mut by_name: BTreeMap<&str, Vec<(&PublicTypes, &Declaration)>> = BTreeMap::new();
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
                !std::ptr::eq(*second, *declaration)
                    && met.values().any(|met| {
                        met.contains(package.package.as_str())
                            && met.contains(other.package.as_str())
                    })
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
fn met_packages(packages: &[PublicTypes]) -> BTreeMap<&str, BTreeSet<&str>> {
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
