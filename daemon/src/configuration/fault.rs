//! Faults of a configuration, each with its origin and its remedy.

use std::{fmt, path::PathBuf};

/// A configuration cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigurationError {
    /// The file could not be read.
    #[error(
        "cannot read the configuration file {}; check the path and its permissions, or write one with \
         `config example`",
        path.display()
    )]
    ReadFile { path: PathBuf, source: std::io::Error },
    /// The file was read, but something in it or in the environment is wrong.
    #[error("{}", list(faults))]
    Invalid {
        /// Everything that is wrong, in the order of discovery.
        faults: Vec<ConfigurationFault>,
    },
}

fn list(faults: &[ConfigurationFault]) -> String {
    let lines: Vec<String> = faults.iter().map(|fault| format!("\n  {fault}")).collect();
    let noun = if faults.len() == 1 { "1 fault" } else { &format!("{} faults", faults.len()) };
    format!("the configuration has {noun}:{}", lines.concat())
}

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigurationFault {
    pub origin: Origin,
    /// The key, as `web.listen`; empty where the whole document is meant.
    pub key: String,
    pub message: String,
    /// Action that resolves the fault.
    pub remedy: String,
}

/// Origin of a setting.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A line of the file, counted from 1.
    File {
        /// The file's name as given.
        path: String,
        line: usize,
    },
    Variable {
        name: String,
    },
    /// Nowhere: the setting is missing.
    Nowhere,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, line } => write!(f, "{path}:{line}"),
            Self::Variable { name } => write!(f, "environment variable {name}"),
            Self::Nowhere => f.write_str("configuration"),
        }
    }
}

impl fmt::Display for ConfigurationFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.origin)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        write!(f, "{}; {}", self.message, self.remedy)
    }
}
