//! Secrets in a store, sealed: a copy of the store alone tells none of them.
//!
//! A sealed text is `v1.<id of the key>.<nonce, ciphertext and tag>`, by ChaCha20-Poly1305 with a random
//! nonce. Its purpose is authenticated with it, so that the password of one row opens in no other. Keys
//! are read from their file with every use: a rotation beside the running daemon is seen at once.

mod key_file;
mod secrets;

use std::path::{Path, PathBuf};

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use ring::aead::{Aad, CHACHA20_POLY1305, LessSafeKey, NONCE_LEN, Nonce, UnboundKey};
use serde::Deserialize;

use crate::Confidential;
pub use key_file::KeyFileError;
use key_file::{Key, KeyFile};
pub use secrets::{SecretStore, StoredSecret, forget, remedy, rotate, seal_all};

/// Name of the credential that a service manager passes.
pub const CREDENTIAL: &str = "verbund-sealing-key";
/// Name of the key's file beside the store, where no other one is given.
pub const KEY_FILE: &str = "sealing-key";
/// Variable of systemd with the folder of the service's credentials.
pub const CREDENTIALS_DIRECTORY: &str = "CREDENTIALS_DIRECTORY";

const VERSION: &str = "v1";

/// Place of the key that seals passwords.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SealingConfig {
    /// File of the key, best on another medium than the store; beside the store where absent.
    pub key_file: Option<PathBuf>,
}

/// Origin of the key, best first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeyPlace {
    /// A credential of the service manager: in memory, readable for the service alone.
    Credential(PathBuf),
    /// The file that the configuration names.
    Configured(PathBuf),
    /// A file beside the store; a copy of both tells the passwords.
    BesideStore(PathBuf),
}

impl KeyPlace {
    /// Returns the key's file.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Credential(path) | Self::Configured(path) | Self::BesideStore(path) => path,
        }
    }

    /// Returns the bits of mode with which the key's file is refused.
    const fn barred(&self) -> u32 {
        match self {
            Self::Credential(_) => key_file::NOT_FOR_ALL,
            Self::Configured(_) | Self::BesideStore(_) => key_file::NOT_FOR_OTHERS,
        }
    }
}

/// Failure to seal or open a password.
#[derive(Debug, thiserror::Error)]
pub enum SealingError {
    #[error("the key that seals passwords cannot be used")]
    Key(#[from] KeyFileError),
    /// No key in the file opens it.
    #[error("it is sealed with the key {key_id}, which is not in {}; restore that file", path.display())]
    UnknownKey {
        /// Id of the missing key.
        key_id: String,
        path: PathBuf,
    },
    /// The text is none of ours, was changed, or belongs to another row.
    #[error("what is stored is no sealed password of this place")]
    Unreadable,
    /// The system gives no random bytes, or the text is longer than the cipher takes.
    #[error("the password cannot be sealed")]
    Seal,
    /// The service manager's credential cannot be written by the service.
    #[error(
        "the key is the credential {CREDENTIAL} of the service manager: put a new key (`seal new-key` prints one) into its \
         first line, keep the former one in the second, and start the service again"
    )]
    Credential,
}

/// Seals and opens passwords with the key of one place. Clones share nothing but the place.
#[derive(Debug, Clone)]
pub struct Sealer {
    place: KeyPlace,
}

impl Sealer {
    /// Chooses the key: a credential of the service manager, the configured file, or a file beside the
    /// store.
    #[must_use]
    pub fn new(config: &SealingConfig, data_directory: &Path) -> Self {
        let credentials = std::env::var_os(CREDENTIALS_DIRECTORY).map(PathBuf::from);
        Self::with_credentials(config, data_directory, credentials.as_deref())
    }

    fn with_credentials(
        config: &SealingConfig,
        data_directory: &Path,
        credentials: Option<&Path>,
    ) -> Self {
        // A unit may have credentials for other purposes alone.
        let credential = credentials.map(|folder| folder.join(CREDENTIAL));
        let place = match (credential.filter(|path| path.exists()), &config.key_file) {
            (Some(path), _) => KeyPlace::Credential(path),
            (None, Some(path)) if is_within(path, data_directory) => {
                KeyPlace::BesideStore(path.clone())
            }
            (None, Some(path)) => KeyPlace::Configured(path.clone()),
            (None, None) => KeyPlace::BesideStore(data_directory.join(KEY_FILE)),
        };
        Self { place }
    }

    /// Returns the origin of the key.
    #[must_use]
    pub const fn place(&self) -> &KeyPlace {
        &self.place
    }

    /// Returns whether the key lies beside the store: a copy of the folder has the key, too.
    #[must_use]
    pub const fn is_beside_store(&self) -> bool {
        matches!(self.place, KeyPlace::BesideStore(_))
    }

    /// Warns at the start of a daemon where the key lies beside the store.
    pub fn warn_of_place(&self) {
        if self.is_beside_store() {
            tracing::warn!(
                key = %self.place.path().display(),
                "The key that seals passwords lies BESIDE THE STORE: who has a copy of the data directory has the passwords. \
                 Pass it as the credential {CREDENTIAL} of the service manager, or set sealing.key_file to a file on another \
                 medium; docs/secrets.md says how to move it."
            );
        }
    }

