//! Patches that break a guarantee each, to prove that a test notices (`tests/mutants`).

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

fn patches(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut patches: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|name| name == "patch")).collect();
    patches.sort();
    patches
}

/// The long runs that play them are not part of every test run: a patch that has grown old would
/// be noticed late.
#[test]
fn every_mutant_applies_to_the_tree() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = root.join("tests/mutants");
    let mut all = patches(&folder);
    for part in ["gate", "ledger", "platform", "edges"] {
        all.extend(patches(&folder.join(part)));
    }
    assert!(all.len() > 50, "{} patches only: is the folder right?", all.len());
    let failed: Vec<String> = all
        .iter()
        .filter_map(|patch| {
            let check = Command::new("git")
                .args(["apply", "--check"])
                .arg(patch.canonicalize().unwrap())
                .current_dir(&root)
                .output()
                .unwrap();
            let message = String::from_utf8_lossy(&check.stderr).into_owned();
            (!check.status.success()).then_some(message)
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
