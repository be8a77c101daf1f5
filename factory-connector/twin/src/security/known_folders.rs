//! Folders of the trust list, read again only after a change: strangers make the twin look at them with each connection.

use std::{
    io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use parking_lot::Mutex;

use super::{
    certificate_files::{files, paths},
    issuance::ItemsIn,
};
use crate::{clock, error::TwinError};

/// Time after which a change shows in the times of a file. Two within the same tick of a file system's clock may look
/// alike, so what was changed just now is read again.
const SETTLED_AFTER: Duration = Duration::from_secs(2);

/// Contents of the files of a folder, as DER.
pub(crate) type Items = Arc<Vec<Vec<u8>>>;

/// Folder with what its files held when they were read last.
pub(crate) struct KnownFolder {
    path: PathBuf,
    extension: &'static str,
    items_in: ItemsIn,
    settled_after: Duration,
    last: Mutex<Option<Reading>>,
}

struct Reading {
    stamps: Vec<Stamp>,
    /// False where a change may be as old as the reading.
    is_settled: bool,
    items: Items,
}

/// Marks of a file that change with its content. The time of the change of its state is set by the system alone, also
/// where a file is copied with its times, or another one is renamed to it.
#[derive(Debug, PartialEq, Eq)]
struct Stamp {
    path: PathBuf,
    file: (u64, u64),
    length: u64,
    modified: (i64, i64),
    changed: (i64, i64),
}

impl KnownFolder {
    /// Knows nothing of the folder yet.
    pub fn new(path: PathBuf, extension: &'static str, items_in: ItemsIn) -> Self {
        let last = Mutex::default();
        Self { path, extension, items_in, settled_after: SETTLED_AFTER, last }
    }

    /// Returns what the files hold now, as DER. The same as before is the same allocation.
    ///
    /// # Errors
    /// [`TwinError::Pki`] where the folder or a file cannot be read, or a file holds anything else.
    pub fn items(&self) -> Result<Items, TwinError> {
        // Other connections wait while it is read.
        let mut last = self.last.lock();
        let stamps = stamps(&self.path, self.extension)?;
        if let Some(known) = last.as_ref().filter(|one| one.is_settled && one.stamps == stamps) {
            return Ok(Arc::clone(&known.items));
        }
        let begun = clock::unix_time();
        let items = self.read()?;
        let is_settled = stamps_are_settled(&stamps, begun, self.settled_after)
            && self::stamps(&self.path, self.extension)? == stamps;
        let items = match last.take() {
            Some(known) if *known.items == items => known.items,
            _ => Arc::new(items),
        };
        *last = Some(Reading { stamps, is_settled, items: Arc::clone(&items) });
        Ok(items)
    }

    fn read(&self) -> Result<Vec<Vec<u8>>, TwinError> {
        let mut items = Vec::new();
        for (path, content) in files(&self.path, self.extension)? {
            items.extend((self.items_in)(&content).ok_or_else(|| {
                let source = io::Error::other("the file has other content, neither DER nor PEM");
                TwinError::Pki { path, source }
            })?);
        }
        Ok(items)
    }

    /// Sets the time after which a change shows in the times of a file.
    #[cfg(test)]
    pub fn settle_after(&mut self, settled_after: Duration) {
        self.settled_after = settled_after;
    }
}

fn stamps_are_settled(stamps: &[Stamp], begun: Duration, settled_after: Duration) -> bool {
    stamps.iter().all(|stamp| {
        let (seconds, nanoseconds) = stamp.changed;
        // A time before 1970 is no recent one.
        let changed = Duration::new(
            u64::try_from(seconds).unwrap_or_default(),
            u32::try_from(nanoseconds).unwrap_or_default(),
        );
        changed + settled_after <= begun
    })
}

/// Returns the marks of all files of a folder.
fn stamps(folder: &Path, extension: &str) -> Result<Vec<Stamp>, TwinError> {
    let mut stamps = Vec::new();
    for path in paths(folder, extension)? {
        match path.metadata() {
            Ok(found) => stamps.push(Stamp {
                file: (found.dev(), found.ino()),
                length: found.len(),
                modified: (found.mtime(), found.mtime_nsec()),
                changed: (found.ctime(), found.ctime_nsec()),
                path,
            }),
            // Moved to another folder meanwhile. A link that leads nowhere is still there.
            Err(error)
                if error.kind() == io::ErrorKind::NotFound && path.symlink_metadata().is_err() => {}
            Err(source) => return Err(TwinError::Pki { path, source }),
        }
    }
    Ok(stamps)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]

    use std::fs;

    use super::*;

    /// Time after which the files of these tests are settled; more than a tick of the system's clock.
    const SOON: Duration = Duration::from_millis(40);

    fn whole(content: &[u8]) -> Option<Vec<Vec<u8>>> {
        (content != b"damaged").then(|| vec![content.to_vec()])
    }

    fn folder() -> (tempfile::TempDir, KnownFolder) {
        let folder = tempfile::tempdir().unwrap();
        let mut known = KnownFolder::new(folder.path().to_owned(), "der", whole);
        known.settle_after(SOON);
        (folder, known)
    }

    #[test]
    fn a_folder_is_read_once_until_a_file_changes_and_then_at_once() {
        let (folder, known) = folder();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("a.der"), "1").unwrap();
        std::thread::sleep(2 * SOON);
        let first = known.items().unwrap();
        for _ in 0..100 {
            assert!(Arc::ptr_eq(&known.items().unwrap(), &first));
        }
        let is_read = || known.items().map(|items| items.concat());
        // Of the same length, with the times of the one before.
        let times = path("a.der").metadata().unwrap().modified().unwrap();
        fs::write(path("a.der"), "2").unwrap();
        fs::File::options().write(true).open(path("a.der")).unwrap().set_modified(times).unwrap();
        assert_eq!(is_read().unwrap(), b"2");
        // By another name, by renaming, by removal, and what is unreadable.
        fs::write(path("b.der"), "3").unwrap();
        assert_eq!(is_read().unwrap(), b"23");
        fs::write(path("b.new"), "4").unwrap();
        fs::rename(path("b.new"), path("b.der")).unwrap();
        assert_eq!(is_read().unwrap(), b"24");
        fs::write(path("b.der"), "damaged").unwrap();
        assert!(is_read().is_err());
        assert!(is_read().is_err(), "a failure is not kept either");
        fs::remove_file(path("b.der")).unwrap();
        assert_eq!(is_read().unwrap(), b"2");
    }

    #[test]
    fn changes_within_one_tick_of_the_clock_are_found() {
        let (folder, known) = folder();
        for number in 0..500_u32 {
            let content = format!("{number:03}");
            fs::write(folder.path().join("a.der"), &content).unwrap();
            assert_eq!(known.items().unwrap().concat(), content.as_bytes());
        }
    }
}
