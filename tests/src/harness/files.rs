//! Files with passwords.

use std::{
    fs::{self, OpenOptions, Permissions},
    io::{self, Write as _},
    os::unix::fs::{OpenOptionsExt as _, PermissionsExt as _},
    path::Path,
};

/// Access for the user alone.
const OF_THE_USER_ALONE: u32 = 0o600;

/// Writes a file that the user alone may read, as a configuration with passwords has to be.
///
/// # Errors
/// When it cannot be written.
pub fn write_private(file: &Path, text: &str) -> io::Result<()> {
    let mut options = OpenOptions::new();
    let mut opened =
        options.write(true).create(true).truncate(true).mode(OF_THE_USER_ALONE).open(file)?;
    opened.write_all(text.as_bytes())?;
    make_private(file)
}

/// Takes a file away from all but its user.
///
/// # Errors
/// When the mode cannot be set.
pub fn make_private(file: &Path) -> io::Result<()> {
    fs::set_permissions(file, Permissions::from_mode(OF_THE_USER_ALONE))
}
