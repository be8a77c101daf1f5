//! File of sealing keys: one a line, the current one first.

use std::{
    fs::OpenOptions,
    io::{self, Read as _, Write as _},
    os::unix::fs::{MetadataExt as _, OpenOptionsExt as _},
    path::{Path, PathBuf},
};

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use ring::rand::{SecureRandom as _, SystemRandom};
use sha2::{Digest as _, Sha256};
use zeroize::{Zeroize as _, Zeroizing};

use crate::{Confidential, data_directory::is_trusted_owner};

const KEY_BYTES: usize = 32;
/// Keys in one file: the current one, and former ones until all is sealed again.
const KEYS_MAX: usize = 8;
const FILE_BYTES_MAX: u64 = 4096;
/// Length of a key's id.
pub(super) const ID_CHARACTERS: usize = 16;

/// Bits of mode of a key's file that give others a way to it.
pub(super) const NOT_FOR_OTHERS: u32 = 0o077;
/// The same of a service manager's credential: 0400 or, in a container, a group's.
pub(super) const NOT_FOR_ALL: u32 = 0o007;

/// Failure to read, make or replace the keys.
#[derive(Debug, thiserror::Error)]
pub enum KeyFileError {
    #[error("cannot read or write {}", path.display())]
    Access {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    #[error("the key {} is missing; restore it", path.display())]
    Missing { path: PathBuf },
    #[error("the key {path} belongs to another user: run `chown` for the user of this program", path = path.display())]
    Foreign { path: PathBuf },
    #[error("others may read the key {path}: run `chmod 600 {path}`", path = path.display())]
    Shared { path: PathBuf },
    #[error(
        "{} holds no keys: one a line, 32 bytes as unpadded base64url, the current one first and at most {KEYS_MAX}",
        path.display()
    )]
    Form { path: PathBuf },
    #[error("the system gives no random bytes")]
    Random,
}

/// A key with its id, the beginning of its hash.
pub(super) struct Key {
    bytes: Zeroizing<[u8; KEY_BYTES]>,
    id: String,
}

impl Key {
    fn new(bytes: [u8; KEY_BYTES]) -> Self {
        // Half of the hash is never told: an id helps nobody to try keys.
        let id = hex::encode(&Sha256::digest(bytes)[..ID_CHARACTERS / 2]);
        Self { bytes: Zeroizing::new(bytes), id }
    }

    pub(super) fn random() -> Result<Self, KeyFileError> {
        random_bytes().map(Self::new)
    }

    pub(super) fn id(&self) -> &str {
        &self.id
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[..]
    }

    /// Returns the key as a line of the file.
    pub(super) fn line(&self) -> Confidential<String> {
        URL_SAFE_NO_PAD.encode(&self.bytes[..]).into()
    }

    fn of_line(line: &str) -> Option<Self> {
        let mut decoded = URL_SAFE_NO_PAD.decode(line).ok()?;
        let key = decoded.as_slice().try_into().ok().map(Self::new);
        decoded.zeroize();
        key
    }
}

/// Keys of a file, the current one first; never empty.
pub(super) struct KeyFile(Vec<Key>);

impl KeyFile {
    pub(super) fn current(&self) -> &Key {
        self.0.first().expect("a key's file without keys is refused")
    }

    pub(super) fn with_id(&self, id: &str) -> Option<&Key> {
        self.0.iter().find(|key| key.id == id)
    }

    /// Reads the keys of a file. One with any of the `barred` bits of mode is refused.
    pub(super) fn read(path: &Path, barred: u32) -> Result<Self, KeyFileError> {
        let access = |source: io::Error| match source.kind() {
            io::ErrorKind::NotFound => KeyFileError::Missing { path: path.to_owned() },
            _ => KeyFileError::Access { path: path.to_owned(), source },
        };
        let file = OpenOptions::new().read(true).open(path).map_err(access)?;
        let metadata = file.metadata().map_err(access)?;
        if metadata.mode() & barred != 0 {
            return Err(KeyFileError::Shared { path: path.to_owned() });
        }
        if !is_trusted_owner(metadata.uid()) {
            return Err(KeyFileError::Foreign { path: path.to_owned() });
        }
        let mut text = Zeroizing::new(String::new());
        file.take(FILE_BYTES_MAX).read_to_string(&mut text).map_err(access)?;
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let keys: Option<Vec<Key>> = lines.map(Key::of_line).collect();
        keys.filter(|keys| (1..=KEYS_MAX).contains(&keys.len()))
            .map(Self)
            .ok_or_else(|| KeyFileError::Form { path: path.to_owned() })
    }

