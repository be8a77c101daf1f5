//! Files in the folder of certificates.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::error::TwinError;

/// Longest certificate or revocation list read, in bytes. A person may have put any file into the
/// folder.
pub(crate) const FILE_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// Returns the paths in a folder with this extension, sorted; none where there is no folder.
///
/// # Errors
/// [`TwinError::Pki`] where the folder cannot be read.
pub(crate) fn paths(folder: &Path, extension: &str) -> Result<Vec<PathBuf>, TwinError> {
    let unreadable = |source| TwinError::Pki { path: folder.to_owned(), source };
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(error)),
    };
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<Vec<_>>>()
        .map_err(unreadable)?;
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths.sort();
    Ok(paths)
}

/// Returns the files in a folder with this extension and their content.
///
/// # Errors
/// [`TwinError::Pki`] where the folder or a file cannot be read, or a file is too long: what it denies or revokes is not
/// known then.
pub(crate) fn files(folder: &Path, extension: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, TwinError> {
    let mut files = Vec::new();
    for path in paths(folder, extension)? {
        match read(&path) {
            Ok(content) => files.push((path, content)),
            // Moved to another folder meanwhile. A link that leads nowhere is still there.
            Err(error)
                if error.kind() == io::ErrorKind::NotFound && path.symlink_metadata().is_err() => {}
            Err(source) => return Err(TwinError::Pki { path, source }),
        }
    }
    Ok(files)
}

/// Reads a file of bounded length.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    if path.metadata()?.len() > FILE_BYTES_MAX {
        return Err(io::Error::other(format!("the file is longer than {FILE_BYTES_MAX} bytes")));
    }
    fs::read(path)
}

/// Writes a file atomically: a reader never sees a part of it.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), TwinError> {
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let failed = |source| TwinError::Pki { path: path.to_owned(), source };
    fs::write(&new, bytes).map_err(failed)?;
    fs::rename(&new, path).map_err(failed)
}
