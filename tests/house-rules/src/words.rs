//! Vocabulary: words of our own where the field has one, in identifiers, module names, comments and
//! string literals of Rust: log messages, error texts and SQL; and words that are no names, in
//! identifiers alone. [`crate::texts`] looks for the former in all other sources.

use std::collections::BTreeSet;

use crate::{
    finding::{Finding, Rule},
    lexer,
    package::Package,
};

/// A word that is never right.
#[derive(Debug, Clone, Copy)]
pub struct BannedWord {
    /// Parts of an identifier in lower case, joined by `_`; in comments joined by spaces or `_`.
    pub word: &'static str,
    /// Remedy, printed with each finding.
    pub instead: &'static str,
}

impl BannedWord {
    pub(crate) fn finding(&self, file: &str, line: usize) -> Finding {
        Finding {
            file: file.to_owned(),
            line,
            rule: Rule::BannedWord,
            text: format!("\"{}\": say {}", self.word.replace('_', " "), self.instead),
        }
    }
}

const fn banned(word: &'static str, instead: &'static str) -> BannedWord {
    BannedWord { word, instead }
}

/// The words, each with the one to use.
pub const BANNED_WORDS: &[BannedWord] = &[
    banned("aftermath", "effects"),
    banned("anew", "again, restart"),
    banned("books", "state"),
    banned("desk", "coordinator"),
    banned("ephemerals", "keep-alive queue"),
    banned("farewell", "shutdown"),
    banned("goodbye", "close"),
    banned("grounds", "basis"),
    banned("hinder", "report an obstacle"),
    banned("house", "workspace"),
    banned("housekeeping", "maintenance"),
    banned("keep_house", "run maintenance"),
    banned("keeper", "client"),
    banned("knock", "rejected client"),
    banned("knocks", "rejected clients"),
    banned("misfit", "mismatch"),
    banned("misfits", "mismatches"),
    banned("news", "released, changes"),
    banned("obey", "handle a command"),
    banned("outbox", "spool reader, queue"),
    banned("remark", "comment"),
    banned("remarks", "comments"),
    banned("ripe", "due, releasable"),
    banned("rooms", "modules, outputs"),
    banned("shelf", "mapping versions"),
    banned("short_way", "fast path"),
    banned("somebody", "a person, the caller"),
    banned("told_and_kept", "record"),
    banned("trial", "shadow mapping, dry run"),
    banned("trials", "shadow mappings, dry runs"),
    banned("twin_side", "twin adapter"),
    banned("verdict", "decision, finding"),
    banned("verdicts", "decisions, findings"),
    banned("whoever", "the caller, any"),
];
/// Words that are right in a sentence, and no names: a value has a noun of the field.
pub const BANNED_NAMES: &[BannedWord] = &[
    banned("knocked", "rejected"),
    banned("resting", "circuit open, backoff"),
    banned("tell", "send, notify, publish"),
    banned("told", "what it is: sent, shown, answered, reported"),
];
/// Identifiers that are no name alone, though fit beside a noun: a standing rule.
const BANNED_ALONE: &[BannedWord] = &[banned("standing", "status")];
/// A name that others rely on: stored files, or clients of an API, would not find a new one.
pub(crate) struct FixedName {
    pub(crate) name: &'static str,
    /// Part of the paths of the files whose string literals may have it.
    pub(crate) within: &'static str,
}

const fn fixed(name: &'static str, within: &'static str) -> FixedName {
    FixedName { name, within }
}

/// Names in string literals that stay: columns, tables and migrations of stores in use, folders on
/// disk, members and paths of an API.
pub(crate) const FIXED_NAMES: [FixedName; 10] = [
    fixed("grounds", "factory-connector/src/api/"),
    fixed("grounds", "factory-connector/src/store/"),
    fixed("grounds", "ledger/src/entry.rs"),
    fixed("isDescribedAnew", "asi-model/src/difference.rs"),
    fixed("knocks", "twin/src/security/rejected_clients.rs"),
    fixed("outbox", "platform/src/store/"),
    fixed("outbox", "platform/tests/it/left_behind.rs"),
    fixed("outbox_id", "platform/src/store/"),
    fixed("house", "platform/src/store/connection.rs"),
    fixed("0001_house", "platform/"),
];
/// Packages that speak of the rules themselves, and so name the words.
const ABOUT_WORDS: [&str; 1] = ["house-rules"];
/// Segments of API paths with a banned word.
pub(crate) const API_PATHS: [&str; 2] = ["/trial", "/news"];
/// Names of this checker and of the test that runs it.
const NAMES_OF_RULES: [&str; 5] =
    ["house_rules", "house-rules", "mod house;", "it/house", "house.rs"];

