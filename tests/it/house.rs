//! Form of the workspace: licences of what we build on, dependencies that enter at one place, and
//! the rules of form for our own sources.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    process::Command,
};

use house_rules::{DeclaredTypes, Finding, Package};
use serde_json::Value;

mod journeys;
mod tables;

/// Licences that may be in the product: permissive ones, and MPL-2.0 file by file.
const LICENCES: [&str; 13] = [
    "MIT",
    "MIT-0",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "MPL-2.0",
    "Unicode-3.0",
    "Zlib",
    "CC0-1.0",
    "0BSD",
    "BSL-1.0",
];

fn metadata() -> Value {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let out = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--offline", "--filter-platform"])
        .arg(format!("{}-unknown-linux-gnu", std::env::consts::ARCH))
        .current_dir(root)
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    serde_json::from_slice(&out.stdout).unwrap()
}

/// True when an SPDX expression of OR, AND, `/` and parentheses can be met with allowed licences.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    let expression = expression.trim();
    if let Some(inner) = expression.strip_prefix('(').and_then(|e| e.strip_suffix(')'))
        && !inner.contains('(')
    {
        return is_allowed(inner);
    }
    for (operator, all) in [(" AND ", true), (" OR ", false)] {
        let parts = split_outside_parentheses(expression, operator);
        if parts.len() > 1 {
            return if all {
                parts.into_iter().all(is_allowed)
            } else {
                parts.into_iter().any(is_allowed)
            };
        }
    }
    LICENCES.contains(&expression)
}

fn split_outside_parentheses<'a>(text: &'a str, operator: &str) -> Vec<&'a str> {
    let (mut parts, mut depth, mut from) = (Vec::new(), 0_i32, 0);
    for (at, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ if depth == 0 && at >= from && text[at..].starts_with(operator) => {
                parts.push(text[from..at].trim());
                from = at + operator.len();
            }
            _ => {}
        }
    }
    parts.push(text[from..].trim());
    parts
}

#[test]
fn licences_are_permissive_or_mpl() {
    for (expression, allowed) in [
        ("MIT OR Apache-2.0", true),
        ("MIT/Apache-2.0", true),
        ("GPL-3.0", false),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR GPL-3.0) AND Unicode-3.0", true),
        ("Apache-2.0 WITH LLVM-exception OR Apache-2.0 OR MIT", true),
    ] {
        assert_eq!(is_allowed(expression), allowed, "{expression}");
    }
    let unfit: Vec<String> = metadata()["packages"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|package| !package["license"].as_str().is_some_and(is_allowed))
        .map(|package| {
            format!("{} {}: {}", package["name"], package["version"], package["license"])
        })
        .collect();
    assert!(unfit.is_empty(), "licences to look at:\n{}", unfit.join("\n"));
}

#[test]
fn cargo_deny_allows_the_same_licences() {
    let rules = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let rules: toml::Table = rules.parse().unwrap();
    let allowed: BTreeSet<&str> =
        rules["licenses"]["allow"].as_array().unwrap().iter().filter_map(|l| l.as_str()).collect();
    assert_eq!(allowed, BTreeSet::from(LICENCES));
}

/// Crates that may name each heavy dependency, which enters at one place of the product. The tests
/// look at stores and speak to brokers from outside, past what they test.
const ENTRANCES: [(&str, &[&str]); 9] = [
    ("async-opcua", &["opcua-stack"]),
    ("fe2o3-amqp", &["messaging", "broker", "verbund-tests"]),
    ("rumqttc", &["messaging", "verbund-tests"]),
    ("rquickjs", &["script-quickjs"]),
    ("tokio-tungstenite", &["websocket"]),
    ("rusqlite", &["factory-connector", "verbund-tests"]),
    ("sqlx", &["factory-connector", "platform", "broker", "verbund-tests"]),
    ("axum", &["daemon", "factory-connector", "platform", "simulator", "verbund-tests"]),
    ("quick-xml", &["asi-model"]),
];

