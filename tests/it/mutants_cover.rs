//! The mutants of the gate: each member of a policy has one, and their table is true.

use std::{collections::BTreeSet, fs, path::Path};

use serde_json::Value;

/// Returns the cells of the rows of a table whose first cell is code: that, and the names in the
/// second one.
fn rows(table: &str) -> Vec<(String, Vec<String>)> {
    let cells = |line: &str| {
        let mut cells = line.trim_matches('|').split('|').map(str::trim);
        let member = cells.next()?.strip_prefix('`')?.strip_suffix('`')?.to_owned();
        let names = cells.next()?.split(", ").map(ToOwned::to_owned).collect();
        Some((member, names))
    };
    table.lines().filter(|line| line.starts_with('|')).filter_map(cells).collect()
}

#[test]
fn each_member_of_a_policy_has_a_mutant() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let description = fs::read(root.join("factory-connector/openapi.json")).unwrap();
    let description: Value = serde_json::from_slice(&description).unwrap();
    let policy = &description["components"]["schemas"]["DisclosurePolicy"]["properties"];
    let members: BTreeSet<&str> =
        policy.as_object().expect("a policy has members").keys().map(String::as_str).collect();
    let folder = root.join("tests/mutants/gate");
    let table = fs::read_to_string(folder.join("README.md")).unwrap();
    let rows = rows(&table);
    let listed: BTreeSet<&str> = rows
        .iter()
        .filter(|(_, names)| !names.is_empty())
        .map(|(member, _)| member.as_str())
        .collect();
    assert_eq!(listed, members, "write a mutant for each member, and name it in README.md");
    for (member, names) in &rows {
        for name in names {
            let patch = folder.join(format!("{name}.patch"));
            assert!(patch.is_file(), "{member}: there is no {name}.patch");
        }
    }
    let patches = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    for patch in patches.filter(|path| path.extension().is_some_and(|kind| kind == "patch")) {
        let name = patch.file_stem().unwrap().to_str().unwrap().to_owned();
        assert!(table.contains(&name), "README.md does not name {name}");
    }
}
