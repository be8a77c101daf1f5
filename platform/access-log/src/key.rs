//! Key that signs the checkpoints of access logs: Ed25519, as a PKCS#8 document in PEM.

use ed25519_dalek::{
    SigningKey,
    pkcs8::{DecodePrivateKey as _, EncodePrivateKey as _, spki::der::pem::LineEnding},
};
use transparency_log::{KeyKind, NoteKey};

/// Fault of a key that cannot be read or written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("this is no Ed25519 key in PEM: {0}")]
pub struct UnusableKey(String);

/// Signs the checkpoints of all logs of a platform. Its Debug form does not show the key.
#[derive(Clone)]
pub struct AccessLogKey(SigningKey);

impl AccessLogKey {
    /// Derives a key from 32 random bytes.
    #[must_use]
    pub fn from_secret(secret: &[u8; 32]) -> Self {
        Self(SigningKey::from_bytes(secret))
    }

    /// Reads a key from its PEM text.
    ///
    /// # Errors
    /// [`UnusableKey`] when the text is not an Ed25519 key.
    pub fn from_pem(pem: &str) -> Result<Self, UnusableKey> {
        SigningKey::from_pkcs8_pem(pem).map(Self).map_err(|error| UnusableKey(error.to_string()))
    }

    /// Writes the key, its secret half included, as PEM.
    ///
    /// # Errors
    /// [`UnusableKey`] when the key cannot be encoded.
    pub fn to_pem(&self) -> Result<String, UnusableKey> {
        let pem = self.0.to_pkcs8_pem(LineEnding::LF);
        pem.map(|pem| pem.as_str().to_owned()).map_err(|error| UnusableKey(error.to_string()))
    }

    /// Returns the public half, 32 bytes.
    #[must_use]
    pub fn public(&self) -> [u8; 32] {
        self.0.verifying_key().to_bytes()
    }

    /// Names the key as that of a log.
    pub(crate) fn note_key(&self, origin: &str) -> NoteKey {
        NoteKey::new(origin, KeyKind::Ed25519, self.0.clone())
            .expect("an origin of an id, and a key that is not weak")
    }
}

impl std::fmt::Debug for AccessLogKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("AccessLogKey")
    }
}
