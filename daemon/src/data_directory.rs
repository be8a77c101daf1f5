//! The data directory of a daemon: for its own user alone.
//!
//! Keys, hashes of passwords and values of a plant are in there. Three walls: what the process creates
//! is its user's ([`restrict_new_files`]), what earlier versions left open is closed ([`tighten`]), and
//! a folder that others may enter is refused, since the files of a database come and go.

use std::{
    fs::{DirBuilder, Permissions},
    io,
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
};

/// Permissions of group and others.
const OTHERS: u32 = 0o077;
/// Levels of folders below the data directory that are looked through; daemons make three.
const DEPTH_MAX: usize = 8;

/// Failure to use a data directory.
#[derive(Debug, thiserror::Error)]
pub enum DataDirectoryError {
    #[error("cannot make the data directory {}; set data_directory to a place that can be written", path.display())]
    Create {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
    /// Others may enter the folder.
    #[error(
        "other users of this machine may enter the data directory {path} (its mode is {mode:03o}): run `chmod 700 {path}`, \
         or set allow_shared_data_directory = true where the mode is not yours to choose",
        path = path.display()
    )]
    Shared {
        path: PathBuf,
        /// Permission bits of the folder.
        mode: u32,
    },
    /// The owner of the folder could read and change all in it.
    #[error(
        "the data directory {path} belongs to another user (its id is {owner}): run `chown` for the user of this program, \
         or set allow_shared_data_directory = true where the owner is not yours to choose",
        path = path.display()
    )]
    Foreign { path: PathBuf, owner: u32 },
    #[error("cannot restrict {} to the user of this program; does it belong to another one?", path.display())]
    Restrict {
        path: PathBuf,
        #[source]
        source: io::Error,
    },
}

/// Returns true for the owner of a file that may decide about this process: its own user, and root.
#[must_use]
pub fn is_trusted_owner(owner: u32) -> bool {
    owner == 0 || owner == rustix::process::geteuid().as_raw()
}

/// Makes everything that this process creates from here on readable for its own user alone. Called
/// first in `main`: it holds for the process.
pub fn restrict_new_files() {
    rustix::process::umask(rustix::fs::Mode::RWXG | rustix::fs::Mode::RWXO);
}

/// Creates the data directory where it is missing, for the own user alone, and [tightens](tighten)
/// one that is there.
///
/// # Errors
/// [`DataDirectoryError`].
pub fn create(path: &Path, is_shared_allowed: bool) -> Result<(), DataDirectoryError> {
    DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(path)
        .map_err(|source| DataDirectoryError::Create { path: path.to_owned(), source })?;
    tighten(path, is_shared_allowed)
}

