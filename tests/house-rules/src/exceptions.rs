//! Exceptions from the vocabulary that no source needs any more.

use std::{fs, io, path::Path};

use crate::{
    lexer,
    texts::{
        NAMES_OF_MEMBERS, RUN_MIGRATIONS, TextKind, banned_by_line, is_generated, kind_of, sources,
    },
    words::{API_PATHS, FIXED_NAMES, whole_words},
};

/// Returns a line for each exception from the vocabulary without which the workspace below this
/// folder would have no finding more.
///
/// # Errors
/// When a folder or a file cannot be read.
pub fn unneeded_exceptions(root: &Path) -> io::Result<Vec<String>> {
    let mut needs = Needs::default();
    for path in sources(root)? {
        let is_rust = path.ends_with(".rs") && !path.starts_with("tests/house-rules/");
        let kind = kind_of(&path);
        if is_rust || kind.is_some() {
            let text = fs::read_to_string(root.join(&path))?;
            if is_rust {
                needs.read_rust(&path, &text);
            }
            if let Some(kind) = kind.filter(|_| !is_generated(&text)) {
                needs.read_text(&path, kind, &text);
            }
        }
    }
    Ok(needs.missing())
}

/// Exceptions that a source needs, true at their places in the tables.
#[derive(Default)]
struct Needs {
    fixed_names: [bool; FIXED_NAMES.len()],
    api_paths: [bool; API_PATHS.len()],
    members: [bool; NAMES_OF_MEMBERS.len()],
    migrations: [bool; RUN_MIGRATIONS.len()],
}

impl Needs {
    fn read_rust(&mut self, path: &str, text: &str) {
        for line in lexer::lines(text) {
            for (fixed, is_needed) in FIXED_NAMES.iter().zip(&mut self.fixed_names) {
                *is_needed |= path.contains(fixed.within)
                    && whole_words(&line.text).any(|word| word == fixed.name);
            }
            for (segment, is_needed) in API_PATHS.iter().zip(&mut self.api_paths) {
                *is_needed |= line.text.contains(segment);
            }
        }
    }

    fn read_text(&mut self, path: &str, kind: TextKind, text: &str) {
        let found = banned_by_line(kind, text);
        for (migration, is_needed) in RUN_MIGRATIONS.iter().zip(&mut self.migrations) {
            *is_needed |= *migration == path && !found.is_empty();
        }
        for (member, is_needed) in NAMES_OF_MEMBERS.iter().zip(&mut self.members) {
            *is_needed |=
                kind == TextKind::Web && found.iter().any(|(_, banned)| banned.word == *member);
        }
        for (segment, is_needed) in API_PATHS.iter().zip(&mut self.api_paths) {
            *is_needed |= text.contains(segment);
        }
    }

    fn missing(&self) -> Vec<String> {
        let fixed = FIXED_NAMES.iter().map(|fixed| format!("{} in {}", fixed.name, fixed.within));
        let others = [
            (&API_PATHS[..], &self.api_paths[..]),
            (&NAMES_OF_MEMBERS, &self.members),
            (&RUN_MIGRATIONS, &self.migrations),
        ];
        let others = others.into_iter().flat_map(|(names, needs)| {
            names.iter().map(|name| (*name).to_owned()).zip(needs.iter().copied())
        });
        let all = fixed.zip(self.fixed_names).chain(others);
        all.filter(|(_, is_needed)| !is_needed).map(|(name, _)| name).collect()
    }
}
