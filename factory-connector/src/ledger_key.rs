//! The ledger's signing key, in a file apart from the database that it signs.

use std::{io, path::Path};

use ledger::{Hash, LedgerKey};

/// Name of the key's file in the data directory.
pub const LEDGER_KEY_FILE: &str = "ledger-key.pem";

/// The ledger's key cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot use the ledger's key {path}")]
pub struct LedgerKeyError {
    path: String,
    #[source]
    source: io::Error,
}

/// Reads the key, or makes one at the first start.
///
/// # Errors
/// [`LedgerKeyError`] when the file cannot be read, is no key, or cannot be written.
pub fn open(path: &Path) -> Result<LedgerKey, LedgerKeyError> {
    let fail = |source| LedgerKeyError { path: path.display().to_string(), source };
    let invalid = |error| fail(io::Error::new(io::ErrorKind::InvalidData, error));
    match std::fs::read_to_string(path) {
        Ok(pem) => LedgerKey::from_pem(&pem).map_err(invalid),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let key = LedgerKey::from_secret(&rand::random());
            write_private(path, key.to_pem().map_err(invalid)?.as_bytes()).map_err(fail)?;
            Ok(key)
        }
        Err(error) => Err(fail(error)),
    }
}

/// Reads the public half of the key in a file; `None` where there is no such file.
///
/// # Errors
/// [`LedgerKeyError`] when the file cannot be read or is no key.
pub fn public_half(path: &Path) -> Result<Option<Hash>, LedgerKeyError> {
    Ok(existing(path)?.map(|key| key.public()))
}

/// Reads the key in a file; `None` where there is no such file.
///
/// # Errors
/// [`LedgerKeyError`] when the file cannot be read or is no key.
pub fn existing(path: &Path) -> Result<Option<LedgerKey>, LedgerKeyError> {
    match path.try_exists() {
        Ok(true) => open(path).map(Some),
        Ok(false) => Ok(None),
        Err(source) => Err(LedgerKeyError { path: path.display().to_string(), source }),
    }
}

/// Writes a file that only its owner may read.
fn write_private(path: &Path, content: &[u8]) -> io::Result<()> {
    use std::io::Write as _;
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(0o600);
    }
    let mut file = options.open(path)?;
    file.write_all(content)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_made_once_and_read_afterwards() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(LEDGER_KEY_FILE);
        assert_eq!(public_half(&path).expect("no file is no fault"), None);
        let made = open(&path).expect("a new key");
        assert_eq!(public_half(&path).expect("a key"), Some(made.public()));
        std::fs::write(&path, "rubbish").expect("written");
        assert!(open(&path).is_err());
    }
}
