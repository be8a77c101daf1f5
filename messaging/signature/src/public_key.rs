//! Public half of a key that signs messages.

use std::{fmt, str::FromStr};

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use ed25519_dalek::VerifyingKey;

/// Fault of a text or bytes that are no Ed25519 public key, or a weak one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("this is no Ed25519 public key")]
pub struct InvalidPublicKey;

/// Ed25519 public key. Its text is the member `x` of its JWK (RFC 8037, section 2): the 32 bytes in
/// base64url without padding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PublicKey(VerifyingKey);

impl PublicKey {
    /// Reads a key from its 32 bytes.
    ///
    /// # Errors
    /// [`InvalidPublicKey`] for other bytes, and for points of small order, under which anybody signs.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, InvalidPublicKey> {
        let bytes = bytes.try_into().map_err(|_| InvalidPublicKey)?;
        let key = VerifyingKey::from_bytes(bytes).ok().filter(|key| !key.is_weak());
        key.map(Self).ok_or(InvalidPublicKey)
    }

    /// Returns the 32 bytes.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8; 32] {
        self.0.as_bytes()
    }

    /// Returns whether the secret half signed these bytes.
    pub(crate) fn has_signed(&self, bytes: &[u8], signature: &[u8; 64]) -> bool {
        // The strict way: verifiers disagree about the other signatures.
        self.0.verify_strict(bytes, &signature.into()).is_ok()
    }
}

impl fmt::Display for PublicKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&URL_SAFE_NO_PAD.encode(self.as_bytes()))
    }
}

impl FromStr for PublicKey {
    type Err = InvalidPublicKey;

    fn from_str(text: &str) -> Result<Self, InvalidPublicKey> {
        let bytes = URL_SAFE_NO_PAD.decode(text).map_err(|_| InvalidPublicKey)?;
        Self::from_bytes(&bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_read_from_its_text_and_from_nothing_else() {
        // RFC 8037, appendix A.2.
        let text = "11qYAYKxCrfVS_7TyWQHOg7hcvPapiMlrwIaaPcHURo";
        let key: PublicKey = text.parse().expect("the key of the standard");
        assert_eq!(key.to_string(), text);
        assert_eq!(key.to_string().parse(), Ok(key));
        let weak = URL_SAFE_NO_PAD.encode([0_u8; 32]);
        for other in ["", "AAAA", text.get(1..).expect("a rest"), &format!("{text}="), &weak] {
            assert_eq!(other.parse::<PublicKey>(), Err(InvalidPublicKey), "{other:?}");
        }
    }
}
