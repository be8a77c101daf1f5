//! Space on disks, of the store's and of the broker's.

use std::path::Path;

use broker::DiskSpace;

/// Returns the space of the disk that a file or folder lies on; none where that says nothing.
#[must_use]
pub fn space_of(path: &Path) -> Option<DiskSpace> {
    let disk = rustix::fs::statvfs(path).ok()?;
    let bytes = |blocks: u64| blocks.saturating_mul(disk.f_frsize);
    Some(DiskSpace { free: bytes(disk.f_bavail), size: bytes(disk.f_blocks) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_says_what_it_has_and_nothing_says_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let space = space_of(folder.path()).expect("a disk");
        assert!(space.size > 0 && space.free <= space.size, "{space:?}");
        assert_eq!(space_of(Path::new("/proc/self/nothing")), None);
    }
}
