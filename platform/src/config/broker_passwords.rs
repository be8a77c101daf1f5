//! Passwords of the accounts at a broker of another make: in a file of its own, read again for each use so that they
//! change beside a running platform, or in the configuration.

use std::path::{Path, PathBuf};

use daemon::{
    Confidential,
    secret_file::{self, SecretFileError},
};

use super::ExternalBrokerConfig;

/// Longest file of passwords.
const FILE_BYTES_MAX: u64 = 1024 * 1024;
/// Fewest characters of a password: a random secret of 128 bits has more in any usual form.
const CHARACTERS_MIN: usize = 16;

/// Failure to find a password.
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
}

impl ExternalBrokerConfig {
    /// Returns the password of an account. A line of the file goes before the configuration.
    ///
    /// # Errors
    /// [`BrokerPasswordError`], which says what to do.
    pub fn password_of(
        &self,
        user_name: &str,
    ) -> Result<Confidential<String>, BrokerPasswordError> {
        let of_file = match &self.password_file {
            Some(path) => of_file(path, user_name)?,
            None => None,
        };
        let own = self.password.clone().filter(|_| user_name == self.user_name);
        let accounts = self.accounts.iter().filter(|account| account.user_name == user_name);
        let configured = own.or_else(|| accounts.map(|account| account.password.clone()).next());
        let password = of_file.or(configured);
        let missing = || BrokerPasswordError::Missing { user_name: user_name.to_owned() };
        password.ok_or_else(missing)
    }

    /// Returns the faults of all passwords that are configured or in the file.
    pub(super) fn password_faults(&self) -> Vec<String> {
        let mut faults: Vec<String> = Vec::new();
        // What is wrong with the file is wrong for every account.
        if let Err(error) = self.password_of(&self.user_name) {
            let cause = std::error::Error::source(&error);
            let cause = cause.map(|cause| format!(": {cause}")).unwrap_or_default();
            faults.push(format!("broker.external.password_file: {error}{cause}"));
        }
        let is_short = |own: &Confidential<String>| own.expose().len() < CHARACTERS_MIN;
        if self.password.as_ref().is_some_and(is_short) {
            let short = BrokerPasswordError::Short { user_name: self.user_name.clone() };
            faults.push(format!("broker.external.password: {short}"));
        }
        for account in &self.accounts {
            if account.password.expose().len() < CHARACTERS_MIN {
                let short = BrokerPasswordError::Short { user_name: account.user_name.clone() };
                faults.push(format!("broker.external.accounts: {short}"));
            }
        }
        faults
    }
}

/// Returns the password of a line `user_name password`; none where there is no line for the account.
fn of_file(
    path: &Path,
    user_name: &str,
) -> Result<Option<Confidential<String>>, BrokerPasswordError> {
    let text = secret_file::read(path, FILE_BYTES_MAX)?;
    let mut found = None;
    for (line, number) in text.lines().map(str::trim).zip(1..) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let form = || BrokerPasswordError::Form { path: path.to_owned(), line: number };
        let (name, password) = line.split_once(char::is_whitespace).ok_or_else(form)?;
        if name == user_name {
            let password = password.trim();
            if password.len() < CHARACTERS_MIN {
                return Err(BrokerPasswordError::Short { user_name: user_name.to_owned() });
            }
            found = Some(password.into());
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    fn external(file: Option<&Path>, more: &str) -> ExternalBrokerConfig {
        let file = file.map(|file| format!("password_file = {file:?}\n")).unwrap_or_default();
        let text = format!(
            "[broker.external]\nurls = [\"amqps://broker.example\"]\nprofile = \"rabbitmq-3\"\nuser_name = \"p\"\n{file}{more}"
        );
        let config: crate::config::PlatformConfig =
            daemon::configuration::parse(None, &text, "VERBUND", []).expect("valid");
        config.broker.external.expect("configured")
    }

    fn write(path: &Path, text: &str, mode: u32) {
        std::fs::write(path, text).expect("written");
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).expect("ours");
    }

    #[test]
    fn passwords_of_the_file_are_read_again_and_go_before_the_configuration() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("passwords");
        let accounts = "[[broker.external.accounts]]\nuser_name = \"factory.F\"\npassword = \"configured-0123456\"\n";
        let external = external(Some(&path), accounts);
        write(&path, "# of the broker\n\np of-the-file-0123456\n", 0o600);
        let of = |name: &str| external.password_of(name).map(|found| found.expose().clone());
        assert_eq!(of("p").expect("in the file"), "of-the-file-0123456");
        assert_eq!(of("factory.F").expect("configured"), "configured-0123456");
        assert!(matches!(of("factory.G"), Err(BrokerPasswordError::Missing { .. })));
        write(&path, "p changed-0123456789\nfactory.F rotated-0123456789\n", 0o600);
        assert_eq!(of("p").expect("changed"), "changed-0123456789");
        assert_eq!(of("factory.F").expect("changed"), "rotated-0123456789");
        assert_eq!(external.password_faults(), Vec::<String>::new());
    }

    #[test]
    fn what_is_wrong_with_the_file_is_said_before_the_start() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("passwords");
        for (text, mode, said) in [
            ("p of-the-file-0123456\n", 0o640, "chmod 600"),
            ("p of-the-file-0123456\n", 0o604, "chmod 600"),
            ("p\n", 0o600, "line 1"),
            ("p short\n", 0o600, "16 characters"),
            ("other of-the-file-0123456\n", 0o600, "no account p"),
        ] {
            write(&path, text, mode);
            let faults = external(Some(&path), "").password_faults();
            assert!(faults.len() == 1 && faults[0].contains(said), "{text}: {faults:?}");
        }
        write(&path, "p of-the-file-0123456\n", 0o600);
        // Root alone gives files away; for all others the owner is a matter of the kernel.
        if std::os::unix::fs::chown(&path, Some(65_534), None).is_ok() {
            let faults = external(Some(&path), "").password_faults();
            assert!(faults.len() == 1 && faults[0].contains("another user"), "{faults:?}");
        }
        let faults = external(Some(&folder.path().join("nowhere")), "").password_faults();
        assert!(faults.len() == 1 && faults[0].contains("cannot read"), "{faults:?}");
        let faults = external(None, "").password_faults();
        assert!(faults.len() == 1 && faults[0].contains("no account p"), "{faults:?}");
    }
}
