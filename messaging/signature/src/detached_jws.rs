//! Form of the signature: detached, unencoded JWS with a protected header of our own.

use std::borrow::Cow;

use asi_model::{FactoryId, MessageId};
use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use serde::{Deserialize, Serialize};

use crate::public_key::PublicKey;

/// Longest signature that is read, in bytes; ours have about 400.
pub const SIGNATURE_BYTES_MAX: usize = 2048;

/// The algorithm of RFC 8037.
const ALGORITHM: &str = "EdDSA";
/// The extension of RFC 7797, which every verifier has to understand.
const UNENCODED: &str = "b64";

/// Properties of a message that are signed with its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignedProperties {
    /// The factory whose connector signed.
    pub factory_id: FactoryId,
    pub message_id: MessageId,
    /// Kind of the message, as `ua-data`; the same as in the body.
    pub subject: String,
    /// Number of the lease under which it was sent; none when it requests one.
    pub lease: Option<u64>,
}

/// A message whose signature holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerifiedMessage {
    /// The key that signed. Whose it is has to be known from elsewhere.
    pub key: PublicKey,
    pub properties: SignedProperties,
}

/// Fault of a signature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SignatureError {
    /// Longer than [`SIGNATURE_BYTES_MAX`].
    #[error("the signature is longer than {SIGNATURE_BYTES_MAX} bytes")]
    TooLong,
    /// Other than header, nothing and signature in base64url with dots in between.
    #[error("the signature is no JWS with a detached payload")]
    Form,
    /// The protected header lacks a member, has one twice, or one that does not fit.
    #[error("the protected header of the signature is not that of a signed message")]
    Header,
    /// Other than `EdDSA` over the unencoded payload.
    #[error("the signature is not of the form EdDSA with \"b64\": false")]
    Algorithm,
    /// `kid` is no Ed25519 key.
    #[error("the signature names no Ed25519 key")]
    Key,
    /// The key did not sign this header with this body.
    #[error("the signature is not one of its key over this message")]
    Mismatch,
}

/// Protected header. Members that are not listed are signed like the others and say nothing to us
/// (RFC 7515, section 4); a member that comes twice is a fault.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct ProtectedHeader<'h> {
    alg: Cow<'h, str>,
    b64: bool,
    crit: Vec<Cow<'h, str>>,
    kid: Cow<'h, str>,
    factory_id: Cow<'h, str>,
    message_id: Cow<'h, str>,
    subject: Cow<'h, str>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lease: Option<u64>,
}

/// Signs a body with its properties. `sign_bytes` is the Ed25519 signature by the secret half of
/// `key`.
///
/// The same key may sign other texts: what is signed here begins with the base64url text of a JSON
/// object, `eyJ`, and the first character after it that is not of base64url is a dot. A signed note
/// of a log begins with the log's name, where a slash comes first; the other texts of a ledger begin
/// with a word before a space, or with a brace.
pub fn sign(
    properties: &SignedProperties,
    key: &PublicKey,
    body: &[u8],
    sign_bytes: impl FnOnce(&[u8]) -> [u8; 64],
) -> String {
    let header = ProtectedHeader {
        alg: ALGORITHM.into(),
        b64: false,
        crit: vec![UNENCODED.into()],
        kid: key.to_string().into(),
        factory_id: properties.factory_id.as_str().into(),
        message_id: properties.message_id.as_str().into(),
        subject: properties.subject.as_str().into(),
        lease: properties.lease,
    };
    let header = serde_json::to_vec(&header).expect("a header has text keys only");
    let header = URL_SAFE_NO_PAD.encode(header);
    let signature = sign_bytes(&signing_input(&header, body));
    format!("{header}..{}", URL_SAFE_NO_PAD.encode(signature))
}

/// Verifies a signature over a body. Returns the key in it, which the caller has to know, and the
/// properties that were signed with the body.
///
/// # Errors
/// [`SignatureError`].
pub fn verify(text: &str, body: &[u8]) -> Result<VerifiedMessage, SignatureError> {
    if text.len() > SIGNATURE_BYTES_MAX {
        return Err(SignatureError::TooLong);
    }
    let (header_text, signature) = text.split_once("..").ok_or(SignatureError::Form)?;
    let decode = |text: &str| URL_SAFE_NO_PAD.decode(text).map_err(|_| SignatureError::Form);
    let signature = decode(signature)?.try_into().map_err(|_| SignatureError::Form)?;
    let header = decode(header_text)?;
    let header: ProtectedHeader<'_> =
        serde_json::from_slice(&header).map_err(|_| SignatureError::Header)?;
    // What `crit` lists besides is an extension that changes the meaning and that nobody here knows.
    if header.alg != ALGORITHM || header.b64 || header.crit != [UNENCODED] {
        return Err(SignatureError::Algorithm);
    }
    let key: PublicKey = header.kid.parse().map_err(|_| SignatureError::Key)?;
    if !key.has_signed(&signing_input(header_text, body), &signature) {
        return Err(SignatureError::Mismatch);
    }
    let properties = SignedProperties {
        factory_id: header.factory_id.parse().map_err(|_| SignatureError::Header)?,
        message_id: header.message_id.parse().map_err(|_| SignatureError::Header)?,
        subject: header.subject.into_owned(),
        lease: header.lease,
    };
    Ok(VerifiedMessage { key, properties })
}

/// Joins what is signed: RFC 7797, section 3, with `b64` false.
fn signing_input(header: &str, payload: &[u8]) -> Vec<u8> {
    [header.as_bytes(), b".", payload].concat()
}

#[cfg(test)]
mod tests;
