//! The document behind a configuration: values merged from file and environment, and where each
//! came from.

use std::{collections::BTreeMap, path::Path};

use serde_path_to_error::Segment;
use toml::{Table, Value, de::DeTable};

use super::fault::{ConfigurationError, ConfigurationFault, Origin};

/// Names of keys with secrets, whatever section they stand in.
pub(super) const SECRETS: [&str; 3] = ["password", "secret", "token"];

/// File and environment laid over each other, remembering the origin of each value.
pub(super) struct Document {
    value: Value,
    path: String,
    env_prefix: String,
    /// Key path to the line where the file says it.
    lines: BTreeMap<Vec<String>, usize>,
    /// Key path to the variable that says it.
    variables: BTreeMap<Vec<String>, Variable>,
}

struct Variable {
    name: String,
    literal: String,
    is_literal: bool,
}

impl Document {
    pub(super) fn parse(
        path: Option<&Path>,
        text: &str,
        env_prefix: &str,
    ) -> Result<Self, ConfigurationError> {
        let path =
            path.map_or_else(|| "configuration".to_owned(), |path| path.display().to_string());
        let syntax_fault = |error: &toml::de::Error| ConfigurationError::Invalid {
            faults: vec![ConfigurationFault {
                origin: Origin::File {
                    path: path.clone(),
                    line: line_of(text, error.span().map_or(0, |span| span.start)),
                },
                key: String::new(),
                message: format!("this is not TOML: {}", error.message().replace('\n', ", ")),
                remedy: "correct the syntax (https://toml.io)".to_owned(),
            }],
        };
        let spanned = DeTable::parse(text).map_err(|error| syntax_fault(&error))?;
        let mut lines = BTreeMap::new();
        collect_lines(text, spanned.get_ref(), &mut Vec::new(), &mut lines);
        let table: Table = toml::from_str(text).map_err(|error| syntax_fault(&error))?;
        Ok(Self {
            value: Value::Table(table),
            path,
            env_prefix: env_prefix.to_owned(),
            lines,
            variables: BTreeMap::new(),
        })
    }

    /// Returns the keys of the file with secrets, each with its place.
    pub(super) fn secrets(&self) -> Vec<(String, Origin)> {
        let is_secret =
            |keys: &[String]| keys.last().is_some_and(|key| SECRETS.contains(&key.as_str()));
        let secrets = self.lines.iter().filter(|(keys, _)| is_secret(keys));
        let place = |line: usize| Origin::File { path: self.path.clone(), line };
        secrets.map(|(keys, line)| (keys.join("."), place(*line))).collect()
    }

    pub(super) const fn value(&self) -> &Value {
        &self.value
    }

    /// Lays a variable over the document. `rest` is its name without the prefix.
    pub(super) fn override_with(&mut self, name: &str, rest: &str, literal: &str) {
        let keys: Vec<String> = rest.split("__").map(str::to_ascii_lowercase).collect();
        let parsed = toml::from_str::<Table>(&format!("value = {literal}"))
            .ok()
            .filter(|table| table.len() == 1)
            .and_then(|mut table| table.remove("value"))
            .filter(|value| !value.is_str());
        let is_literal = parsed.is_none();
        self.put(&keys, parsed.unwrap_or_else(|| Value::String(literal.to_owned())));
        let variable = Variable { name: name.to_owned(), literal: literal.to_owned(), is_literal };
        self.variables.insert(keys, variable);
    }

    /// Tries a variable's value as a text where reading it as a TOML value did not fit. Says
    /// whether that is new.
    pub(super) fn take_literally(&mut self, keys: &[String]) -> bool {
        let Some(variable) = self.variables.get_mut(keys).filter(|variable| !variable.is_literal)
        else {
            return false;
        };
        variable.is_literal = true;
        let literal = Value::String(variable.literal.clone());
        self.put(keys, literal);
        true
    }

    /// Takes a faulty setting out. Says whether there was one.
    pub(super) fn remove(&mut self, keys: &[String]) -> bool {
        let Some((last, parents)) = keys.split_last() else { return false };
        let mut value = &mut self.value;
        for key in parents {
            let next = match value {
                Value::Table(table) => table.get_mut(key),
                Value::Array(array) => {
                    key.parse().ok().and_then(|index: usize| array.get_mut(index))
                }
                _ => None,
            };
            let Some(next) = next else { return false };
            value = next;
        }
        match value {
            Value::Table(table) => table.remove(last).is_some(),
            _ => false,
        }
    }

    pub(super) fn fault(&self, keys: &[String], message: &str) -> ConfigurationFault {
        let (message, remedy) = self.explain(keys, message);
        ConfigurationFault { origin: self.origin(keys), key: keys.join("."), message, remedy }
    }

