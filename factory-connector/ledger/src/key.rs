//! Key that signs the ledger: Ed25519, as a PKCS#8 document in PEM.

use ed25519_dalek::{
    Signature, Signer as _, SigningKey, Verifier as _, VerifyingKey,
    pkcs8::{DecodePrivateKey as _, EncodePrivateKey as _, spki::der::pem::LineEnding},
};

use super::Hash;

/// Fault of a text that is not an Ed25519 key in PKCS#8 PEM.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("this is no Ed25519 key in PEM: {0}")]
pub struct InvalidKey(String);

/// Signs heads, checkpoints, anchors and revocation receipts.
#[derive(Clone)]
pub struct LedgerKey(SigningKey);

impl LedgerKey {
    /// Derives a key from 32 random bytes.
    #[must_use]
    pub fn from_secret(secret: &[u8; 32]) -> Self {
        Self(SigningKey::from_bytes(secret))
    }

    /// Reads a key from its PEM text.
    ///
    /// # Errors
    /// [`InvalidKey`] when the text is not an Ed25519 key.
    pub fn from_pem(pem: &str) -> Result<Self, InvalidKey> {
        SigningKey::from_pkcs8_pem(pem).map(Self).map_err(|error| InvalidKey(error.to_string()))
    }

    /// Writes the key, its secret half included, as PEM.
    ///
    /// # Errors
    /// [`InvalidKey`] when the key cannot be encoded.
    pub fn to_pem(&self) -> Result<String, InvalidKey> {
        let pem = self.0.to_pkcs8_pem(LineEnding::LF);
        pem.map(|pem| pem.as_str().to_owned()).map_err(|error| InvalidKey(error.to_string()))
    }

    /// Returns the Ed25519 signature of the text's bytes; the same text gives the same one.
    #[must_use]
    pub fn sign(&self, text: &str) -> [u8; 64] {
        self.0.sign(text.as_bytes()).to_bytes()
    }

    /// Returns the Ed25519 signature of bytes that are no text of a ledger. Their beginning has to
    /// say so, since the key is the same.
    #[must_use]
    pub fn sign_bytes(&self, bytes: &[u8]) -> [u8; 64] {
        self.0.sign(bytes).to_bytes()
    }

    /// Returns the key of another form of signature.
    pub(super) fn signing_key(&self) -> SigningKey {
        self.0.clone()
    }

    /// Returns the public half, 32 bytes.
    #[must_use]
    pub fn public(&self) -> Hash {
        self.0.verifying_key().to_bytes()
    }
}

/// Returns whether the secret half of `public_key` made `signature` over `text`.
pub(super) fn is_signed(text: &str, signature: &[u8], public_key: &[u8]) -> bool {
    let key = public_key.try_into().ok().and_then(|bytes| VerifyingKey::from_bytes(bytes).ok());
    let signature = Signature::from_slice(signature).ok();
    key.zip(signature)
        .is_some_and(|(key, signature)| key.verify(text.as_bytes(), &signature).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_survives_its_text_and_signs() {
        let key = LedgerKey::from_secret(&[7; 32]);
        let again = LedgerKey::from_pem(&key.to_pem().expect("a text")).expect("the same key");
        let signature = key.sign("text");
        assert!(is_signed("text", &signature, &again.public()));
        assert!(!is_signed("test", &signature, &again.public()));
        assert!(LedgerKey::from_pem("rubbish").is_err());
    }
}
