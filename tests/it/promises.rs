//! The tables of promises and of attacks name only proofs that exist.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use verbund_tests::bench::goals::{Bound, GOALS};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the texts between backticks in the last cells of the tables' rows.
fn named_proofs(document: &str) -> Vec<String> {
    let rows = document.lines().filter(|line| line.starts_with('|'));
    let last_cell = |row: &str| row.trim_end_matches([' ', '|']).rsplit(" | ").next().map(quoted);
    rows.filter_map(last_cell).flatten().collect()
}

/// Returns the texts between backticks.
pub fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// Returns `package::function` of each test in the committed sources, patched crates left out: functions below
/// an attribute that ends in `test`, and those of `proptest!`.
fn tests() -> BTreeSet<String> {
    tests_of(|file| !file.starts_with("vendor/"))
}

/// Returns `package::function` of each test in some of the committed sources.
pub fn tests_of(is_meant: impl Fn(&str) -> bool) -> BTreeSet<String> {
    let listed =
        Command::new("git").args(["ls-files", "-z", "*.rs"]).current_dir(root()).output().unwrap();
    let files = String::from_utf8(listed.stdout).unwrap();
    let mut tests = BTreeSet::new();
    for file in files.split('\0').filter(|file| !file.is_empty() && is_meant(file)) {
        // Listed and not there: being moved.
        let Ok(source) = fs::read_to_string(root().join(file)) else { continue };
        let package = package_of(file);
        tests.extend(test_names(&source).into_iter().map(|name| format!("{package}::{name}")));
    }
    tests
}

fn test_names(source: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut is_test = false;
    for line in source.lines().map(str::trim) {
        if line.starts_with("#[test]") || line.starts_with("#[tokio::test") {
            is_test = true;
        } else if let Some(rest) =
            line.strip_prefix("async fn ").or_else(|| line.strip_prefix("fn ")).filter(|_| is_test)
        {
            names.extend(rest.split('(').next().map(str::to_owned));
            is_test = false;
        }
    }
    names
}

/// Returns the name of the package that a file belongs to.
fn package_of(file: &str) -> String {
    let manifest = Path::new(file)
        .ancestors()
        .skip(1)
        .map(|folder| root().join(folder).join("Cargo.toml"))
        .find(|manifest| manifest.exists())
        .unwrap();
    let manifest: toml::Table = fs::read_to_string(manifest).unwrap().parse().unwrap();
    let name = manifest.get("package").and_then(|package| package.get("name"));
    name.and_then(|name| name.as_str()).unwrap_or_default().to_owned()
}

#[test]
fn every_proof_exists() {
    let document = fs::read_to_string(root().join("docs/promises.md")).unwrap();
    let makefile = fs::read_to_string(root().join("Makefile")).unwrap();
    let (proofs, tests) = (named_proofs(&document), tests());
    assert!(proofs.len() > 100, "{} proofs were read", proofs.len());
    let exists = |proof: &String| {
        if let Some(figure) = proof.strip_prefix("bench: ") {
            GOALS.iter().any(|goal| goal.figure == figure)
        } else if let Some(target) = proof.strip_prefix("make ") {
            makefile.lines().any(|line| line.starts_with(&format!("{target}:")))
        } else if proof.contains('/') {
            root().join(proof).exists()
        } else {
            tests.contains(proof)
        }
    };
    let missing: Vec<&String> = proofs.iter().filter(|proof| !exists(proof)).collect();
    assert!(missing.is_empty(), "named in docs/promises.md and not there:\n{missing:#?}");
}

#[test]
fn every_attack_has_a_test_and_every_mutant_its_attack() {
    let document = fs::read_to_string(root().join("docs/attacks.md")).unwrap();
    let tests = tests();
    let mut mutants = BTreeSet::new();
    let (document, edges) = document.split_once("\n## At the edges\n").expect("both parts");
    assert_edges(edges, &tests);
    let rows = document.lines().filter(|line| line.starts_with("| ") && !line.contains("Mutant"));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(" | ").collect();
        let [attack, proofs, patches] = cells[..] else { panic!("three cells: {row}") };
        let proofs = quoted(proofs);
        let missing: Vec<&String> = proofs.iter().filter(|proof| !tests.contains(*proof)).collect();
        assert!(!proofs.is_empty() && missing.is_empty(), "{attack}: {missing:?}");
        assert!(!quoted(patches).is_empty(), "{attack}: no mutant brings it back");
        for patch in quoted(patches) {
            assert!(root().join(&patch).exists(), "{attack}: {patch}");
            mutants.insert(patch);
        }
        count += 1;
    }
    assert!(count > 30, "{count} attacks were read");
    for part in ["ledger", "platform"] {
        let folder = format!("tests/mutants/{part}");
        for entry in fs::read_dir(root().join(&folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let patch = format!("{folder}/{name}");
            let is_named = !name.ends_with(".patch") || mutants.contains(&patch);
            assert!(is_named, "docs/attacks.md does not name {patch}");
        }
    }
}

