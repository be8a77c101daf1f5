//! Files in the folder of certificates.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::error::TwinError;

/// Longest certificate or revocation list read, in bytes. A person may have put any file into the
/// folder.
pub(crate) const FILE_BYTES_MAX: u64 = 4 * 1024 * 1024;

/// Returns the files of a folder with their content; files that cannot be read are left out.
pub(crate) fn files(
    folder: &Path,
    extension: &'static str,
) -> impl Iterator<Item = (PathBuf, Vec<u8>)> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    entries.filter_map(move |entry| {
        let path = entry.ok()?.path();
        let is_readable = path.extension().is_some_and(|found| found == extension)
            && path.metadata().is_ok_and(|metadata| metadata.len() <= FILE_BYTES_MAX);
        is_readable.then(|| fs::read(&path).ok()).flatten().map(|content| (path, content))
    })
}

/// Writes a file atomically: a reader never sees a part of it.
pub(crate) fn replace(path: &Path, bytes: &[u8]) -> Result<(), TwinError> {
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let failed = |source| TwinError::Pki { path: path.to_owned(), source };
    fs::write(&new, bytes).map_err(failed)?;
    fs::rename(&new, path).map_err(failed)
}
