//! Configuration: a TOML file, overridden by environment variables, refused as a whole when
//! anything in it is wrong.
//!
//! `VERBUND_WEB__LISTEN=0.0.0.0:8080` overrides `listen` in the section `[web]`; levels are parted
//! by two underscores. Where the wanted type is a text, the variable is taken literally; else it is
//! read as a TOML value (`true`, `12`, `["a", "b"]`). Unknown keys are refused: a misspelt limit
//! must not silently be the default.
//!
//! Credentials of the service manager with such a name (systemd, `LoadCredentialEncrypted=`) lie over
//! both: so every secret of the file can be sealed to its machine.

mod document;
mod fault;
mod shown;

pub use fault::{ConfigurationError, ConfigurationFault, Origin};
pub use shown::{Setting, shown};

use std::{
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use document::Document;
use serde::de::DeserializeOwned;

/// Names of variables that carry the prefix but address the command line, not the file.
const RESERVED_NAMES: [&str; 2] = ["CONFIG", "LOG"];

/// Most faults listed at once. A file of another kind yields one a line.
const FAULTS_MAX: usize = 50;

/// Reads the file (if there is one), lays the process's environment over it and parses the result.
///
/// # Errors
/// [`ConfigurationError`] with every fault that could be found at once: file, line, key, what is
/// wrong, and the remedy.
pub fn load<T: DeserializeOwned>(
    path: Option<&Path>,
    env_prefix: &str,
) -> Result<T, ConfigurationError> {
    let text = read(path)?;
    let folder = std::env::var_os("CREDENTIALS_DIRECTORY").map(PathBuf::from);
    let credentials = credentials(folder.as_deref(), env_prefix)?;
    let config = parse(path, &text, env_prefix, std::env::vars().chain(credentials))?;
    path.map_or(Ok(()), |path| check_readers(path, &text, env_prefix))?;
    Ok(config)
}

/// Reads the credentials that carry the prefix, without the line feed that ends a file.
fn credentials(
    folder: Option<&Path>,
    env_prefix: &str,
) -> Result<Vec<(String, String)>, ConfigurationError> {
    let Some(folder) = folder else { return Ok(Vec::new()) };
    let prefix = format!("{env_prefix}_");
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| ConfigurationError::ReadFile { path, source }
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(at(folder))? {
        let path = entry.map_err(at(folder))?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        if name.starts_with(&prefix) {
            let text = std::fs::read_to_string(&path).map_err(at(&path))?;
            found.push((name.to_owned(), text.trim_end_matches(['\r', '\n']).to_owned()));
        }
    }
    Ok(found)
}

/// Refuses a file with secrets that every user of the machine may read.
fn check_readers(path: &Path, text: &str, env_prefix: &str) -> Result<(), ConfigurationError> {
    let metadata = std::fs::metadata(path)
        .map_err(|source| ConfigurationError::ReadFile { path: path.to_owned(), source })?;
    let secrets = Document::parse(Some(path), text, env_prefix)?.secrets();
    if metadata.mode() & 0o007 == 0 || secrets.is_empty() {
        return Ok(());
    }
    let fault = |(key, origin)| ConfigurationFault {
        origin,
        key,
        message: "every user of this machine may read this secret".to_owned(),
        remedy: format!(
            "run `chmod 600 {}` as the user that runs this program, or give it as a variable of the environment",
            path.display()
        ),
    };
    Err(ConfigurationError::Invalid { faults: secrets.into_iter().map(fault).collect() })
}

/// The text of a configuration file; nothing where there is none.
fn read(path: Option<&Path>) -> Result<String, ConfigurationError> {
    path.map_or_else(
        || Ok(String::new()),
        |path| {
            std::fs::read_to_string(path)
                .map_err(|source| ConfigurationError::ReadFile { path: path.to_owned(), source })
        },
    )
}

/// Lays those variables over a document that carry the prefix and address it.
fn variables_over(
    document: &mut Document,
    env_prefix: &str,
    variables: impl IntoIterator<Item = (String, String)>,
) {
    let prefix = format!("{env_prefix}_");
    for (name, value) in variables {
        let Some(rest) = name.strip_prefix(&prefix) else { continue };
        if !RESERVED_NAMES.contains(&rest) {
            document.override_with(&name, rest, &value);
        }
    }
}

/// Parses like [`load`], from a text and variables given. `path` only names the text in errors.
///
/// # Errors
/// As [`load`].
pub fn parse<T: DeserializeOwned>(
    path: Option<&Path>,
    text: &str,
    env_prefix: &str,
    variables: impl IntoIterator<Item = (String, String)>,
) -> Result<T, ConfigurationError> {
    let mut document = Document::parse(path, text, env_prefix)?;
    variables_over(&mut document, env_prefix, variables);

    // Each round finds one fault; what is at fault is taken out and the rest is tried again, so
    // that the user sees all faults at once and not one per start.
    let mut faults: Vec<ConfigurationFault> = Vec::new();
    loop {
        let result: Result<T, _> = serde_path_to_error::deserialize(document.value().clone());
        let error = match result {
            Ok(value) if faults.is_empty() => return Ok(value),
            Ok(_) => break,
            Err(error) => error,
        };
        let keys = document::keys(error.path());
        if document.take_literally(&keys) {
            continue;
        }
        let fault = document.fault(&keys, &error.inner().to_string());
        let is_repeated = faults.contains(&fault);
        if !is_repeated {
            faults.push(fault);
        }
        if is_repeated || faults.len() >= FAULTS_MAX || !document.remove(&keys) {
            break;
        }
    }
    // A key that is missing only because it was taken out as faulty is no second fault.
    Err(ConfigurationError::Invalid { faults })
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeMap, net::SocketAddr};

    use serde::Deserialize;

    use super::*;
    use crate::Confidential;

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Example {
        factory_id: String,
        #[serde(default)]
        web: Web,
        #[serde(default)]
        sources: BTreeMap<String, Source>,
        #[serde(default)]
        password: Confidential<String>,
    }

    #[derive(Debug, Default, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields, default)]
    struct Web {
        listen: Option<SocketAddr>,
        sessions_max: u32,
        names: Vec<String>,
    }

    #[derive(Debug, Deserialize, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Source {
        endpoint: String,
    }

    fn check(text: &str, variables: &[(&str, &str)]) -> Result<Example, String> {
        let variables =
            variables.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned()));
        parse(Some(Path::new("example.toml")), text, "VERBUND", variables)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn the_environment_lies_over_the_file() {
        let variables = [
            ("VERBUND_FACTORY_ID", "4711"),
            ("VERBUND_WEB__SESSIONS_MAX", "12"),
            ("VERBUND_WEB__NAMES", "[\"a\", \"b\"]"),
            ("VERBUND_PASSWORD", "true"),
            ("VERBUND_SOURCES__PRESS__ENDPOINT", "opc.tcp://press:4840"),
            ("VERBUND_CONFIG", "example.toml"),
            ("PATH", "/bin"),
        ];
        let example = check("factory_id = \"A\"\n[web]\nlisten = \"127.0.0.1:80\"\n", &variables)
            .expect("valid");
        assert_eq!(example.factory_id, "4711", "a number is a text where a text is wanted");
        assert_eq!(example.web.sessions_max, 12);
        assert_eq!(example.web.names, ["a", "b"]);
        assert_eq!(example.web.listen, "127.0.0.1:80".parse().ok());
        assert_eq!(example.password.expose(), "true");
        assert_eq!(example.sources["press"].endpoint, "opc.tcp://press:4840");
    }

    #[test]
    fn all_faults_are_named_at_once_with_place_and_remedy() {
        let text = "factory_id = \"A\"\n\n[web]\nlistn = \"x\"\nlisten = \"nowhere\"\nsessions_max = -1\n\n[sources.press]\n";
        let error = check(text, &[("VERBUND_WEB__NAMES", "a")]).expect_err("faulty");
        for expected in [
            "example.toml:4: web.listn: ",
            "did you mean `listen`",
            "example.toml:5: web.listen: ",
            "example.toml:6: web.sessions_max: ",
            "environment variable VERBUND_WEB__NAMES: web.names: ",
            "example.toml:8: sources.press: missing field `endpoint`",
        ] {
            assert!(error.contains(expected), "{expected:?} is missing in:\n{error}");
        }
    }

    #[test]
    fn a_missing_key_names_its_variable() {
        let error = check("", &[]).expect_err("factory_id is missing");
        assert!(error.contains("missing field `factory_id`"), "{error}");
        assert!(error.contains("VERBUND_FACTORY_ID"), "{error}");
    }

    #[test]
    fn broken_syntax_names_the_line() {
        let error = check("factory_id = \"A\"\n[web\n", &[]).expect_err("broken");
        assert!(error.contains("example.toml:2"), "{error}");
    }

    #[test]
    fn a_credential_of_the_service_manager_lies_over_file_and_environment() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            std::fs::write(folder.path().join(name), text).expect("written");
        };
        write("VERBUND_PASSWORD", "sealed\n");
        write("VERBUND_SOURCES", "{ press = { endpoint = \"opc.tcp://press:4840\" } }");
        write("verbund-sealing-key", "of another reader");
        let found = credentials(Some(folder.path()), "VERBUND").expect("read");
        let variables = [("VERBUND_PASSWORD".to_owned(), "of the environment".to_owned())];
        let text = "factory_id = \"A\"\npassword = \"of the file\"\n";
        let example: Example =
            parse(None, text, "VERBUND", variables.into_iter().chain(found)).expect("valid");
        assert_eq!(example.password.expose(), "sealed");
        assert_eq!(example.sources["press"].endpoint, "opc.tcp://press:4840");
        assert!(credentials(None, "VERBUND").expect("none").is_empty());
        let missing = folder.path().join("missing");
        assert!(credentials(Some(&missing), "VERBUND").is_err());
    }

    #[test]
    fn values_of_variables_are_not_repeated_in_errors() {
        let error = check("factory_id = \"A\"\n", &[("VERBUND_WEB__SESSIONS_MAX", "canary")])
            .expect_err("no number");
        assert!(!error.contains("canary"), "{error}");
    }

    #[test]
    fn a_file_with_secrets_is_for_its_user_alone() {
        use std::os::unix::fs::PermissionsExt as _;

        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("example.toml");
        let load = |text: &str, mode: u32| {
            std::fs::write(&path, text).expect("written");
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).expect("ours");
            load::<Example>(Some(&path), "VERBUND_NOTHING").map_err(|error| error.to_string())
        };
        let without = "factory_id = 'F'\n";
        assert!(load(without, 0o644).is_ok(), "there is nothing to hide");
        let with = "factory_id = 'F'\npassword = 'canary'\n";
        let refused = load(with, 0o644).expect_err("everybody may read it");
        assert!(refused.contains("example.toml:2: password: "), "{refused}");
        assert!(refused.contains("chmod 600") && !refused.contains("canary"), "{refused}");
        assert!(load(with, 0o640).is_ok(), "the group is who installs it");
    }
}
