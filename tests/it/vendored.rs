//! The lists of patches of vendored crates: each patch names the tests that stand against what it mends.

use std::{collections::BTreeSet, fs};

use crate::promises::{quoted, root, tests_of};

/// Lists of patches.
const LISTS: [&str; 3] =
    ["vendor/async-opcua/README.md", "vendor/fe2o3-amqp/README.md", "vendor/serde_amqp/README.md"];

/// Returns the faults of a list: rows out of order or of another form, and tests that are not there.
fn faults(list: &str, document: &str, tests: &BTreeSet<String>) -> Vec<String> {
    let mut rows = document.lines().filter(|line| line.starts_with('|'));
    let mut faults = Vec::new();
    if rows.next() != Some("| # | File | Patch | Why | Test |") {
        faults.push(format!("{list}: the table has another head"));
    }
    for (number, row) in (1..).zip(rows.skip(1)) {
        let cells: Vec<&str> = row.trim_matches(['|', ' ']).split(" | ").collect();
        let [named, files, _, _, proofs] = cells[..] else {
            faults.push(format!("{list}: row {number} has {} cells", cells.len()));
            continue;
        };
        if named != number.to_string() {
            faults.push(format!("{list}: patch {named} stands at place {number}"));
        }
        let (files, proofs) = (quoted(files), quoted(proofs));
        if files.is_empty() || proofs.is_empty() {
            faults.push(format!("{list}: patch {named} names no file, or no test"));
        }
        let missing = proofs.into_iter().filter(|proof| !tests.contains(proof));
        faults.extend(missing.map(|proof| format!("{list}: patch {named}: no test {proof}")));
    }
    faults
}

#[test]
fn every_patch_has_a_test() {
    let tests = tests_of(|_| true);
    for list in LISTS {
        let document = fs::read_to_string(root().join(list)).unwrap();
        let count = document.lines().filter(|line| line.starts_with("| ")).count();
        assert!(count > 5, "{list} has {count} patches");
        assert_eq!(faults(list, &document, &tests), [""; 0]);
    }
}

#[test]
fn a_patch_without_a_test_is_found() {
    let tests = BTreeSet::from(["twin::there".to_owned()]);
    let list = |rows: &str| {
        let document = format!("| # | File | Patch | Why | Test |\n|---|---|---|---|---|\n{rows}");
        faults("list", &document, &tests)
    };
    assert_eq!(list("| 1 | `a.rs` | p | w | `twin::there` |"), [""; 0]);
    assert_eq!(
        list("| 1 | `a.rs` | p | w | `twin::there`, `twin::gone` |"),
        ["list: patch 1: no test twin::gone"]
    );
    assert_eq!(
        list("| 1 | `a.rs` | p | w | by hand |"),
        ["list: patch 1 names no file, or no test"]
    );
    assert_eq!(list("| 1 | `a.rs` | p | w |"), ["list: row 1 has 4 cells"]);
    assert_eq!(list("| 2 | `a.rs` | p | w | `twin::there` |"), ["list: patch 2 stands at place 1"]);
}

#[test]
fn the_tests_of_patched_crates_are_played() {
    let makefile = fs::read_to_string(root().join("Makefile")).unwrap();
    assert!(makefile.contains("--manifest-path vendor/Cargo.toml"));
    let manifest = fs::read_to_string(root().join("vendor/Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let played: BTreeSet<&str> = manifest["workspace"]["members"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(toml::Value::as_str)
        .collect();
    let whole = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let whole: toml::Table = whole.parse().unwrap();
    let patched: BTreeSet<&str> = whole["patch"]["crates-io"]
        .as_table()
        .unwrap()
        .values()
        .filter_map(|patch| patch["path"].as_str()?.strip_prefix("vendor/"))
        .collect();
    assert_eq!(played, patched);
}
