//! Vocabulary of sources that are no Rust - pages, scripts, SQL, manifests and documentation -, and
//! the length of programs among them.
//!
//! A line is read whole, with its texts: readers see those of pages, and few scripts have others.
//! Words that are no names are looked for in the code of pages alone.

use std::{fs, io, path::Path};

use crate::{
    finding::Finding,
    package::{GENERATED, LEFT_OUT},
    size::{FILE_LINES_MAX, too_long},
    web_code,
    words::{API_PATHS, BannedWord, banned_in, names_in, without_names_of_rules},
};

/// Kind of a source, by what is written in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TextKind {
    /// TypeScript, JavaScript and Svelte: names, comments and texts of pages.
    Web,
    /// Documentation, manifests, SQL, style sheets and other scripts.
    Other,
}

/// Banned words that an API has as names of members. A page cannot choose another word.
pub(crate) const NAMES_OF_MEMBERS: [&str; 3] = ["grounds", "resting", "standing"];
/// Migrations that stores have run, which refuse one whose checksum has changed since; and one with a table of those.
pub(crate) const RUN_MIGRATIONS: [&str; 4] = [
    "factory-connector/migrations/0020_policies.sql",
    "platform/migrations/sqlite/0001_house.sql",
    "platform/migrations/sqlite/0003_leases.sql",
    "platform/migrations/sqlite/0043_shares_of_the_record.sql",
];
/// Folder of what a program builds for the pages.
const BUILT_PAGES: &str = "dist";
/// History, written in the words of its day.
const HISTORY: &str = "CHANGELOG.md";
/// Beginning of the first line of a file that a script writes.
const GENERATED_FROM: &str = "// Generated from";

/// Reports the banned words of all sources below a folder that are no Rust.
///
/// Left out are hidden folders, build output, installed and foreign packages, files that a program
/// writes, and the history of releases. Lock files and snapshots are of no kind that is read.
///
/// # Errors
/// When a folder or a file cannot be read.
pub fn check_texts(root: &Path) -> io::Result<Vec<Finding>> {
    let mut findings = Vec::new();
    for path in sources(root)?.iter().filter(|path| kind_of(path).is_some()) {
        findings.extend(check_text(path, &fs::read_to_string(root.join(path))?));
    }
    findings.sort();
    Ok(findings)
}

/// Returns the paths of all files below a folder that are neither hidden, foreign nor built.
pub(crate) fn sources(root: &Path) -> io::Result<Vec<String>> {
    let mut paths = Vec::new();
    walk(root, "", &mut paths)?;
    Ok(paths)
}

fn walk(folder: &Path, inner: &str, paths: &mut Vec<String>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') || LEFT_OUT.contains(&name.as_str()) || name == BUILT_PAGES {
            continue;
        }
        let inner = if inner.is_empty() { name } else { format!("{inner}/{name}") };
        if entry.file_type()?.is_dir() {
            walk(&entry.path(), &inner, paths)?;
        } else {
            paths.push(inner);
        }
    }
    Ok(())
}

/// Reports each banned word once a line.
pub(crate) fn check_text(path: &str, text: &str) -> Vec<Finding> {
    let Some(kind) = kind_of(path) else { return Vec::new() };
    let is_run = RUN_MIGRATIONS.iter().any(|migration| migration.ends_with(path));
    if is_run || is_generated(text) {
        return Vec::new();
    }
    let mut findings = Vec::new();
    let lines = text.lines().count();
    if is_program(path) && lines > FILE_LINES_MAX {
        findings.push(too_long(path, lines));
    }
    let excused: &[&str] = match kind {
        TextKind::Web => &NAMES_OF_MEMBERS,
        TextKind::Other => &[],
    };
    let words = banned_by_line(kind, text).into_iter();
    let words = words.filter(|(_, banned)| !excused.contains(&banned.word));
    findings.extend(words.map(|(line, banned)| banned.finding(path, line)));
    findings
}

/// Returns true for what a script writes.
pub(crate) fn is_generated(text: &str) -> bool {
    text.starts_with(GENERATED_FROM) || text.lines().take(5).any(|line| line.contains(GENERATED))
}

/// Returns the banned words of a text, each with the number of its line, from 1.
pub(crate) fn banned_by_line(kind: TextKind, text: &str) -> Vec<(usize, &'static BannedWord)> {
    let code = if kind == TextKind::Web { web_code::lines(text) } else { Vec::new() };
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let mut line = without_names_of_rules(line);
        for path in API_PATHS {
            line = line.replace(path, "");
        }
        let names = code.get(at).map(|code| names_in(code)).unwrap_or_default();
        found.extend(banned_in(&line).into_iter().chain(names).map(|banned| (at + 1, banned)));
    }
    found
}

/// Returns true for programs, whose length is bounded; documentation and style sheets are read in parts.
fn is_program(path: &str) -> bool {
    let extension = path.rsplit_once('.').map(|(_, extension)| extension);
    matches!(extension, Some("svelte" | "ts" | "js" | "py" | "sh"))
}

/// Returns the kind of a file to read, `None` for all others.
pub(crate) fn kind_of(path: &str) -> Option<TextKind> {
    let name = path.rsplit('/').next().unwrap_or(path);
    if name == HISTORY {
        return None;
    }
    if name == "Makefile" {
        return Some(TextKind::Other);
    }
    match name.rsplit_once('.')?.1 {
        "svelte" | "ts" | "js" => Some(TextKind::Web),
        "md" | "toml" | "sh" | "sql" | "py" | "css" => Some(TextKind::Other),
        _ => None,
    }
}