    /// Names the origin of a setting, for people.
    pub(super) fn origin_name(&self, keys: &[String]) -> Option<String> {
        match self.origin(keys) {
            Origin::File { path, line } => Some(format!("{path}:{line}")),
            Origin::Variable { name } => Some(format!("environment variable {name}")),
            Origin::Nowhere => None,
        }
    }

    /// Returns the origin of the setting, or of the nearest table around it.
    fn origin(&self, keys: &[String]) -> Origin {
        for length in (1..=keys.len()).rev() {
            if let Some(variable) = self.variables.get(&keys[..length]) {
                return Origin::Variable { name: variable.name.clone() };
            }
            if let Some(line) = self.lines.get(&keys[..length]) {
                return Origin::File { path: self.path.clone(), line: *line };
            }
        }
        Origin::Nowhere
    }

    /// Returns message and remedy for an error of the deserialiser.
    fn explain(&self, keys: &[String], message: &str) -> (String, String) {
        let mut message = message.trim().replace('\n', ", ");
        if let Some(variable) = self.variables.get(keys) {
            // A variable may hold a secret, so an error never repeats it.
            message = message.replace(&variable.literal, "...");
        }
        let quoted = |text: &str| text.split('`').nth(1).map(str::to_owned);
        if message.starts_with("unknown field") {
            let found = quoted(&message).unwrap_or_default();
            let known: Vec<String> =
                message.split('`').skip(3).step_by(2).map(str::to_owned).collect();
            let remedy = match nearest(&found, &known) {
                Some(name) => format!("did you mean `{name}`? Otherwise remove it"),
                None => "remove it".to_owned(),
            };
            return (message, remedy);
        }
        if message.starts_with("missing field") {
            let field = quoted(&message).unwrap_or_default();
            let mut path: Vec<String> = keys.to_vec();
            path.push(field.clone());
            let variable = path.join("__").to_ascii_uppercase();
            let prefix = &self.env_prefix;
            return (
                message,
                format!(
                    "set `{}` in the file or {prefix}_{variable} in the environment",
                    path.join(".")
                ),
            );
        }
        (message, "correct the value".to_owned())
    }

    fn put(&mut self, keys: &[String], value: Value) {
        let Some((last, parents)) = keys.split_last() else { return };
        let mut target = &mut self.value;
        for key in parents {
            if !target.is_table() {
                *target = Value::Table(Table::new());
            }
            target = match target {
                Value::Table(table) => {
                    table.entry(key.clone()).or_insert_with(|| Value::Table(Table::new()))
                }
                _ => return,
            };
        }
        if !target.is_table() {
            *target = Value::Table(Table::new());
        }
        if let Value::Table(table) = target {
            table.insert(last.clone(), value);
        }
    }
}

/// The keys of a deserialiser's path; list positions as digits.
pub(super) fn keys(path: &serde_path_to_error::Path) -> Vec<String> {
    path.iter()
        .filter_map(|segment| match segment {
            Segment::Map { key } => Some(key.clone()),
            Segment::Seq { index } => Some(index.to_string()),
            Segment::Enum { .. } | Segment::Unknown => None,
        })
        .collect()
}

fn collect_lines(
    text: &str,
    table: &DeTable<'_>,
    at: &mut Vec<String>,
    lines: &mut BTreeMap<Vec<String>, usize>,
) {
    for (key, value) in table {
        at.push(key.get_ref().to_string());
        lines.insert(at.clone(), line_of(text, key.span().start));
        if let Some(inner) = value.get_ref().as_table() {
            collect_lines(text, inner, at, lines);
        }
        if let Some(array) = value.get_ref().as_array() {
            for (index, element) in array.iter().enumerate() {
                at.push(index.to_string());
                lines.insert(at.clone(), line_of(text, element.span().start));
                if let Some(inner) = element.get_ref().as_table() {
                    collect_lines(text, inner, at, lines);
                }
                at.pop();
            }
        }
        at.pop();
    }
}

fn line_of(text: &str, offset: usize) -> usize {
    text.bytes().take(offset).filter(|byte| *byte == b'\n').count() + 1
}

/// The known name that differs least from the one found, if it is near enough to be a slip.
fn nearest<'a>(found: &str, known: &'a [String]) -> Option<&'a String> {
    known
        .iter()
        .map(|name| (edit_distance(found, name), name))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, name)| *distance <= name.len().div_ceil(3))
        .map(|(_, name)| name)
}

fn edit_distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (i, a) in left.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b) in right.iter().enumerate() {
            let substituted = diagonal + usize::from(a != *b);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[right.len()]
}