#[test]
fn heavy_dependencies_enter_at_one_place() {
    let metadata = metadata();
    let members: Vec<&str> = metadata["workspace_members"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let mut named_by: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for package in metadata["packages"].as_array().unwrap() {
        if members.contains(&package["id"].as_str().unwrap()) {
            for dependency in package["dependencies"].as_array().unwrap() {
                if dependency["kind"].is_null() {
                    named_by
                        .entry(dependency["name"].as_str().unwrap())
                        .or_default()
                        .push(package["name"].as_str().unwrap());
                }
            }
        }
    }
    for (dependency, entrances) in ENTRANCES {
        for member in named_by.get(dependency).into_iter().flatten() {
            assert!(
                entrances.contains(member),
                "{member} names {dependency}, which may enter only at {entrances:?}"
            );
        }
    }
}

/// Dependencies that no pure package has, neither itself nor through others: executors, databases
/// and what brings them along.
const IMPURE: [&str; 9] = [
    "tokio",
    "mio",
    "smol",
    "async-std",
    "sqlx",
    "sqlx-core",
    "rusqlite",
    "libsqlite3-sys",
    "reqwest",
];

/// Returns the names of all packages that a package is built from, with its own features only.
fn dependencies_of(package: &str) -> BTreeSet<String> {
    let out = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--offline", "--edges", "normal", "--prefix", "none"])
        .args(["--format", "{p}", "--package", package])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let lines = String::from_utf8(out.stdout).unwrap();
    lines.lines().filter_map(|line| line.split(' ').next().map(str::to_owned)).collect()
}

#[test]
fn pure_packages_depend_on_no_executor_or_database() {
    let impure = |package: &str| -> Vec<String> {
        let dependencies = dependencies_of(package);
        assert!(dependencies.contains(package), "{package} is not in its own tree");
        dependencies.into_iter().filter(|name| IMPURE.contains(&name.as_str())).collect()
    };
    assert!(!impure("messaging").is_empty(), "the tree shows what a package is built from");
    for package in tables::PURE {
        let found = impure(package);
        assert!(found.is_empty(), "{package} is pure and depends on {}", found.join(", "));
    }
}

#[test]
fn cloud_and_plant_never_import_each_other() {
    const PLATFORM: &[&str] = &["platform"];
    const PLANT: &[&str] = &["factory-connector", "mapping-engine", "shop-floor", "opcua-stack"];
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    // By the folder that a package lies in, so that a new one is on its side from the start.
    let on = |side: &[&str]| -> BTreeSet<&str> {
        let is_on_side = |package: &&Value| {
            let manifest = Path::new(package["manifest_path"].as_str().unwrap());
            let inside = manifest.strip_prefix(metadata["workspace_root"].as_str().unwrap());
            inside.is_ok_and(|path| side.iter().any(|folder| path.starts_with(folder)))
        };
        packages.iter().filter(is_on_side).filter_map(|package| package["name"].as_str()).collect()
    };
    let (platform, plant) = (on(PLATFORM), on(PLANT));
    assert!(platform.contains("broker") && plant.contains("script-quickjs"));
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let forbidden = if platform.contains(name) {
            &plant
        } else if plant.contains(name) {
            &platform
        } else {
            continue;
        };
        for dependency in package["dependencies"].as_array().unwrap() {
            let is_local = !dependency["path"].is_null() && dependency["kind"].is_null();
            let dependency = dependency["name"].as_str().unwrap();
            assert!(!is_local || !forbidden.contains(&dependency), "{name} imports {dependency}");
        }
    }
}