/// Returns the names of all probes.
fn probes() -> BTreeSet<String> {
    let source = fs::read_to_string(root().join("tests/src/probes/attacks.rs")).unwrap();
    let mut probes: BTreeSet<String> = quoted_twice(&source).map(str::to_owned).collect();
    probes.retain(|text| text.contains(' '));
    let of_load = ["siege", "downloads that nobody reads", "scripts without walls"];
    probes.extend(of_load.map(str::to_owned));
    assert!(probes.len() > 40, "{probes:?}");
    probes
}

/// Returns the texts between quotation marks.
fn quoted_twice(source: &str) -> impl Iterator<Item = &str> {
    source.split('"').skip(1).step_by(2)
}

/// Each row names tests that exist, and probes that are played; each probe is named.
fn assert_edges(table: &str, tests: &BTreeSet<String>) {
    let (table, findings) =
        table.split_once("\n## Findings of the security review\n").expect("both parts");
    assert!(!findings.is_empty());
    let probes = probes();
    let mut unnamed: BTreeSet<&str> = probes.iter().map(String::as_str).collect();
    let rows: Vec<_> = table.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert!(rows.len() > 30, "{} attacks were read", rows.len());
    for row in rows {
        let [attack, proofs, played] = row.split(" | ").collect::<Vec<_>>()[..] else {
            panic!("three cells: {row}")
        };
        let proofs = quoted(proofs);
        let missing: Vec<_> = proofs.iter().filter(|proof| !tests.contains(*proof)).collect();
        assert!(!proofs.is_empty() && missing.is_empty(), "{attack}: {missing:?}");
        for probe in quoted(played) {
            assert!(probes.contains(probe.as_str()), "{attack}: there is no probe {probe:?}");
            unnamed.remove(probe.as_str());
        }
    }
    assert!(unnamed.is_empty(), "docs/attacks.md names no attack for {unnamed:?}");
}

/// Findings of the security review, but for the one that is in the tables of the platform as a whole.
fn findings() -> BTreeSet<String> {
    let numbered = |severity: &str, last: usize| {
        let severity = severity.to_owned();
        (1..=last).map(move |number| format!("{severity}{number}"))
    };
    let all = numbered("C", 2).chain(numbered("H", 5)).chain(numbered("M", 11));
    all.chain(numbered("L", 16)).filter(|finding| finding != "C1").collect()
}

#[test]
fn every_finding_of_the_review_is_an_attack_with_a_probe_or_says_why_not() {
    let document = fs::read_to_string(root().join("docs/attacks.md")).unwrap();
    let (attacks, table) =
        document.split_once("\n## Findings of the security review\n").expect("both parts");
    let rows = || attacks.lines().filter(|line| line.starts_with("| "));
    let probes = probes();
    let (mut named, mut probed) = (BTreeSet::new(), BTreeSet::new());
    let (mut excused, mut mutants) = (BTreeSet::new(), BTreeSet::new());
    for row in table.lines().filter(|line| line.starts_with("| ")).skip(1) {
        let cells: Vec<&str> = row.trim_end_matches(" |").split(" | ").collect();
        let [finding, attack, reason, mutant] = cells[..] else { panic!("four cells: {row}") };
        let finding = finding.trim_start_matches("| ").to_owned();
        let beginning = format!("| {attack} | ");
        let mut same = rows().filter(|row| row.starts_with(&beginning));
        let of_attack = same.next().unwrap_or_else(|| panic!("{finding}: no row says {attack:?}"));
        assert!(same.next().is_none(), "{finding}: two rows say {attack:?}");
        if quoted(of_attack).iter().any(|name| probes.contains(name)) {
            probed.insert(finding.clone());
        }
        if reason != "-" {
            assert!(reason.len() > 20, "{finding}: {reason}");
            excused.insert(finding.clone());
        }
        match &quoted(mutant)[..] {
            [] => assert!(mutant.len() > 20, "{finding}: neither a mutant nor a reason"),
            patches => {
                let is_there = |patch: &String| root().join(patch).is_file();
                assert!(patches.iter().all(is_there), "{finding}: {mutant}");
                mutants.extend(patches.iter().cloned());
            }
        }
        named.insert(finding);
    }
    for entry in fs::read_dir(root().join("tests/mutants/edges")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let patch = format!("tests/mutants/edges/{name}");
        let is_named = !name.ends_with(".patch") || mutants.contains(&patch);
        assert!(is_named, "no finding in docs/attacks.md names {patch}");
    }
    assert_eq!(named, findings());
    assert_eq!(named.len(), 33);
    let silent: Vec<_> =
        named.iter().filter(|it| probed.contains(*it) == excused.contains(*it)).collect();
    assert!(silent.is_empty(), "neither a probe nor a reason, or both: {silent:?}");
}

