//! Files with passwords and keys: read only while they are for this program's user alone.

use std::{
    fs::File,
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
}

/// Reads at most `bytes_max` of a file that is for this program's user alone.
///
/// # Errors
/// [`SecretFileError`], which says what to do.
pub fn read(path: &Path, bytes_max: u64) -> Result<Zeroizing<String>, SecretFileError> {
    let access = |source| SecretFileError::Access { path: path.to_owned(), source };
    let file = File::open(path).map_err(access)?;
    let metadata = file.metadata().map_err(access)?;
    if metadata.mode() & barred(path) != 0 {
        return Err(SecretFileError::Shared { path: path.to_owned() });
    }
    if !is_trusted_owner(metadata.uid()) {
        return Err(SecretFileError::Foreign { path: path.to_owned() });
    }
    let mut text = Zeroizing::new(String::new());
    file.take(bytes_max).read_to_string(&mut text).map_err(access)?;
    Ok(text)
}

/// Returns the bits of mode with which a file is refused. A service manager's credential is 0400 or, in a container,
/// a group's.
fn barred(path: &Path) -> u32 {
    let credentials = std::env::var_os(CREDENTIALS_DIRECTORY).map(PathBuf::from);
    let is_credential = credentials.is_some_and(|folder| path.starts_with(folder));
    if is_credential { 0o007 } else { 0o077 }
}