    /// Seals a password for one purpose, such as the name of its row. Makes the key where the file is
    /// missing.
    ///
    /// # Errors
    /// [`SealingError`].
    pub fn seal(&self, purpose: &str, password: &str) -> Result<String, SealingError> {
        let keys = KeyFile::read_or_create(self.place.path(), self.place.barred())?;
        seal_with(keys.current(), purpose, password)
    }

    /// Opens what was sealed for the same purpose, with the current key or a former one.
    ///
    /// # Errors
    /// [`SealingError`].
    pub fn open(&self, purpose: &str, sealed: &str) -> Result<Confidential<String>, SealingError> {
        let (key_id, body) = parts(sealed)?;
        let keys = KeyFile::read(self.place.path(), self.place.barred())?;
        let key = keys.with_id(key_id).ok_or_else(|| SealingError::UnknownKey {
            key_id: key_id.to_owned(),
            path: self.place.path().to_owned(),
        })?;
        open_with(key, purpose, body)
    }

    /// Returns whether a text is sealed with the current key.
    ///
    /// # Errors
    /// [`SealingError`] where the key's file cannot be read, or the text is none of ours.
    pub fn is_current(&self, sealed: &str) -> Result<bool, SealingError> {
        let (key_id, _) = parts(sealed)?;
        Ok(KeyFile::read(self.place.path(), self.place.barred())?.current().id() == key_id)
    }

    /// Makes a new current key; the one before still opens what is sealed with it, older ones are
    /// forgotten. What is stored has to be sealed again before and after.
    ///
    /// # Errors
    /// [`SealingError`]; then the file is as before.
    pub fn renew(&self) -> Result<(), SealingError> {
        if matches!(self.place, KeyPlace::Credential(_)) {
            return Err(SealingError::Credential);
        }
        Ok(KeyFile::renew(self.place.path())?)
    }
}

/// Returns whether a file lies in a folder or below, by the folders as they are or, before they are made, by their names.
fn is_within(file: &Path, folder: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    file.starts_with(folder)
        || file.parent().is_some_and(|parent| real(parent).starts_with(real(folder)))
}

/// Returns whether a text has the form of a sealed one, whatever key it is sealed with.
#[must_use]
pub fn is_sealed(text: &str) -> bool {
    let is_key_id = |id: &str| id.len() == key_file::ID_CHARACTERS && hex::decode(id).is_ok();
    let bytes_min = NONCE_LEN + CHACHA20_POLY1305.tag_len();
    parts(text).is_ok_and(|(key_id, body)| is_key_id(key_id) && body.len() >= bytes_min)
}

/// Returns a new key as a line of a key's file.
///
/// # Errors
/// [`SealingError::Key`] where the system gives no random bytes.
pub fn new_key() -> Result<Confidential<String>, SealingError> {
    Ok(Key::random()?.line())
}

fn seal_with(key: &Key, purpose: &str, password: &str) -> Result<String, SealingError> {
    let nonce: [u8; NONCE_LEN] = key_file::random_bytes()?;
    let mut body = password.as_bytes().to_vec();
    cipher(key)?
        .seal_in_place_append_tag(
            Nonce::assume_unique_for_key(nonce),
            Aad::from(purpose.as_bytes()),
            &mut body,
        )
        .map_err(|_| SealingError::Seal)?;
    let body = [&nonce[..], &body].concat();
    Ok(format!("{VERSION}.{}.{}", key.id(), URL_SAFE_NO_PAD.encode(body)))
}

fn open_with(
    key: &Key,
    purpose: &str,
    mut body: Vec<u8>,
) -> Result<Confidential<String>, SealingError> {
    let (nonce, ciphertext) =
        body.split_at_mut_checked(NONCE_LEN).ok_or(SealingError::Unreadable)?;
    let nonce = Nonce::try_assume_unique_for_key(nonce).map_err(|_| SealingError::Unreadable)?;
    let opened = cipher(key)?
        .open_in_place(nonce, Aad::from(purpose.as_bytes()), ciphertext)
        .map_err(|_| SealingError::Unreadable)?;
    let text = String::from_utf8(opened.to_vec()).map_err(|_| SealingError::Unreadable)?;
    zeroize::Zeroize::zeroize(&mut body);
    Ok(text.into())
}

fn cipher(key: &Key) -> Result<LessSafeKey, SealingError> {
    let unbound = UnboundKey::new(&CHACHA20_POLY1305, key.bytes());
    unbound.map(LessSafeKey::new).map_err(|_| SealingError::Seal)
}

/// Takes a sealed text apart into the id of its key, and nonce, ciphertext and tag.
fn parts(sealed: &str) -> Result<(&str, Vec<u8>), SealingError> {
    let mut parts = sealed.splitn(3, '.');
    let (Some(VERSION), Some(key_id), Some(body)) = (parts.next(), parts.next(), parts.next())
    else {
        return Err(SealingError::Unreadable);
    };
    let body = URL_SAFE_NO_PAD.decode(body).map_err(|_| SealingError::Unreadable)?;
    Ok((key_id, body))
}

#[cfg(test)]
mod tests;
