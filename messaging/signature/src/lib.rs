//! Signature of a message that a factory's connector sends: a JSON Web Signature (RFC 7515) with the
//! body as its detached (appendix F), unencoded (RFC 7797) payload, by Ed25519 (RFC 8037).
//!
//! It travels as a property of the transport beside the body, which stays as it is:
//!
//! ```text
//! BASE64URL(protected header) .. BASE64URL(signature)
//! ```
//!
//! The signature covers `BASE64URL(protected header) || '.' || body`, the body byte by byte as it
//! travels. The protected header has, besides the members of the standards, what a receiver trusts
//! and the body may not say: factory, kind, id and lease of the message ([`SignedProperties`]). No
//! time is among them, since it could be finer than the time step of a policy. The content encoding
//! is not, either: no body is both gzip and JSON.
//!
//! The member `kid` is the public key itself, as the member `x` of its JWK (RFC 8037, section 2). So
//! a receiver that meets a key for the first time needs nothing else, and one that knows the key
//! compares it.

mod detached_jws;
mod public_key;

pub use detached_jws::{
    SIGNATURE_BYTES_MAX, SignatureError, SignedProperties, VerifiedMessage, sign, verify,
};
pub use public_key::{InvalidPublicKey, PublicKey};
