//! Files of a folder. One that cannot be read is an error: without a revocation list that is there, a revoked
//! certificate would be trusted.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::ShopFloorError;

/// Returns the paths in a folder, sorted; none where there is no folder.
///
/// # Errors
/// [`ShopFloorError::Certificates`] where the folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>, ShopFloorError> {
    let unreadable = |error: io::Error| disk(folder, &error);
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(unreadable(error)),
    };
    let mut paths = entries
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<Vec<_>>>()
        .map_err(unreadable)?;
    paths.sort();
    Ok(paths)
}

/// Returns the paths in a folder with their content, of at most so many bytes each.
///
/// # Errors
/// [`ShopFloorError::Certificates`] where the folder or one of its files cannot be read.
pub(super) fn contents(
    folder: &Path,
    bytes_max: u64,
) -> Result<Vec<(PathBuf, Vec<u8>)>, ShopFloorError> {
    files(folder)?
        .into_iter()
        .map(|path| match read(&path, bytes_max) {
            Ok(content) => Ok((path, content)),
            Err(error) => Err(disk(&path, &error)),
        })
        .collect()
}

/// Reads a file of at most so many bytes.
pub(super) fn read(path: &Path, bytes_max: u64) -> io::Result<Vec<u8>> {
    if fs::metadata(path)?.len() > bytes_max {
        return Err(io::Error::other(format!("the file is longer than {bytes_max} bytes")));
    }
    fs::read(path)
}

pub(super) fn disk(path: &Path, error: &io::Error) -> ShopFloorError {
    ShopFloorError::Certificates(format!("{}: {error}", path.display()))
}
