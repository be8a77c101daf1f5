//! The Deno executable that scripts are tested with.

use std::path::PathBuf;

/// Folder with the lock file that pins it.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mapping-engine/script-deno");
/// Platform in the name of the package that has the executable inside.
const PLATFORM: &str =
    if cfg!(target_arch = "aarch64") { "linux-arm64-glibc" } else { "linux-x64-glibc" };

/// Returns the executable.
///
/// # Panics
/// Says how to install it where it is not there.
#[must_use]
pub fn executable() -> PathBuf {
    let path = PathBuf::from(format!("{FOLDER}/node_modules/@deno/{PLATFORM}/deno"));
    assert!(path.is_file(), "there is no {}: make deno", path.display());
    path
}
