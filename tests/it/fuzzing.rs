//! Fuzz targets: each is played, replayed by the tests of its package, and in the table of docs/fuzzing.md.

use std::{collections::BTreeSet, fs, process::Command};

use crate::promises::{quoted, root};

/// Returns package, name and description of each committed target.
fn targets() -> Vec<(String, String, String)> {
    let listed = Command::new("git")
        .args(["ls-files", "-z", "*/fuzz_targets/*.rs"])
        .current_dir(root())
        .output()
        .unwrap();
    let files = String::from_utf8(listed.stdout).unwrap();
    let target = |file: &str| {
        let (package, name) = file.split_once("/fuzz/fuzz_targets/").unwrap();
        let source = fs::read_to_string(root().join(file)).unwrap();
        let lines: Vec<&str> =
            source.lines().filter_map(|line| line.strip_prefix("//!")).map(str::trim).collect();
        (package.to_owned(), name.trim_end_matches(".rs").to_owned(), lines.join(" "))
    };
    files.split('\0').filter(|file| !file.is_empty()).map(target).collect()
}

#[test]
fn every_fuzz_target_is_played_and_what_it_found_is_replayed() {
    let script = fs::read_to_string(root().join("tools/fuzz.sh")).unwrap();
    let targets = targets();
    assert!(targets.len() > 15, "{targets:?}");
    let mut names = BTreeSet::new();
    for (package, name, _) in &targets {
        // All programs are built into one folder.
        assert!(names.insert(name), "two targets are called {name}");
        let folder = format!(" {package}/fuzz");
        let is_played =
            script.contains(&format!("{folder} ")) || script.contains(&format!("{folder};"));
        assert!(is_played, "tools/fuzz.sh leaves {package} out");
        let replay = root().join(package).join("tests/it/corpus.rs");
        let replay = fs::read_to_string(replay).unwrap_or_default();
        assert!(replay.contains(&format!("\"{name}\"")), "{name} is not replayed");
        let grown = root().join(package).join(format!("fuzz/corpus/{name}.base64"));
        assert!(grown.exists(), "{name} has no grown corpus: run `tools/fuzz.sh keep {name}`");
    }
}

#[test]
fn the_table_of_fuzz_targets_is_that_of_the_folders() {
    let document = fs::read_to_string(root().join("docs/fuzzing.md")).unwrap();
    let rows: Vec<Vec<&str>> = document
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.strip_suffix(" |"))
        .map(|row| row.split(" | ").collect())
        .collect();
    let expected: Vec<(String, String, String)> = targets();
    assert_eq!(rows.len(), expected.len(), "a row for each target");
    for ((package, name, description), row) in expected.iter().zip(rows) {
        let [named, folder, holds, inputs, seconds, most, commit, day, found] = row[..] else {
            panic!("nine cells, which have no bar in them: {row:?}")
        };
        assert_eq!(named.trim_end_matches('`'), name, "in the order of the folders");
        assert_eq!(quoted(folder), [format!("{package}/fuzz")], "{name}");
        assert_eq!(holds, description, "{name}");
        let run = [inputs, seconds, most, commit, day, found];
        if run == ["-"; 6] {
            continue;
        }
        // What `RECORD=1 make fuzz` writes: a run of the committed tree that found nothing, or says so.
        let numbers = [inputs, seconds, most].map(str::parse::<u64>);
        assert!(numbers.iter().all(Result::is_ok), "{name}: {run:?}");
        assert!(
            commit.len() >= 8 && commit.bytes().all(|it| it.is_ascii_hexdigit()),
            "{name}: {commit}"
        );
        assert!(!found.is_empty() && day.len() == "2026-11-26".len(), "{name}: {run:?}");
    }
}
