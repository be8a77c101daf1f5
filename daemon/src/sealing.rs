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
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sealer(folder: &Path) -> Sealer {
        Sealer::with_credentials(&SealingConfig::default(), folder, None)
    }

    #[test]
    fn a_password_opens_for_its_purpose_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let sealer = sealer(folder.path());
        let sealed = sealer.seal("source/press", "canary").expect("sealed");
        assert!(!sealed.contains("canary"));
        assert_ne!(
            sealed,
            sealer.seal("source/press", "canary").expect("sealed"),
            "no nonce twice"
        );
        assert_eq!(sealer.open("source/press", &sealed).expect("opened").expose(), "canary");
        for other in ["source/robot", ""] {
            let refused = sealer.open(other, &sealed);
            assert!(matches!(refused, Err(SealingError::Unreadable)), "{other}");
        }
    }

    #[test]
    fn a_changed_text_opens_nowhere() {
        let folder = tempfile::tempdir().expect("a folder");
        let sealer = sealer(folder.path());
        let sealed = sealer.seal("broker", "canary").expect("sealed");
        let body = sealed.rfind('.').expect("parts") + 1;
        for at in body..sealed.len() {
            let mut changed = sealed.clone().into_bytes();
            changed[at] = if changed[at] == b'A' { b'B' } else { b'A' };
            let changed = String::from_utf8(changed).expect("text");
            // The last sign has bits that count for nothing.
            if parts(&changed).is_ok_and(|(_, bytes)| parts(&sealed).is_ok_and(|(_, b)| b == bytes))
            {
                continue;
            }
            assert!(sealer.open("broker", &changed).is_err(), "sign {at}");
        }
    }

    #[test]
    fn a_store_without_its_key_names_the_key() {
        let folder = tempfile::tempdir().expect("a folder");
        let other = tempfile::tempdir().expect("a folder");
        let sealed = sealer(folder.path()).seal("broker", "canary").expect("sealed");
        let none = sealer(other.path()).open("broker", &sealed).expect_err("no key");
        assert!(matches!(none, SealingError::Key(_)), "{none}");
        assert!(!other.path().join(KEY_FILE).exists(), "opening makes no key");
        sealer(other.path()).seal("broker", "x").expect("another key");
        let other = sealer(other.path()).open("broker", &sealed).expect_err("another key");
        assert!(matches!(other, SealingError::UnknownKey { .. }), "{other}");
    }

    #[test]
    fn a_renewed_key_opens_what_the_one_before_has_sealed() {
        let folder = tempfile::tempdir().expect("a folder");
        let sealer = sealer(folder.path());
        let first = sealer.seal("broker", "canary").expect("sealed");
        sealer.renew().expect("renewed");
        let second = sealer.seal("broker", "canary").expect("sealed");
        assert!(
            !sealer.is_current(&first).expect("a key")
                && sealer.is_current(&second).expect("a key")
        );
        assert_eq!(sealer.open("broker", &first).expect("opened").expose(), "canary");
        sealer.renew().expect("renewed again");
        assert!(matches!(sealer.open("broker", &first), Err(SealingError::UnknownKey { .. })));
        assert_eq!(sealer.open("broker", &second).expect("opened").expose(), "canary");
    }

    #[test]
    fn a_credential_comes_before_a_file_and_is_never_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let config = SealingConfig { key_file: Some(folder.path().join("configured")) };
        let credentials = folder.path().join("credentials");
        std::fs::create_dir(&credentials).expect("made");
        let chosen =
            || Sealer::with_credentials(&config, folder.path(), Some(&credentials)).place().clone();
        assert_eq!(chosen(), KeyPlace::Configured(folder.path().join("configured")));
        let credential = credentials.join(CREDENTIAL);
        std::fs::write(&credential, new_key().expect("a key").expose()).expect("written");
        let for_the_service = std::os::unix::fs::PermissionsExt::from_mode(0o400);
        std::fs::set_permissions(&credential, for_the_service).expect("ours");
        assert_eq!(chosen(), KeyPlace::Credential(credential.clone()));
        let sealer = Sealer::with_credentials(&config, folder.path(), Some(&credentials));
        let sealed = sealer.seal("broker", "canary").expect("sealed");
        assert_eq!(sealer.open("broker", &sealed).expect("opened").expose(), "canary");
        assert!(matches!(sealer.renew(), Err(SealingError::Credential)));
    }

    proptest! {
        #[test]
        fn any_password_survives(password in ".{0,200}", purpose in ".{0,40}") {
            let key = Key::random().expect("random bytes");
            let sealed = seal_with(&key, &purpose, &password).expect("sealed");
            let (_, body) = parts(&sealed).expect("ours");
            let opened = open_with(&key, &purpose, body).expect("opened");
            prop_assert_eq!(opened.expose(), &password);
        }

        #[test]
        fn any_text_is_met_without_panic(text in ".{0,200}") {
            if let Ok((_, body)) = parts(&text) {
                drop(open_with(&Key::random().expect("random bytes"), "", body));
            }
        }
    }
}
