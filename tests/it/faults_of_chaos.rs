//! Faults that the judge of chaos finds: by each a mutant has to be found, or there is a reason why there is none.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// Sources of the judge. Every text of `format!` in them that is no path is a fault, or one of `OTHER_TEXTS`.
const SOURCES: &[&str] = &[
    "findings.rs",
    "counted.rs",
    "kinds.rs",
    "set_back.rs",
    "comments.rs",
    "control.rs",
    "control/taken.rs",
    "content.rs",
    "flow.rs",
    "stores/given_up.rs",
    "stage/supervised.rs",
    "broker_ends.rs",
];

/// Texts that only join or describe others.
const OTHER_TEXTS: &[&str] = &[
    "{key:?}: {what}",
    "{request}, {name}: {fault}",
    "comment {number}",
    "; {decisions} decisions, {refusals} refusals, {revocations} revocations, {revisions} revisions",
    "revoked {number}",
    "Refusal {refused}",
    "{name} of {entry}",
    "{part} %",
];

/// Faults that a mutant brings: words of the source, and how a run may say it.
const FOUND: &[(&str, &str)] = &[
    ("reports are held twice", "FOR_MUC: 3 reports are held twice"),
    ("} is lost: {key:?}", "DONE is lost: ReportKey { factory: \"FOR_MUC\" }"),
    ("announced as given up, and is held:", "announced as given up, and is held: ReportKey {}"),
    ("ledger entries for {recipients}", "FOR_MUC: 490 ledger entries for 500 disclosures"),
    ("sequence numbers from {first} to", "(\"FOR_MUC\", 1, 1): 9 sequence numbers from 1 to 10"),
    ("came after {newest} in the", "ReportKey { sequence: 4 } came after 7 in the live lane"),
    (
        "s lack a good value,",
        "ReqChaos-FOR_MUC-1, counted: reports of 90 s lack a good value, 3 s before the machines stopped",
    ),
    (
        "counts of undisturbed times are in no report",
        "9 of 20 counts of undisturbed times are in no report",
    ),
    (
        "are lost by one disturbance",
        "ReqChaos-FOR_MUC-1, counted: 99 counts after 40 are lost by one disturbance",
    ),
    ("counts have another time than their own", "9 of 20 counts have another time than their own"),
    ("the state of the script goes back", "the state of the script goes back from 9 to 4"),
    ("it is good after the machines stopped", "it is good after the machines stopped"),
    (
        "a comment was taken, and is not stored",
        "a comment was taken, and is not stored: Comment {}",
    ),
    ("a comment is held {count} times", "a comment is held 2 times: Comment {}"),
    ("a comment is lost", "a comment is lost: Comment {}"),
    (
        "is decided otherwise than was taken",
        "FOR_MUC: FieldId {} is decided otherwise than was taken: Refusal 3, None",
    ),
    (
        "revocation {id} was taken, and is not stored",
        "FOR_MUC: revocation 1 was taken, and is not stored",
    ),
    (
        "the toggled field is {toggled:?}, and was taken as",
        "FOR_MUC: the toggled field is Open(None), and was taken as [Open(Some(2.0))]",
    ),
    (
        "with change {number} was taken, the platform has",
        "FOR_MUC: revision 16 with change 3 was taken, the platform has (15, \"As of change 2\")",
    ),
    (
        "is decided {decided:?}, the platform has {found:?}",
        "FOR_MUC: FieldId {} is decided Decided {}, the platform has Some(Decided {})",
    ),
    ("the receipt of revocation {id} is lost", "FOR_MUC: the receipt of revocation 1 is lost"),
    (
        "the network is {:?}, the platform has sent",
        "FOR_MUC: the network is (9, \"a\"), the platform has sent (10, \"b\")",
    ),
    (
        "left for {} at {:?} of {:?}, is held for",
        "left for r at Some(1) of Some(1), is held for r at Some(2) of Some(1)",
    ),
    ("{name} is missing", "ReportKey { sequence: 4 }: counted is missing"),
    (
        "{name} left as {field:?}, is held as",
        "measured left as FieldContent { value: 1, status: \"Bad\" }, is held as FieldContent { value: 1, status: \"Good\" }",
    ),
    (
        "left with the name {left:?}, is held as",
        "ReportKey { sequence: 4 }: left with the name \"Chaos\", is held as \"Chaos \"",
    ),
    (
        "left to the readers {left:?}, is held for",
        "ReportKey { sequence: 4 }: left to the readers {\"acme-aero\"}, is held for {}",
    ),
    (
        "left with the units {left:?}, its request has",
        "ReportKey { sequence: 4 }: left with the units {\"made\": \"piece\"}, its request has {\"made\": \"PIECE\"}",
    ),
    (
        "values are none that its mapping makes",
        "ReqChaos-FOR_MUC-1, scripted: 90 values are none that its mapping makes, as 1.5",
    ),
    ("no reports of {factory} to", "no reports of FOR_MUC to [\"ReqChaos-FOR_MUC-1\"] for 120s"),
    ("announced as given up, and was not", "announced as given up, and was not: ReportKey {}"),
    (
        "announced with the cause {cause}, and given up by",
        "announced with the cause EXPIRED, and given up by {\"COALESCED\"}: ReportKey {}",
    ),
    ("given up by {event} without a reason", "given up by PURGED without a reason: ReportKey {}"),
    ("messages could not be used", "4 messages could not be used"),
    (
        "ended with {status} when it was asked to stop",
        "connector-FOR_MUC ended with exit status: 3 when it was asked to stop",
    ),
    (
        "says that it panicked",
        "the log of platform says that it panicked: thread 'a' panicked at b",
    ),
    ("ended by itself with {status}", "connector-FOR_MUC ended by itself with exit status: 3"),
    (
        "the broker's process has ended by itself",
        "the broker's process has ended by itself, 2 times",
    ),
    (
        "says that scripts lost a worker",
        "the log of connector-FOR_MUC says that scripts lost a worker: WARN A script worker was lost.",
    ),
];

