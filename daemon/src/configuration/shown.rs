//! A configuration to read: what each key means, what it is by default, what it is here and who
//! says so.

use std::path::Path;

use serde::Serialize;
use toml::{Table, Value};
use utoipa::ToSchema;

use super::{
    ConfigurationError,
    document::{Document, SECRETS},
    read, variables_over,
};

/// Introduces a setting of the example that is absent by default.
const ABSENT: &str = "#: ";

/// One setting as a person reads it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Setting {
    /// The section it stands in; empty at the top.
    pub section: String,
    /// Path of the key, as `web.listen`.
    pub key: String,
    /// Description for people.
    pub meaning: String,
    /// Default as TOML; none when the setting has no default.
    pub default: Option<String>,
    /// Configured value as TOML; none when the default is used. Secrets are not shown.
    pub value: Option<String>,
    /// Origin of the value: a line of the file or a variable of the environment.
    pub origin: Option<String>,
    /// True for a configured value that is not shown.
    pub is_hidden: bool,
}

/// Every setting of a commented example with what file and environment say, and behind them what
/// they say besides.
///
/// # Errors
/// [`ConfigurationError`] when the file cannot be read or is not TOML.
pub fn shown(
    path: Option<&Path>,
    env_prefix: &str,
    example: &str,
) -> Result<Vec<Setting>, ConfigurationError> {
    shown_of(path, &read(path)?, env_prefix, example, std::env::vars())
}

fn shown_of(
    path: Option<&Path>,
    text: &str,
    env_prefix: &str,
    example: &str,
    variables: impl IntoIterator<Item = (String, String)>,
) -> Result<Vec<Setting>, ConfigurationError> {
    let mut document = Document::parse(path, text, env_prefix)?;
    variables_over(&mut document, env_prefix, variables);
    let mut settings = explained(example);
    let mut said = Vec::new();
    leaves(document.value(), &mut Vec::new(), &mut said);
    for (keys, value) in said {
        let Some((key, sections)) = keys.split_last() else { continue };
        let section = sections.join(".");
        let is_hidden = SECRETS.iter().any(|hidden| key.to_ascii_lowercase().contains(hidden));
        let index = settings.iter().position(|known| known.section == section && known.key == *key);
        let index = index.unwrap_or_else(|| {
            settings.push(Setting { section, key: key.clone(), ..Setting::none() });
            settings.len() - 1
        });
        let setting = &mut settings[index];
        setting.value = (!is_hidden).then(|| value.to_string());
        setting.is_hidden = is_hidden;
        setting.origin = document.origin_name(&keys);
    }
    Ok(settings)
}

impl Setting {
    const fn none() -> Self {
        Self {
            section: String::new(),
            key: String::new(),
            meaning: String::new(),
            default: None,
            value: None,
            origin: None,
            is_hidden: false,
        }
    }
}

/// The settings of an example: the comment right above a key is its meaning.
fn explained(example: &str) -> Vec<Setting> {
    let (mut settings, mut section, mut comment) = (Vec::new(), String::new(), Vec::new());
    for line in example.lines() {
        let (line, is_absent) = match line.strip_prefix(ABSENT) {
            Some(rest) => (rest, true),
            None => (line, false),
        };
        if let Some(words) = line.strip_prefix('#') {
            comment.push(words.trim());
        } else if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            name.clone_into(&mut section);
        } else if let Some((key, default)) = line.split_once(" = ") {
            settings.push(Setting {
                section: section.clone(),
                key: key.to_owned(),
                meaning: comment.join(" "),
                default: (!is_absent).then(|| default.to_owned()),
                ..Setting::none()
            });
            comment.clear();
        } else {
            comment.clear();
        }
    }
    settings
}

/// All values that are no tables, with their keys.
fn leaves(value: &Value, at: &mut Vec<String>, found: &mut Vec<(Vec<String>, Value)>) {
    let Value::Table(table) = value else {
        found.push((at.clone(), value.clone()));
        return;
    };
    let table: &Table = table;
    for (key, inner) in table {
        at.push(key.clone());
        leaves(inner, at, found);
        at.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXAMPLE: &str = "# About the file.\n\n# Where it lies.\nfolder = \"data\"\n\n[web]\n# Where it listens,\n# by default here only.\n\
        listen = \"127.0.0.1:80\"\n\n# Certificate.\n#: [web.tls]\n#: key = \"/etc/key\"\n\n[admin]\n# Who.\n#: password = \"x\"\n";

    #[test]
    fn settings_say_what_they_mean_and_who_set_them() {
        let file = "folder = \"other\"\n[web]\nextra = 3\n";
        let variables =
            [("VERBUND_ADMIN__PASSWORD", "canary"), ("VERBUND_WEB__LISTEN", "0.0.0.0:443")];
        let variables = variables.map(|(name, value)| (name.to_owned(), value.to_owned()));
        let path = Path::new("site.toml");
        let settings = shown_of(Some(path), file, "VERBUND", EXAMPLE, variables).expect("readable");

        let folder = &settings[0];
        assert_eq!((folder.key.as_str(), folder.meaning.as_str()), ("folder", "Where it lies."));
        assert_eq!(
            (folder.default.as_deref(), folder.value.as_deref()),
            (Some("\"data\""), Some("\"other\""))
        );
        assert_eq!(folder.origin.as_deref(), Some("site.toml:1"));

        let listen = &settings[1];
        assert_eq!(listen.meaning, "Where it listens, by default here only.");
        assert_eq!(listen.origin.as_deref(), Some("environment variable VERBUND_WEB__LISTEN"));

        let key = &settings[2];
        assert_eq!(key.section.as_str(), "web.tls");
        assert_eq!(key.default.as_deref(), None);
        assert_eq!(key.value.as_deref(), None);

        let password = &settings[3];
        assert!(password.is_hidden && password.value.is_none());
        assert!(!format!("{settings:?}").contains("canary"), "a secret is not shown");

        let extra = &settings[4];
        assert_eq!(extra.section.as_str(), "web");
        assert_eq!(extra.key.as_str(), "extra");
        assert_eq!(extra.value.as_deref(), Some("3"));
    }
}
