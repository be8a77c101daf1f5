//! Key that signs the checkpoints of access logs, in a file apart from the database.

use std::{
    io,
    path::{Path, PathBuf},
};

use access_log::AccessLogKey;

use crate::certificates::{CertificateError, write};

/// Name of the key's file in the data directory.
pub const ACCESS_LOG_KEY_FILE: &str = "access-log-key.pem";

/// Failure to read or write the key.
#[derive(Debug, thiserror::Error)]
pub enum AccessLogKeyError {
    /// The file cannot be read, or is no key.
    #[error("cannot read the key {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// The file cannot be written.
    #[error("cannot write the key")]
    Write(#[from] CertificateError),
}

/// Reads the key, or makes one at the first start.
///
/// # Errors
/// [`AccessLogKeyError`] when the file cannot be read, is no key, or cannot be written.
pub fn open(path: &Path) -> Result<AccessLogKey, AccessLogKeyError> {
    let failed = |source| AccessLogKeyError::Read { path: path.into(), source };
    let invalid = |error| failed(io::Error::new(io::ErrorKind::InvalidData, error));
    match std::fs::read_to_string(path) {
        Ok(pem) => AccessLogKey::from_pem(&pem).map_err(invalid),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let key = AccessLogKey::from_secret(&rand::random());
            write(path, key.to_pem().map_err(invalid)?.as_bytes(), 0o600)?;
            Ok(key)
        }
        Err(error) => Err(failed(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_made_once_and_read_afterwards() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(ACCESS_LOG_KEY_FILE);
        let made = open(&path).expect("a new key");
        assert_eq!(open(&path).expect("the key").public(), made.public());
        std::fs::write(&path, "rubbish").expect("written");
        assert!(matches!(open(&path), Err(AccessLogKeyError::Read { .. })));
    }
}
