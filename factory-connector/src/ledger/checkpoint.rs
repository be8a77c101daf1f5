//! Signed statements of all heads, so that not even the newest entries can be cut off unnoticed.

use std::{io, path::Path};

use asi_model::{DateTime, FactoryId, OrganisationId};
use ed25519_dalek::{
    Signature, Signer, SigningKey, Verifier as _, VerifyingKey,
    pkcs8::{DecodePrivateKey, EncodePrivateKey, spki::der::pem::LineEnding},
};
use serde::{Deserialize, Serialize};

use super::{Hash, Heads};

/// Where the key lies in the data directory.
pub const LEDGER_KEY_FILE: &str = "ledger-key.pem";

/// What a checkpoint states.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Checkpoint {
    /// Whose ledger.
    pub factory_id: FactoryId,
    /// Its place, from 1 without gaps.
    pub number: u64,
    /// When.
    pub recorded_at: DateTime,
    /// The heads of all chains.
    pub heads: Vec<CheckpointHead>,
}

/// The head of one chain.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CheckpointHead {
    /// Whose chain.
    #[schema(value_type = String)]
    pub recipient: OrganisationId,
    /// The number of its last entry.
    pub number: u64,
    /// The hash of its last entry, hexadecimal.
    pub hash: String,
}

impl Checkpoint {
    /// A checkpoint over the heads as they stand.
    #[must_use]
    pub fn new(factory_id: FactoryId, number: u64, recorded_at: DateTime, heads: &Heads) -> Self {
        let heads = heads.iter().map(|(recipient, head)| CheckpointHead {
            recipient: recipient.clone(),
            number: head.number,
            hash: hex::encode(head.hash),
        });
        Self { factory_id, number, recorded_at, heads: heads.collect() }
    }

    /// The text that is signed and stored.
    #[must_use]
    pub fn canonical(&self) -> String {
        serde_json::to_string(self).expect("a checkpoint has text keys only")
    }
}

/// Why the ledger's key cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("cannot use the ledger's key {path}")]
pub struct LedgerKeyError {
    /// The file.
    path: String,
    #[source]
    source: io::Error,
}

/// The key that signs checkpoints (Ed25519). It lies in a file of its own, apart from what it
/// vouches for.
#[derive(Clone)]
pub struct LedgerKey(SigningKey);

impl LedgerKey {
    /// Reads the key, or makes one at the first start.
    ///
    /// # Errors
    /// [`LedgerKeyError`] when the file cannot be read, is no key, or cannot be written.
    pub fn open(path: &Path) -> Result<Self, LedgerKeyError> {
        let fail = |source| LedgerKeyError { path: path.display().to_string(), source };
        match std::fs::read_to_string(path) {
            Ok(pem) => SigningKey::from_pkcs8_pem(&pem).map(Self).map_err(|error| {
                fail(io::Error::new(io::ErrorKind::InvalidData, error.to_string()))
            }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let key = SigningKey::from_bytes(&rand::random());
                let pem = key.to_pkcs8_pem(LineEnding::LF).map_err(|error| {
                    fail(io::Error::new(io::ErrorKind::InvalidData, error.to_string()))
                })?;
                write_private(path, pem.as_bytes()).map_err(fail)?;
                Ok(Self(key))
            }
            Err(error) => Err(fail(error)),
        }
    }

    /// The public half of the key in a file; none where there is no such file.
    ///
    /// # Errors
    /// [`LedgerKeyError`] when the file cannot be read or is no key.
    pub fn public_of(path: &Path) -> Result<Option<Hash>, LedgerKeyError> {
        match path.try_exists() {
            Ok(true) => Self::open(path).map(|key| Some(key.public())),
            Ok(false) => Ok(None),
            Err(source) => Err(LedgerKeyError { path: path.display().to_string(), source }),
        }
    }

    /// Signs a text.
    #[must_use]
    pub fn sign(&self, text: &str) -> [u8; 64] {
        self.0.sign(text.as_bytes()).to_bytes()
    }

    /// The public half.
    #[must_use]
    pub fn public(&self) -> [u8; 32] {
        self.0.verifying_key().to_bytes()
    }
}

/// Whether a signature over a text was made with the secret half of a public key.
pub(super) fn is_signed(text: &str, signature: &[u8], public_key: &[u8]) -> bool {
    let key = public_key.try_into().ok().and_then(|bytes| VerifyingKey::from_bytes(bytes).ok());
    let signature = Signature::from_slice(signature).ok();
    key.zip(signature)
        .is_some_and(|(key, signature)| key.verify(text.as_bytes(), &signature).is_ok())
}

/// Writes a file that only its owner may read.
fn write_private(path: &Path, content: &[u8]) -> io::Result<()> {
    use std::io::Write as _;
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(0o600);
    }
    let mut file = options.open(path)?;
    file.write_all(content)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_stays_and_signs() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("ledger.key");
        let key = LedgerKey::open(&path).expect("a new key");
        let again = LedgerKey::open(&path).expect("the same key");
        let signature = key.sign("text");
        assert!(is_signed("text", &signature, &again.public()));
        assert!(!is_signed("test", &signature, &again.public()));
        std::fs::write(&path, "rubbish").expect("written");
        assert!(LedgerKey::open(&path).is_err());
    }
}
