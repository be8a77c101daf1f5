//! A password as it is held, and why there is none to be had.

use std::{io, path::PathBuf};

use daemon::{Confidential, sealing::SealingError, secret_file::SecretFileError};

/// Fewest characters of a password: a random secret of 128 bits has more in any usual form.
pub const CHARACTERS_MIN: usize = 16;

/// Failure to find, open or seal a password.
#[derive(Debug, thiserror::Error)]
pub enum BrokerPasswordError {
    #[error(transparent)]
    File(#[from] SecretFileError),
    #[error("line {line} of {} is no account: write user name, a space and the password", path.display())]
    Form { path: PathBuf, line: usize },
    #[error("the password of {user_name} needs at least {CHARACTERS_MIN} characters")]
    Short { user_name: String },
    /// Neither the file nor the configuration has it.
    #[error(
        "broker.external.password_file has no line and broker.external.accounts no account {user_name}"
    )]
    Missing { user_name: String },
    /// The key is missing, or the line was sealed for another account.
    #[error(
        "the password of {user_name} in {} cannot be opened or sealed: bring the sealing key back, or write the line again \
         with the password in plain text",
        path.display()
    )]
    Sealing {
        user_name: String,
        path: PathBuf,
        #[source]
        source: SealingError,
    },
    /// The folder is not the platform's to write.
    #[error(
        "passwords stay in {} as they are, since the file cannot be replaced: put it into a folder of the platform's user, \
         or seal each of its lines with `platform seal password`",
        path.display()
    )]
    Replace {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error("{} was changed while its passwords were sealed; it is sealed later", path.display())]
    Changed { path: PathBuf },
}

/// A password as the file or the configuration has it.
pub(super) enum Held {
    Plain(Confidential<String>),
    Sealed { text: String, path: PathBuf },
}

/// Returns what a password is sealed for, so that the line of one account opens for no other.
pub(super) fn purpose(user_name: &str) -> String {
    format!("broker-account/{user_name}")
}