    /// Reads the keys, or makes the first one.
    pub(super) fn read_or_create(path: &Path, barred: u32) -> Result<Self, KeyFileError> {
        match Self::read(path, barred) {
            Err(KeyFileError::Missing { .. }) => {}
            result => return result,
        }
        let access = |source| KeyFileError::Access { path: path.to_owned(), source };
        let written = write_aside(path, &[Key::random()?]).map_err(access)?;
        // Linked, not renamed: of two that make it at once the second must not replace the first.
        let linked = std::fs::hard_link(&written, path);
        std::fs::remove_file(&written).map_err(access)?;
        match linked {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(access(error)),
            _ => sync_folder(path).map_err(access).and_then(|()| Self::read(path, barred)),
        }
    }

    /// Puts a new key before the current one, which stays as the former one.
    pub(super) fn renew(path: &Path) -> Result<(), KeyFileError> {
        let Self(keys) = Self::read_or_create(path, NOT_FOR_OTHERS)?;
        let renewed: Vec<Key> =
            [Key::random()?].into_iter().chain(keys.into_iter().take(1)).collect();
        let access = |source| KeyFileError::Access { path: path.to_owned(), source };
        let written = write_aside(path, &renewed).map_err(access)?;
        std::fs::rename(&written, path).and_then(|()| sync_folder(path)).map_err(access)
    }
}

/// Writes keys durably into a new file of its owner alone, beside the one that it is for.
fn write_aside(path: &Path, keys: &[Key]) -> io::Result<PathBuf> {
    let suffix: [u8; 8] = random_bytes().map_err(io::Error::other)?;
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}", hex::encode(suffix)));
    let aside = path.with_file_name(name);
    let mut file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(&aside)?;
    for key in keys {
        writeln!(file, "{}", key.line().expose())?;
    }
    file.sync_all()?;
    Ok(aside)
}

/// Makes a new name in a folder durable: a store that is sealed with a lost key is lost, too.
fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    std::fs::File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}

pub(super) fn random_bytes<const N: usize>() -> Result<[u8; N], KeyFileError> {
    let mut bytes = [0; N];
    SystemRandom::new().fill(&mut bytes).map_err(|_| KeyFileError::Random)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    #[test]
    fn a_key_is_made_once_for_its_owner_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        assert!(matches!(KeyFile::read(&path, NOT_FOR_OTHERS), Err(KeyFileError::Missing { .. })));
        let made = KeyFile::read_or_create(&path, NOT_FOR_OTHERS).expect("made");
        let again = KeyFile::read_or_create(&path, NOT_FOR_OTHERS).expect("read");
        assert_eq!(made.current().id(), again.current().id());
        let mode = std::fs::metadata(&path).expect("there").mode() & 0o777;
        assert_eq!(mode, 0o600);
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    }

    #[test]
    fn two_that_make_the_key_at_once_have_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        let made = || {
            KeyFile::read_or_create(&path, NOT_FOR_OTHERS)
                .map(|keys| keys.current().id().to_owned())
        };
        let ids: Vec<String> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(made)).collect();
            threads.into_iter().map(|thread| thread.join().expect("ends").expect("a key")).collect()
        });
        assert!(ids.iter().all(|id| *id == ids[0]), "{ids:?}");
    }

    #[test]
    fn a_key_of_another_user_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        KeyFile::read_or_create(&path, NOT_FOR_OTHERS).expect("made");
        // Root alone gives files away.
        if std::os::unix::fs::chown(&path, Some(65_534), None).is_ok() {
            let read = KeyFile::read(&path, NOT_FOR_OTHERS);
            assert!(matches!(read, Err(KeyFileError::Foreign { .. })));
        }
    }

    #[test]
    fn a_file_that_is_open_to_all_or_holds_no_key_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("key");
        KeyFile::read_or_create(&path, NOT_FOR_OTHERS).expect("made");
        for (mode, barred) in [
            (0o604, NOT_FOR_OTHERS),
            (0o640, NOT_FOR_OTHERS),
            (0o620, NOT_FOR_OTHERS),
            (0o444, NOT_FOR_ALL),
        ] {
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).expect("ours");
            let read = KeyFile::read(&path, barred);
            assert!(matches!(read, Err(KeyFileError::Shared { .. })), "{mode:o}");
        }
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o440)).expect("ours");
        assert!(
            KeyFile::read(&path, NOT_FOR_ALL).is_ok(),
            "a container's group has its credential"
        );
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).expect("ours");
        for text in ["", "\n", "rubbish", "AAAA", &"x".repeat(10_000)] {
            std::fs::write(&path, text).expect("written");
            assert!(
                matches!(KeyFile::read(&path, NOT_FOR_OTHERS), Err(KeyFileError::Form { .. })),
                "{text}"
            );
        }
    }
}