/// Faults without a mutant, and why there is none.
const WITHOUT_MUTANT: &[(&str, &str)] = &[
    (
        "rejected and yet held",
        "no report of a run is rejected: this guards what the judge itself takes for rejected",
    ),
    (
        "never left: {key:?}",
        "nobody but a plant makes reports: tests/mutants/platform has those of forgers",
    ),
    (
        "it {what}, by {} s",
        "the first and last seconds of what another fault finds in between: counts in no report",
    ),
    (
        "no report has a value",
        "report-forgets-a-field brings it, too, which has to be found by what its reports lack",
    ),
    (
        "counts of undisturbed times were judged",
        "it says that a run proves nothing, and not that a promise is broken",
    ),
    (
        "an older store has given a number again",
        "a store is replaced in a test of its own, with a unit test of the judge beside it",
    ),
    (
        "reports are excused from their order",
        "it says that a run proves less than it could, with a unit test beside it",
    ),
    (
        "counts of undisturbed times only {judged} could be judged",
        "it says that a run proves less than it had the time for, with a unit test beside it",
    ),
    (
        "was never decided, the platform has",
        "nobody but a plant decides: tests/mutants/platform has those of forgers",
    ),
    (
        "revocation {id} was never made",
        "nobody but a plant revokes: tests/mutants/platform has those of forgers",
    ),
    (
        "{name} never left",
        "nobody but a plant adds fields: tests/mutants/platform has those of forgers",
    ),
    (
        "not everything was receipted within",
        "what is never receipted is lost, which other faults say by its number",
    ),
    (
        "parts of the network stay unanswered",
        "the demo does not begin without answers: each run would break off before",
    ),
    (
        "does not hold: {}",
        "tests/mutants/ledger has those of a ledger, which are played by make mutants-ledger",
    ),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn source(name: &str) -> String {
    let text = fs::read_to_string(root().join("tests/src/chaos").join(name)).unwrap();
    let text = text.split_once("#[cfg(test)]\nmod tests").map_or(text.as_str(), |(code, _)| code);
    text.to_owned()
}

/// Returns the texts of `format!`, but for paths and names of files.
fn formatted(source: &str) -> Vec<String> {
    let texts = source.split("format!(").skip(1).filter_map(|rest| {
        let mut text = String::new();
        let mut signs = rest.trim_start().strip_prefix('"')?.chars();
        while let Some(sign) = signs.next().filter(|sign| *sign != '"') {
            text.push(sign);
            text.extend((sign == '\\').then(|| signs.next()).flatten());
        }
        Some(text)
    });
    texts.filter(|text| text.contains(' ')).collect()
}

#[test]
fn each_text_of_the_judge_is_a_fault_that_is_listed() {
    let listed = || FOUND.iter().chain(WITHOUT_MUTANT).map(|(words, _)| *words);
    for name in SOURCES {
        for text in formatted(&source(name)) {
            let is_known =
                OTHER_TEXTS.contains(&text.as_str()) || listed().any(|words| text.contains(words));
            assert!(is_known, "{name}: list {text:?}, with a mutant that brings it or a reason");
        }
    }
    let mut all: String = SOURCES.iter().map(|name| source(name)).collect();
    all.push_str(&fs::read_to_string(root().join("tests/src/chaos.rs")).unwrap());
    let gone: Vec<_> = listed().filter(|words| !all.contains(words)).collect();
    assert!(gone.is_empty(), "the judge has no such faults: {gone:?}");
    let short: Vec<_> = WITHOUT_MUTANT.iter().filter(|(_, reason)| reason.len() < 40).collect();
    assert!(short.is_empty(), "{short:?}");
}

/// Returns which of these lines a pattern finds, as `tests/mutants/run.sh` looks for it.
fn found(pattern: &str, lines: &str) -> String {
    let mut grep = Command::new("grep")
        .args(["-E", "-e", pattern])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    grep.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    String::from_utf8(grep.wait_with_output().unwrap().stdout).unwrap()
}

#[test]
fn each_fault_is_what_a_mutant_has_to_be_found_by() {
    let lines: String = FOUND.iter().map(|(_, example)| format!("{example}\n")).collect();
    let mut unproven: Vec<&str> = FOUND.iter().map(|(_, example)| *example).collect();
    for entry in fs::read_dir(root().join("tests/mutants")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|kind| kind != "patch") {
            continue;
        }
        let patch = fs::read_to_string(&path).unwrap();
        let pattern = patch.lines().next().and_then(|line| line.strip_prefix("Fault: "));
        let pattern = pattern.unwrap_or_else(|| panic!("{}: no Fault", path.display()));
        let found = found(pattern, &lines);
        assert!(!found.is_empty(), "{}: no fault of the judge is like {pattern:?}", path.display());
        // One of several faults may be there each time, and the others never.
        let is_one = !pattern.contains('|');
        unproven.retain(|example| !is_one || !found.lines().any(|line| line == *example));
    }
    assert!(unproven.is_empty(), "no mutant is found by these faults: {unproven:#?}");
}

/// The log of a run has lines that are like faults: of what was noticed on the way, whatever the judge thinks of it.
#[test]
fn a_mutant_is_looked_for_among_the_faults_of_the_judge_alone() {
    let script = fs::read_to_string(root().join("tests/mutants/run.sh")).unwrap();
    let searches: Vec<&str> = script.lines().filter(|line| line.contains("grep ")).collect();
    assert!(!searches.is_empty(), "nothing looks for the fault");
    let others: Vec<_> = searches.iter().filter(|line| !line.contains("\"$faults\"")).collect();
    assert!(others.is_empty(), "{others:#?}");
}
