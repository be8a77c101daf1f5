//! Place where a store is in use.
//!
//! While a connector runs it holds a lock on a file in the data directory. The lock belongs to that
//! very file under that very run of the operating system; so two processes that name the same file
//! and the same run cannot both be alive. A copy of the folder has another file; another machine,
//! and the same machine after a restart, has another run.

use std::{fs::File, io, os::unix::fs::MetadataExt as _, path::Path};

use asi_model::PlaceId;
use sha2::{Digest as _, Sha256};
use uuid::Uuid;

/// Random id that Linux draws at every start; containers see that of their machine.
const BOOT_ID: &str = "/proc/sys/kernel/random/boot_id";
const HOST_NAME: &str = "/proc/sys/kernel/hostname";
/// Longest description of a place, in characters.
const HOST_CHARS_MAX: usize = 200;
/// Bytes of the digest that are a place's name.
const PLACE_BYTES: usize = 16;

/// Names the place of a locked file.
pub(super) fn place_of(lock: &File) -> io::Result<PlaceId> {
    let file = lock.metadata()?;
    // Without the run's id each start counts as a run: a copy on another disk might have the
    // same inode number.
    let boot = std::fs::read_to_string(BOOT_ID).unwrap_or_else(|_| Uuid::new_v4().to_string());
    let digest = Sha256::digest(format!("{}/{}/{}", boot.trim(), file.dev(), file.ino()));
    Ok(PlaceId::new(hex::encode(&digest[..PLACE_BYTES]))
        .expect("hexadecimal digits make a place id"))
}

/// Names machine and folder for people.
pub(super) fn host_of(directory: &Path) -> String {
    let machine = std::fs::read_to_string(HOST_NAME).unwrap_or_default();
    let machine =
        Some(machine.trim()).filter(|name| !name.is_empty()).unwrap_or("a machine without a name");
    let folder = std::path::absolute(directory).unwrap_or_else(|_| directory.to_owned());
    format!("{machine}:{}", folder.display())
        .chars()
        .filter(|c| !c.is_control())
        .take(HOST_CHARS_MAX)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_is_at_another_place_and_a_renamed_or_reopened_file_is_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let place =
            |name: &str| place_of(&File::open(path(name)).expect("a file")).expect("a place");
        std::fs::write(path("lock"), "").expect("written");
        std::fs::copy(path("lock"), path("copy")).expect("copied");
        assert_eq!(place("lock"), place("lock"));
        assert_ne!(place("lock"), place("copy"));
        let before = place("lock");
        std::fs::rename(path("lock"), path("moved")).expect("moved");
        assert_eq!(before, place("moved"));
        assert!(host_of(folder.path()).ends_with(&folder.path().display().to_string()));
    }
}
