//! File of passwords, a line `user_name password` for each account, which the platform seals.

use std::{
    fs::{File, Metadata, OpenOptions},
    io::{self, Write as _},
    os::unix::fs::{MetadataExt as _, OpenOptionsExt as _},
    path::{Path, PathBuf},
};

use daemon::{
    Confidential,
    sealing::{Sealer, is_sealed},
    secret_file::{self, SecretFile, SecretFileError},
};
use zeroize::Zeroizing;

use super::held::{BrokerPasswordError, CHARACTERS_MIN, Held, purpose};

/// Longest file of passwords.
const FILE_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// File of passwords as it was read.
pub(super) struct PasswordFile {
    /// Its real place: a link to it stays one when it is replaced.
    path: PathBuf,
    text: Zeroizing<String>,
    state: PasswordFileState,
    is_credential: bool,
}

/// State of a file, which differs once it was changed or replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PasswordFileState {
    file: (u64, u64),
    owner: (u32, u32),
    length: u64,
    modified: (i64, i64),
}

impl PasswordFileState {
    fn of(metadata: &Metadata) -> Self {
        Self {
            file: (metadata.dev(), metadata.ino()),
            owner: (metadata.uid(), metadata.gid()),
            length: metadata.len(),
            modified: (metadata.mtime(), metadata.mtime_nsec()),
        }
    }
}

impl PasswordFile {
    /// Reads a file that nobody else may read or change.
    pub(super) fn read(path: &Path) -> Result<Self, BrokerPasswordError> {
        let SecretFile { text, metadata } = secret_file::read(path, FILE_BYTES_MAX)?;
        let access = |source| SecretFileError::Access { path: path.to_owned(), source };
        let state = PasswordFileState::of(&metadata);
        let is_credential = secret_file::is_credential(path);
        Ok(Self { path: path.canonicalize().map_err(access)?, text, state, is_credential })
    }

    pub(super) const fn state(&self) -> PasswordFileState {
        self.state
    }

    /// Returns the password of an account, as the last line for it has it; none where there is no line.
    pub(super) fn held(&self, user_name: &str) -> Result<Option<Held>, BrokerPasswordError> {
        let mut found = None;
        for (line, number) in self.text.lines().zip(1..) {
            match self.account(line, number)? {
                Some((name, password)) if name == user_name => {
                    found = Some(self.held_as(user_name, password)?);
                }
                _ => {}
            }
        }
        Ok(found)
    }

    fn held_as(&self, user_name: &str, password: &str) -> Result<Held, BrokerPasswordError> {
        if is_sealed(password) {
            return Ok(Held::Sealed { text: password.to_owned(), path: self.path.clone() });
        }
        if password.len() < CHARACTERS_MIN {
            return Err(BrokerPasswordError::Short { user_name: user_name.to_owned() });
        }
        Ok(Held::Plain(password.into()))
    }

    /// Returns user name and password of a line; none of an empty one or a comment.
    fn account<'a>(
        &self,
        line: &'a str,
        number: usize,
    ) -> Result<Option<(&'a str, &'a str)>, BrokerPasswordError> {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            return Ok(None);
        }
        let form = || BrokerPasswordError::Form { path: self.path.clone(), line: number };
        let (name, password) = line.split_once(char::is_whitespace).ok_or_else(form)?;
        Ok(Some((name, password.trim())))
    }

    /// Seals what is in plain text or was sealed with a former key, and replaces the file. Returns the number of
    /// passwords that were sealed. A service manager's credential is sealed by the service manager.
    ///
    /// # Errors
    /// [`BrokerPasswordError`]; a line that no key opens is left as it is, and the others are sealed all the same.
    pub(super) fn seal(&self, sealer: &Sealer) -> Result<usize, BrokerPasswordError> {
        if self.is_credential {
            return Ok(0);
        }
        let (mut count, mut unopened) = (0, None);
        let mut text = Zeroizing::new(String::new());
        for (line, number) in self.text.lines().zip(1..) {
            match self.sealed_line(line, number, sealer) {
                Ok(Some(sealed)) => {
                    count += 1;
                    text.push_str(&sealed);
                }
                Ok(None) => text.push_str(line),
                Err(error) => {
                    unopened = unopened.or(Some(error));
                    text.push_str(line);
                }
            }
            text.push('\n');
        }
        if count > 0 {
            self.replace(&text)?;
        }
        unopened.map_or(Ok(count), Err)
    }

    /// Returns a line with its password sealed by the current key; none where there is nothing to seal.
    fn sealed_line(
        &self,
        line: &str,
        number: usize,
        sealer: &Sealer,
    ) -> Result<Option<String>, BrokerPasswordError> {
        let Some((user_name, password)) = self.account(line, number)? else { return Ok(None) };
        let sealing = |source| BrokerPasswordError::Sealing {
            user_name: user_name.to_owned(),
            path: self.path.clone(),
            source,
        };
        let plain: Confidential<String> = if !is_sealed(password) {
            password.into()
        } else if sealer.is_current(password).map_err(sealing)? {
            return Ok(None);
        } else {
            sealer.open(&purpose(user_name), password).map_err(sealing)?
        };
        let sealed = sealer.seal(&purpose(user_name), plain.expose()).map_err(sealing)?;
        Ok(Some(format!("{user_name} {sealed}")))
    }

    /// Puts a file with another text in place of this one, unless it was changed since it was read.
    fn replace(&self, text: &str) -> Result<(), BrokerPasswordError> {
        if text.len() as u64 > FILE_BYTES_MAX {
            let long = SecretFileError::Long { path: self.path.clone(), bytes_max: FILE_BYTES_MAX };
            return Err(long.into());
        }
        let failed = |source| BrokerPasswordError::Replace { path: self.path.clone(), source };
        let mut name = self.path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{:016x}", rand::random::<u64>()));
        let aside = self.path.with_file_name(name);
        let replaced = self.write(&aside, text).and_then(|()| {
            let is_as_read = PasswordFileState::of(&std::fs::metadata(&self.path)?) == self.state;
            if is_as_read {
                std::fs::rename(&aside, &self.path)?;
            }
            Ok(is_as_read)
        });
        if !matches!(replaced, Ok(true)) {
            // The reason to report is why it was not put in place.
            drop(std::fs::remove_file(&aside));
        }
        if !replaced.map_err(failed)? {
            return Err(BrokerPasswordError::Changed { path: self.path.clone() });
        }
        // A key that was renewed opens the former file no more: the new one has to last.
        let folder = self.path.parent().unwrap_or(Path::new("/"));
        File::open(folder).and_then(|folder| folder.sync_all()).map_err(failed)
    }

    /// Writes a file for the user whose file this is: a command of root's must not take it from the platform.
    fn write(&self, aside: &Path, text: &str) -> io::Result<()> {
        let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(aside)?;
        let (owner, group) = self.state.owner;
        if file.metadata()?.uid() != owner {
            std::os::unix::fs::fchown(&file, Some(owner), Some(group))?;
        }
        file.write_all(text.as_bytes())?;
        file.sync_all()
    }
}