/// Reports each banned word once a line.
pub(crate) fn check(package: &Package) -> Vec<Finding> {
    if ABOUT_WORDS.contains(&package.name.as_str()) {
        return Vec::new();
    }
    let mut findings = Vec::new();
    for file in &package.files {
        let mut report = |line: usize, words: Vec<&BannedWord>| {
            findings.extend(words.into_iter().map(|word| word.finding(&file.path, line)));
        };
        let stem = file.inner.rsplit('/').next().unwrap_or_default().trim_end_matches(".rs");
        if !(package.name == "verbund-tests" && stem == "house") {
            report(1, banned_in(stem));
        }
        for (at, line) in lexer::lines(&file.text).into_iter().enumerate() {
            for text in [&line.code, &line.comment] {
                report(at + 1, banned_in(&without_names_of_rules(text)));
            }
            report(at + 1, banned_in(&without_fixed_names(&line.text, &file.path)));
            report(at + 1, names_in(&line.code));
        }
    }
    // A word may stand in the code and in a text of the same line.
    findings.sort();
    findings.dedup();
    findings
}

/// Removes the names that a literal of the file may have, whole words only.
fn without_fixed_names(text: &str, path: &str) -> String {
    let text = API_PATHS
        .iter()
        .fold(without_names_of_rules(text), |text, segment| text.replace(segment, ""));
    let is_kept = |word: &str| {
        let mut fixed = FIXED_NAMES.iter().filter(|fixed| path.contains(fixed.within));
        !fixed.any(|fixed| fixed.name == word)
    };
    whole_words(&text).filter(|word| is_kept(word)).collect::<Vec<_>>().join(" ")
}

/// Returns words and identifiers, each undivided.
pub(crate) fn whole_words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// Removes the names of this checker, which contain a banned word.
pub(crate) fn without_names_of_rules(text: &str) -> String {
    let mut text = text.to_owned();
    for name in NAMES_OF_RULES {
        text = text.replace(name, "");
    }
    text
}

/// Returns the banned words of a line, each once.
pub(crate) fn banned_in(text: &str) -> Vec<&'static BannedWord> {
    words_in(BANNED_WORDS, text)
}

/// Returns the words of a line of code that are no names, each once.
pub(crate) fn names_in(code: &str) -> Vec<&'static BannedWord> {
    let mut found = words_in(BANNED_NAMES, code);
    let is_alone = |banned: &&BannedWord| whole_words(code).any(|name| name == banned.word);
    found.extend(BANNED_ALONE.iter().filter(is_alone));
    found
}

fn words_in(words: &'static [BannedWord], text: &str) -> Vec<&'static BannedWord> {
    let parts = parts(text);
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for word in words {
        let banned: Vec<&str> = word.word.split('_').collect();
        if parts.windows(banned.len()).any(|window| window == banned) && seen.insert(word.word) {
            found.push(word);
        }
    }
    found
}

/// Splits words and identifiers into their parts in lower case: `DeskHandle`, `desk_handle` and
/// "desk handle" alike.
pub(crate) fn parts(text: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut was_lower = false;
    for character in text.chars() {
        let is_start = character.is_uppercase() && was_lower;
        if !character.is_alphanumeric() || is_start {
            parts.push(String::new());
        }
        if character.is_alphanumeric() {
            let part = parts.last_mut().expect("there is a first part");
            part.extend(character.to_lowercase());
        }
        was_lower = character.is_lowercase() || character.is_numeric();
    }
    parts.retain(|part| !part.is_empty());
    parts
}