#[test]
fn every_threat_names_tests_that_exist() {
    let document = fs::read_to_string(root().join("docs/threat-model.md")).unwrap();
    let (proofs, tests) = (named_proofs(&document), tests());
    let named: Vec<&String> = proofs.iter().filter(|proof| proof.contains("::")).collect();
    assert!(named.len() > 40, "{} tests were read", named.len());
    let missing: Vec<&&String> = named.iter().filter(|proof| !tests.contains(**proof)).collect();
    assert!(missing.is_empty(), "named in docs/threat-model.md and not there:\n{missing:#?}");
}

#[test]
fn every_threat_of_every_boundary_has_a_proof_or_says_that_none_does() {
    let document = fs::read_to_string(root().join("docs/threat-model.md")).unwrap();
    let makefile = fs::read_to_string(root().join("Makefile")).unwrap();
    let boundaries: Vec<&str> =
        document.split("\n## ").filter(|p| p.starts_with("Boundary")).collect();
    assert_eq!(boundaries.len(), 10);
    for boundary in boundaries {
        let heading = boundary.lines().next().unwrap();
        let rows =
            boundary.lines().filter(|line| line.starts_with("| ") && !line.contains("Threat |"));
        let mut count = 0;
        for row in rows {
            let proofs = row.trim_end_matches([' ', '|']).rsplit(" | ").next().unwrap();
            let says_so = proofs.starts_with("no test") || proofs.contains(".md)");
            assert!(says_so || !quoted(proofs).is_empty(), "{heading}: {row}");
            for proof in quoted(proofs).iter().filter(|proof| !proof.contains("::")) {
                let target = proof.strip_prefix("make ").map(|target| format!("\n{target}:"));
                let is_there = target.map_or_else(
                    || root().join(proof).exists() || makefile.contains(proof.as_str()),
                    |target| makefile.contains(&target),
                );
                assert!(is_there, "{heading}: {proof} is not there");
            }
            count += 1;
        }
        assert!(count > 2, "{heading}: {count} threats were read");
    }
}

/// A threat is the attack where one of its tests is the attack's: both say what stands against it.
#[test]
fn every_attack_at_the_edges_is_a_threat() {
    let attacks = fs::read_to_string(root().join("docs/attacks.md")).unwrap();
    let model = fs::read_to_string(root().join("docs/threat-model.md")).unwrap();
    let (_, edges) = attacks.split_once("\n## At the edges\n").expect("both parts");
    let (edges, _) =
        edges.split_once("\n## Findings of the security review\n").expect("both parts");
    let threats: BTreeSet<String> = named_proofs(&model).into_iter().collect();
    let rows: Vec<_> = edges.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert!(rows.len() > 30, "{} attacks were read", rows.len());
    let is_threat = |row: &&&str| {
        let proofs = row.split(" | ").nth(1).map(quoted).unwrap_or_default();
        proofs.iter().any(|proof| threats.contains(proof))
    };
    let missing: Vec<_> = rows.iter().filter(|row| !is_threat(row)).collect();
    assert!(missing.is_empty(), "docs/threat-model.md has no row for these attacks:\n{missing:#?}");
}

#[test]
fn every_row_has_a_proof_or_says_what_brings_one() {
    let document = fs::read_to_string(root().join("docs/promises.md")).unwrap();
    let is_head = |row: &&str| row.ends_with(" Proof |") || row.starts_with("|---");
    let rows: Vec<&str> =
        document.lines().filter(|line| line.starts_with('|')).filter(|row| !is_head(row)).collect();
    assert!(rows.len() > 100, "{} rows were read", rows.len());
    let lacking: Vec<&&str> = rows
        .iter()
        .filter(|row| {
            let proof = row.trim_end_matches([' ', '|']).rsplit(" | ").next().unwrap();
            let is_open = proof.to_lowercase().contains("not yet");
            let says_when = proof.contains("comes with ") || proof.contains("come with ");
            (!proof.contains('`') && !is_open) || (is_open && !says_when)
        })
        .collect();
    assert!(lacking.is_empty(), "rows of docs/promises.md without a proof:\n{lacking:#?}");
}

#[test]
fn every_goal_of_a_figure_is_a_promise() {
    let document = fs::read_to_string(root().join("docs/promises.md")).unwrap();
    let proofs = named_proofs(&document);
    for goal in GOALS.iter().filter(|goal| !matches!(goal.bound, Bound::Context)) {
        let name = format!("bench: {}", goal.figure);
        assert!(proofs.contains(&name), "docs/promises.md does not name `{name}`");
    }
}

#[test]
fn every_pain_and_every_feature_has_its_row() {
    let document = fs::read_to_string(root().join("docs/promises.md")).unwrap();
    let numbers = |heading: &str| {
        let part = document.split("\n## ").find(|part| part.starts_with(heading)).unwrap();
        let rows = part.lines().filter_map(|line| line.strip_prefix("| ")?.split(" |").next());
        rows.filter_map(|number| number.parse().ok()).collect::<Vec<u32>>()
    };
    assert_eq!(numbers("Pains of the field"), (1..=19).collect::<Vec<u32>>());
    assert_eq!(numbers("Features that users compare"), (1..=34).collect::<Vec<u32>>());
}
