//! Files with passwords and keys: read only while they are for this program's user alone.

use std::{
    fs::{File, Metadata},
    io::{self, Read as _},
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use zeroize::Zeroizing;

use crate::{data_directory::is_trusted_owner, sealing::CREDENTIALS_DIRECTORY};

/// Failure to read a file with a secret.
#[derive(Debug, thiserror::Error)]
pub enum SecretFileError {
    #[error("cannot read {}", path.display())]
    Access {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error("others may read {path}: run `chmod 600 {path}`", path = path.display())]
    Shared { path: PathBuf },
    /// Its owner could open it to others, and changes what is in it.
    #[error("{path} belongs to another user: run `chown` for the user of this program", path = path.display())]
    Foreign { path: PathBuf },
    #[error("{} is longer than {bytes_max} bytes", path.display())]
    Long { path: PathBuf, bytes_max: u64 },
}

/// A file with a secret, as it was read.
pub struct SecretFile {
    pub text: Zeroizing<String>,
    /// Metadata of the file before it was read.
    pub metadata: Metadata,
}

/// Reads a file of at most `bytes_max` that is for this program's user alone.
///
/// # Errors
/// [`SecretFileError`], which says what to do.
pub fn read(path: &Path, bytes_max: u64) -> Result<SecretFile, SecretFileError> {
    let access = |source| SecretFileError::Access { path: path.to_owned(), source };
    let file = File::open(path).map_err(access)?;
    let metadata = file.metadata().map_err(access)?;
    // A service manager's credential is 0400 or, in a container, a group's.
    let barred = if is_credential(path) { 0o007 } else { 0o077 };
    if metadata.mode() & barred != 0 {
        return Err(SecretFileError::Shared { path: path.to_owned() });
    }
    if !is_trusted_owner(metadata.uid()) {
        return Err(SecretFileError::Foreign { path: path.to_owned() });
    }
    let mut text = Zeroizing::new(String::new());
    let most = bytes_max.saturating_add(1);
    let bytes = file.take(most).read_to_string(&mut text).map_err(access)?;
    // Not cut off: what is read may be written again.
    if bytes as u64 > bytes_max {
        return Err(SecretFileError::Long { path: path.to_owned(), bytes_max });
    }
    Ok(SecretFile { text, metadata })
}

/// Returns true for a file that a service manager brought.
#[must_use]
pub fn is_credential(path: &Path) -> bool {
    let credentials = std::env::var_os(CREDENTIALS_DIRECTORY).map(PathBuf::from);
    credentials.is_some_and(|folder| path.starts_with(folder))
}
