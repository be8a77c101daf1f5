//! Passkeys by Web Authentication Level 3: registration (7.1) and assertion (7.2). Nothing else of the daemon
//! names the library.
//!
//! Attestation is not asked for: any authenticator is taken. A passkey is a factor beside the password, so
//! that user verification is preferred and not required.

mod assertion;
mod challenges;
mod registration;
mod relying_party;

use std::{num::NonZeroU32, time::Duration};

use webauthn_rp::{
    bin::Decode as _,
    request::PublicKeyCredentialDescriptor,
    response::{AuthTransports, CredentialId, Origin},
};

pub(super) use assertion::{Assertion, AssertionState, begin_assertion};
pub(super) use challenges::OpenChallenges;
pub(super) use registration::{
    Attestation, Naming, Registrant, RegistrationState, begin_registration,
};
pub use relying_party::{PasskeysUnavailable, RelyingParty};

use super::accounts::StoredPasskey;

/// Longest id of a credential, in bytes. An assertion has it twice and has to fit into the body of a sign-in.
const CREDENTIAL_ID_BYTES_MAX: usize = 512;

/// Failure of a registration or an assertion.
#[derive(Debug, thiserror::Error)]
pub enum WebauthnError {
    #[error("options could not be made")]
    Options(#[source] Box<dyn std::error::Error + Send + Sync>),
    #[error("the stored passkey cannot be read")]
    Stored(#[source] Box<dyn std::error::Error + Send + Sync>),
    #[error("the answer of the authenticator was refused: {0}")]
    Refused(String),
    /// The counter of the authenticator is not above the stored one: there is a copy of the key.
    #[error("the counter of the authenticator went back")]
    Counter,
    /// Challenge of another user, or one that was used or has expired.
    #[error("there is no such challenge")]
    NoChallenge,
    #[error("the id of the credential has more than {CREDENTIAL_ID_BYTES_MAX} bytes")]
    LongId,
}

/// Returns the lifetime of a challenge as browsers take it.
fn timeout(lifetime: Duration) -> NonZeroU32 {
    let millis = u32::try_from(lifetime.as_millis()).unwrap_or(u32::MAX);
    NonZeroU32::new(millis).unwrap_or(NonZeroU32::MIN)
}

/// Returns the origins of pages that may use a passkey: one.
fn origins(party: &RelyingParty) -> [Origin<'_>; 1] {
    [Origin(party.origin().into())]
}

/// Names a stored passkey to a browser.
fn descriptor(
    passkey: &StoredPasskey,
) -> Result<PublicKeyCredentialDescriptor<Vec<u8>>, WebauthnError> {
    Ok(PublicKeyCredentialDescriptor {
        id: CredentialId::<Vec<u8>>::decode(passkey.credential_id.clone()).map_err(stored)?,
        transports: AuthTransports::decode(passkey.transports).map_err(stored)?,
    })
}

fn stored(error: impl std::error::Error + Send + Sync + 'static) -> WebauthnError {
    WebauthnError::Stored(Box::new(error))
}

fn options(error: impl std::error::Error + Send + Sync + 'static) -> WebauthnError {
    WebauthnError::Options(Box::new(error))
}

#[cfg(test)]
mod tests;
