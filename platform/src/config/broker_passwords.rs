//! Passwords of the accounts at a broker of another make: in a file of its own, sealed there and read again for each
//! use so that they change beside a running platform, or in the configuration.

mod held;
mod password_file;

use daemon::{
    Confidential,
    sealing::{Sealer, SealingError},
};

use super::ExternalBrokerConfig;
pub use held::{BrokerPasswordError, CHARACTERS_MIN as BROKER_PASSWORD_CHARACTERS_MIN};
use held::{CHARACTERS_MIN, Held, purpose};
use password_file::{PasswordFile, PasswordFileState};

/// Returns the line of the file for an account, its password sealed.
///
/// # Errors
/// [`SealingError`] where the key cannot be used.
pub fn sealed_line(
    user_name: &str,
    password: &Confidential<String>,
    sealer: &Sealer,
) -> Result<String, SealingError> {
    let sealed = sealer.seal(&purpose(user_name), password.expose())?;
    Ok(format!("{user_name} {sealed}"))
}

impl ExternalBrokerConfig {
    /// Returns the password of an account. A line of the file goes before the configuration.
    ///
    /// # Errors
    /// [`BrokerPasswordError`], which says what to do.
    pub fn password_of(
        &self,
        user_name: &str,
        sealer: &Sealer,
    ) -> Result<Confidential<String>, BrokerPasswordError> {
        let (text, path) = match self.held(user_name)? {
            Held::Plain(password) => return Ok(password),
            Held::Sealed { text, path } => (text, path),
        };
        let user_name = user_name.to_owned();
        let opened = sealer.open(&purpose(&user_name), &text);
        let password = opened.map_err(|source| BrokerPasswordError::Sealing {
            user_name: user_name.clone(),
            path,
            source,
        })?;
        if password.expose().len() < CHARACTERS_MIN {
            return Err(BrokerPasswordError::Short { user_name });
        }
        Ok(password)
    }

    fn held(&self, user_name: &str) -> Result<Held, BrokerPasswordError> {
        let of_file = match &self.password_file {
            Some(path) => PasswordFile::read(path)?.held(user_name)?,
            None => None,
        };
        let own = self.password.clone().filter(|_| user_name == self.user_name);
        let accounts = self.accounts.iter().filter(|account| account.user_name == user_name);
        let configured = own.or_else(|| accounts.map(|account| account.password.clone()).next());
        let missing = || BrokerPasswordError::Missing { user_name: user_name.to_owned() };
        of_file.or(configured.map(Held::Plain)).ok_or_else(missing)
    }

    /// Seals what the file holds in plain text, and again what a former key has sealed. Returns the number of passwords
    /// that were sealed.
    ///
    /// # Errors
    /// [`BrokerPasswordError`]; the file is then as it was, or all is sealed but a line that no key opens.
    pub fn seal_passwords(&self, sealer: &Sealer) -> Result<usize, BrokerPasswordError> {
        let file = self.password_file.as_ref().map(|path| PasswordFile::read(path)).transpose()?;
        file.map_or(Ok(0), |file| file.seal(sealer))
    }

    /// Returns the faults of all passwords that are configured or in the file.
    pub(super) fn password_faults(&self) -> Vec<String> {
        let mut faults: Vec<String> = Vec::new();
        // What is wrong with the file is wrong for every account. Not opened: a command has no credential of the service
        // manager, which may hold the key.
        if let Err(error) = self.held(&self.user_name) {
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

/// Sealing of the file beside a running platform, whenever an administrator has changed it.
#[derive(Debug)]
pub struct PasswordSealing {
    external: ExternalBrokerConfig,
    sealer: Sealer,
    /// State of the file at the last look.
    seen: Option<PasswordFileState>,
    /// State in which there is nothing to do any more.
    settled: Option<PasswordFileState>,
    /// State that could not be sealed, which was said.
    said: Option<PasswordFileState>,
}

impl PasswordSealing {
    /// Makes the sealing of the file that a configuration names.
    #[must_use]
    pub const fn new(external: ExternalBrokerConfig, sealer: Sealer) -> Self {
        Self { external, sealer, seen: None, settled: None, said: None }
    }

    /// Seals the file once two looks have found it the same: an editor may still be writing it. Returns the number of
    /// passwords that were sealed.
    ///
    /// # Errors
    /// [`BrokerPasswordError`], once for each state of the file.
    pub fn look(&mut self) -> Result<usize, BrokerPasswordError> {
        let Some(path) = &self.external.password_file else { return Ok(0) };
        // A file that cannot be read is said where the password is read from it.
        let Ok(file) = PasswordFile::read(path) else { return Ok(0) };
        let state = Some(file.state());
        if self.seen != state {
            self.seen = state;
            return Ok(0);
        }
        if self.settled == state {
            return Ok(0);
        }
        match file.seal(&self.sealer) {
            Ok(count) => {
                self.settled = state;
                Ok(count)
            }
            // The reason may go without a change of the file: it is tried again, and said once.
            Err(_) if self.said == state => Ok(0),
            Err(error) => {
                self.said = state;
                Err(error)
            }
        }
    }
}

#[cfg(test)]
mod tests;