#[test]
fn no_machine_path_or_registry_host_is_committed() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    // Assembled, so that this file does not find itself.
    let hosts =
        [["crates", "io"], ["npmjs", "org"], ["npmjs", "com"], ["pypi", "org"], ["debian", "org"]]
            .map(|h| h.join("."));
    let out = Command::new("git").args(["ls-files", "-z"]).current_dir(root).output().unwrap();
    let mut found = Vec::new();
    for file in String::from_utf8(out.stdout).unwrap().split('\0').filter(|f| !f.is_empty()) {
        // Cargo writes the registry into its own lock file.
        if file.ends_with("Cargo.lock") || file.starts_with("vendor/") {
            continue;
        }
        let Ok(text) = std::fs::read_to_string(format!("{root}/{file}")) else { continue };
        for host in &hosts {
            if text.contains(host.as_str()) {
                found.push(format!("{file} names {host}"));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the paths of all committed files that a pattern of git fits.
fn committed(pattern: &str) -> Vec<String> {
    let out =
        Command::new("git").args(["ls-files", "-z", pattern]).current_dir(root()).output().unwrap();
    let files = String::from_utf8(out.stdout).unwrap();
    files.split('\0').filter(|file| !file.is_empty()).map(str::to_owned).collect()
}

/// Returns the folders of all packages that are committed, those outside the workspace as well; not
/// the patched copies of others.
fn package_folders() -> Vec<String> {
    let manifests = committed("*/Cargo.toml");
    let folders = manifests.iter().filter_map(|file| file.strip_suffix("/Cargo.toml"));
    folders
        .filter(|folder| *folder != "vendor" && !folder.starts_with("vendor/"))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_package_is_checked() {
    let folders = package_folders();
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let members = manifest["workspace"]["members"].as_array().unwrap();
    let members = members.iter().map(|member| member.as_str().unwrap());
    for folder in members.chain(["mapping-engine/script-deno-core"]) {
        assert!(folders.iter().any(|known| known == folder), "{folder} is not checked");
    }
}

/// Reads and checks packages in threads: parsing is most of the work.
fn findings(folders: &[String], check: fn(&Package) -> Vec<Finding>) -> Vec<Finding> {
    std::thread::scope(|scope| {
        let checkers: Vec<_> = folders
            .iter()
            .map(|folder| scope.spawn(move || check(&Package::read_in(&root(), folder).unwrap())))
            .collect();
        checkers.into_iter().flat_map(|checker| checker.join().unwrap()).collect()
    })
}

fn assert_none(findings: &[Finding]) {
    let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert!(
        lines.is_empty(),
        "{} findings (cargo run -q -p house-rules prints them as well):\n{}",
        lines.len(),
        lines.join("\n")
    );
}

#[test]
fn sources_keep_the_rules_of_form() {
    assert_none(&findings(&package_folders(), house_rules::check));
}

#[test]
fn pages_scripts_and_documentation_speak_the_field_s_words() {
    assert_none(&house_rules::check_texts(&root()).unwrap());
}

#[test]
fn every_exception_from_the_vocabulary_is_needed() {
    let unneeded = house_rules::unneeded_exceptions(&root()).unwrap();
    assert!(unneeded.is_empty(), "exceptions that nothing needs:\n{}", unneeded.join("\n"));
}

#[test]
fn types_have_names_of_their_own() {
    let folders = package_folders();
    let types: Vec<DeclaredTypes> = std::thread::scope(|scope| {
        let read = |folder: &str| DeclaredTypes::of(&Package::read_in(&root(), folder).unwrap());
        let readers: Vec<_> =
            folders.iter().map(|folder| scope.spawn(move || read(folder))).collect();
        readers.into_iter().map(|reader| reader.join().unwrap()).collect()
    });
    let of_product: Vec<DeclaredTypes> = types
        .into_iter()
        .filter(|types| !tables::TEST_PACKAGES.contains(&types.package.as_str()))
        .collect();
    assert_none(&house_rules::check_type_names(&of_product, tables::SHARED_NAMES));
}

#[test]
fn modules_keep_their_walls() {
    let names: Vec<Value> = metadata()["packages"].as_array().unwrap().clone();
    for wall in tables::walls() {
        let is_known = names.iter().any(|package| package["name"] == wall.package);
        assert!(is_known, "a wall names the package {}, which is not there", wall.package);
    }
    let check = |package: &Package| house_rules::check_walls(package, &tables::walls());
    assert_none(&findings(&package_folders(), check));
}

#[test]
fn types_of_the_connector_have_bounds() {
    let check = |package: &Package| {
        if tables::CONNECTOR.contains(&package.name.as_str()) {
            house_rules::check_type_sizes(package, tables::LARGE_TYPES)
        } else {
            Vec::new()
        }
    };
    assert_none(&findings(&package_folders(), check));
}
