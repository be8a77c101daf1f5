//! Assertion by a passkey: options for the browser, and the check of what it brings.

use std::time::Duration;

use serde_json::Value;
use webauthn_rp::{
    AuthenticatedCredential, NonDiscoverableAuthentication16,
    NonDiscoverableAuthenticationServerState, NonDiscoverableCredentialRequestOptions,
    bin::{Decode as _, Encode as _},
    request::{
        Credentials as _, TimedCeremony as _, UserVerificationRequirement,
        auth::{AllowedCredentials, AuthenticationVerificationOptions},
        register::UserHandle16,
    },
    response::{
        CredentialId, Origin,
        auth::error::AuthCeremonyErr,
        register::{DynamicState, StaticState},
    },
};

use super::{
    super::accounts::{DYNAMIC_STATE_BYTES, StoredPasskey},
    RelyingParty, WebauthnError, descriptor, options, origins, stored, timeout,
};

/// State of an assertion that is waited for.
#[derive(Debug)]
pub(in super::super) struct AssertionState(NonDiscoverableAuthenticationServerState);

/// Makes the options of `navigator.credentials.get` (`PublicKeyCredentialRequestOptionsJSON`) for these
/// passkeys; the challenge comes with its state.
///
/// # Errors
/// [`WebauthnError::Options`], as without a passkey, and [`WebauthnError::Stored`].
pub(in super::super) fn begin_assertion(
    party: &RelyingParty,
    passkeys: &[StoredPasskey],
    lifetime: Duration,
) -> Result<(u128, AssertionState, Value), WebauthnError> {
    let mut allowed = AllowedCredentials::with_capacity(passkeys.len());
    for passkey in passkeys {
        allowed.push(descriptor(passkey)?.into());
    }
    let mut request = NonDiscoverableCredentialRequestOptions::second_factor(party.id(), allowed)
        .map_err(options)?;
    request.options().timeout = timeout(lifetime);
    request.options().user_verification = UserVerificationRequirement::Preferred;
    let (ceremony, client) = request.start_ceremony().map_err(options)?;
    let shown = serde_json::to_value(&client).map_err(options)?;
    Ok((ceremony.sent_challenge().0, AssertionState(ceremony), shown))
}

/// Assertion that a browser brought, not yet checked.
pub(in super::super) struct Assertion(NonDiscoverableAuthentication16);

impl Assertion {
    /// Reads an `AuthenticationResponseJSON`, and the challenge that it answers.
    ///
    /// # Errors
    /// [`WebauthnError::Refused`].
    pub(in super::super) fn parse(credential: &str) -> Result<(u128, Self), WebauthnError> {
        let read = NonDiscoverableAuthentication16::from_json_relaxed(credential.as_bytes())
            .map_err(refused)?;
        let challenge = read.challenge_relaxed().map_err(refused)?.0;
        Ok((challenge, Self(read)))
    }

    /// Returns the id of the credential that signed.
    pub(in super::super) fn credential_id(&self) -> Vec<u8> {
        self.0.raw_id().as_ref().to_vec()
    }

    /// Checks the assertion (WebAuthn Level 3, 7.2) by the stored passkey; returns its new state.
    ///
    /// # Errors
    /// [`WebauthnError::Refused`], [`WebauthnError::Counter`] and [`WebauthnError::Stored`].
    pub(in super::super) fn verify(
        &self,
        party: &RelyingParty,
        state: AssertionState,
        passkey: &StoredPasskey,
    ) -> Result<[u8; DYNAMIC_STATE_BYTES], WebauthnError> {
        let id = CredentialId::<&[u8]>::decode(&passkey.credential_id).map_err(stored)?;
        let Ok(handle) = UserHandle16::decode(passkey.user_handle);
        let fixed = StaticState::decode(&passkey.static_state).map_err(stored)?;
        let changing = DynamicState::decode(passkey.dynamic_state).map_err(stored)?;
        let mut credential =
            AuthenticatedCredential::new(id, &handle, fixed, changing).map_err(stored)?;
        let allowed_origins = origins(party);
        let wanted = AuthenticationVerificationOptions::<Origin<'_>, Origin<'_>> {
            allowed_origins: &allowed_origins,
            error_on_unsolicited_extensions: false,
            ..AuthenticationVerificationOptions::default()
        };
        state.0.verify(party.id(), &self.0, &mut credential, &wanted).map_err(
            |error| match error {
                AuthCeremonyErr::SignatureCounter => WebauthnError::Counter,
                other => refused(other),
            },
        )?;
        credential.dynamic_state().encode().map_err(stored)
    }
}

fn refused(error: impl std::fmt::Display) -> WebauthnError {
    WebauthnError::Refused(error.to_string())
}