/// Refuses a data directory that others own or may enter, unless that is allowed, and takes the rights of
/// group and others from every file in it. Nothing to do where there is no such folder.
///
/// # Errors
/// [`DataDirectoryError::Shared`], [`DataDirectoryError::Foreign`] and [`DataDirectoryError::Restrict`].
pub fn tighten(path: &Path, is_shared_allowed: bool) -> Result<(), DataDirectoryError> {
    let (mode, owner) = match std::fs::metadata(path) {
        Ok(metadata) => (metadata.mode() & 0o7777, metadata.uid()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(source) => {
            return Err(DataDirectoryError::Restrict { path: path.to_owned(), source });
        }
    };
    if !is_trusted_owner(owner) {
        if !is_shared_allowed {
            return Err(DataDirectoryError::Foreign { path: path.to_owned(), owner });
        }
        tracing::warn!(
            directory = %path.display(), owner,
            "The data directory belongs to another user, as allow_shared_data_directory allows."
        );
    }
    if mode & OTHERS != 0 {
        if !is_shared_allowed {
            return Err(DataDirectoryError::Shared { path: path.to_owned(), mode });
        }
        tracing::warn!(
            directory = %path.display(), mode = format!("{mode:03o}"),
            "Other users of this machine may enter the data directory, as allow_shared_data_directory allows."
        );
    }
    tighten_entries(path, DEPTH_MAX)
}

fn tighten_entries(folder: &Path, depth: usize) -> Result<(), DataDirectoryError> {
    let fault = |path: &Path| {
        let path = path.to_owned();
        move |source| DataDirectoryError::Restrict { path, source }
    };
    for entry in std::fs::read_dir(folder).map_err(fault(folder))? {
        let path = entry.map_err(fault(folder))?.path();
        // Files of a database that is in use come and go meanwhile.
        let Some(metadata) = found(std::fs::symlink_metadata(&path)).map_err(fault(&path))? else {
            continue;
        };
        // A link's target has its own place and owner.
        if metadata.is_symlink() {
            continue;
        }
        let mode = metadata.mode();
        if mode & OTHERS != 0 {
            let tightened = Permissions::from_mode(mode & 0o7777 & !OTHERS);
            found(std::fs::set_permissions(&path, tightened)).map_err(fault(&path))?;
        }
        if metadata.is_dir() && depth > 0 {
            tighten_entries(&path, depth - 1)?;
        }
    }
    Ok(())
}

/// Returns `None` for what is no longer there.
fn found<T>(result: io::Result<T>) -> io::Result<Option<T>> {
    match result {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        result => result.map(Some),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(path: &Path) -> u32 {
        std::fs::metadata(path).expect("it exists").mode() & 0o777
    }

    fn set(path: &Path, mode: u32) {
        std::fs::set_permissions(path, Permissions::from_mode(mode)).expect("its owner may");
    }

    #[test]
    fn a_new_folder_is_its_users_alone() {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("var/data");
        tighten(&path, false).expect("no folder is no fault");
        assert!(!path.exists());
        create(&path, false).expect("made");
        assert_eq!(mode(&path), 0o700);
    }

    #[test]
    fn files_of_earlier_versions_are_closed_and_links_stay_untouched() {
        let parent = tempfile::tempdir().expect("a folder");
        let (path, aside) = (parent.path().join("data"), parent.path().join("aside"));
        create(&path, false).expect("made");
        let (file, key, folder) = (path.join("store"), path.join("pki/key"), path.join("pki"));
        std::fs::create_dir(&folder).expect("made");
        for (path, rights) in [(&file, 0o644), (&key, 0o400), (&aside, 0o644)] {
            std::fs::write(path, "").expect("written");
            set(path, rights);
        }
        set(&folder, 0o755);
        std::os::unix::fs::symlink(&aside, path.join("link")).expect("linked");
        create(&path, false).expect("used");
        let modes = [&file, &key, &folder, &aside].map(|path| mode(path));
        assert_eq!(modes, [0o600, 0o400, 0o700, 0o644]);
    }

    #[test]
    fn a_folder_of_another_user_is_refused() {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("data");
        create(&path, false).expect("made");
        // Root alone gives folders away; for all others the owner is a matter of the kernel.
        if std::os::unix::fs::chown(&path, Some(65_534), None).is_ok() {
            let refused = create(&path, false);
            let is_foreign =
                matches!(refused, Err(DataDirectoryError::Foreign { owner: 65_534, .. }));
            assert!(is_foreign, "{refused:?}");
            create(&path, true).expect("allowed");
        }
        assert!(is_trusted_owner(0) && !is_trusted_owner(65_533));
    }

    #[test]
    fn a_folder_that_others_may_enter_is_refused_with_the_remedy_unless_allowed() {
        let parent = tempfile::tempdir().expect("a folder");
        let path = parent.path().join("data");
        create(&path, false).expect("made");
        std::fs::write(path.join("store"), "").expect("written");
        set(&path.join("store"), 0o644);
        for open in [0o755, 0o750, 0o701] {
            set(&path, open);
            let refused = create(&path, false).expect_err("refused").to_string();
            let remedy = format!("chmod 700 {}", path.display());
            assert!(refused.contains(&remedy), "{refused}");
            assert!(refused.contains(&format!("{open:o}")), "{refused}");
        }
        create(&path, true).expect("allowed");
        assert_eq!(
            (mode(&path), mode(&path.join("store"))),
            (0o701, 0o600),
            "its files are closed"
        );
    }
}
