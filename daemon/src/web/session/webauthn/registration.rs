//! Registration of a passkey: options for the browser, and the check of what it brings.

use std::time::{Duration, SystemTime};

use serde_json::Value;
use webauthn_rp::{
    PublicKeyCredentialCreationOptions, Registration, RegistrationServerState,
    bin::{Decode as _, Encode as _},
    request::{
        TimedCeremony as _, UserVerificationRequirement,
        register::{
            PublicKeyCredentialUserEntity, RegistrationVerificationOptions, ResidentKeyRequirement,
            UserHandle16,
        },
    },
    response::Origin,
};

use super::{
    super::accounts::{StoredPasskey, USER_HANDLE_BYTES},
    CREDENTIAL_ID_BYTES_MAX, RelyingParty, WebauthnError, descriptor, options, origins, stored,
    timeout,
};

/// State of a registration that waits for its credential.
#[derive(Debug)]
pub(in super::super) struct RegistrationState {
    ceremony: RegistrationServerState<USER_HANDLE_BYTES>,
    user_handle: [u8; USER_HANDLE_BYTES],
}

/// Person as authenticators show and know it.
pub(in super::super) struct Registrant<'p> {
    pub user_name: &'p str,
    /// Name of the daemon.
    pub issuer: &'p str,
    pub user_handle: [u8; USER_HANDLE_BYTES],
    /// Passkeys that the person has; their authenticators make no second one.
    pub passkeys: &'p [StoredPasskey],
}

/// Names and time of a new passkey, stored beside its credential.
pub(in super::super) struct Naming {
    pub passkey_id: String,
    pub name: String,
    pub created_at: SystemTime,
}

/// Makes the options of `navigator.credentials.create` (`PublicKeyCredentialCreationOptionsJSON`); the
/// challenge comes with its state.
///
/// # Errors
/// [`WebauthnError::Options`] and [`WebauthnError::Stored`].
pub(in super::super) fn begin_registration(
    party: &RelyingParty,
    registrant: &Registrant<'_>,
    lifetime: Duration,
) -> Result<(u128, RegistrationState, Value), WebauthnError> {
    let Ok(handle) = UserHandle16::decode(registrant.user_handle);
    let excluded = registrant.passkeys.iter().map(descriptor).collect::<Result<_, _>>()?;
    let entity = PublicKeyCredentialUserEntity::from(&handle);
    let mut creation =
        PublicKeyCredentialCreationOptions::second_factor(party.id(), entity, excluded);
    creation.timeout = timeout(lifetime);
    // Phones and password managers make discoverable credentials only; small keys may do without.
    creation.authenticator_selection.resident_key = ResidentKeyRequirement::Preferred;
    creation.authenticator_selection.user_verification = UserVerificationRequirement::Preferred;
    creation.extensions.cred_props = None;
    let (ceremony, client) = creation.start_ceremony().map_err(options)?;
    let mut shown = serde_json::to_value(&client).map_err(options)?;
    // The library takes names of the PRECIS profiles alone; ours are older, and only shown.
    shown["rp"]["name"] = registrant.issuer.into();
    shown["user"]["name"] = registrant.user_name.into();
    shown["user"]["displayName"] = registrant.user_name.into();
    let challenge = ceremony.sent_challenge().0;
    let user_handle = registrant.user_handle;
    Ok((challenge, RegistrationState { ceremony, user_handle }, shown))
}

/// Credential that a browser brought, not yet checked.
pub(in super::super) struct Attestation(Registration);

impl Attestation {
    /// Reads a `RegistrationResponseJSON`, and the challenge that it answers.
    ///
    /// # Errors
    /// [`WebauthnError::Refused`].
    pub(in super::super) fn parse(credential: &Value) -> Result<(u128, Self), WebauthnError> {
        let json = credential.to_string();
        let read = Registration::from_json_relaxed(json.as_bytes()).map_err(refused)?;
        let challenge = read.challenge_relaxed().map_err(refused)?.0;
        Ok((challenge, Self(read)))
    }

    /// Checks the credential (WebAuthn Level 3, 7.1) and returns it for the store.
    ///
    /// # Errors
    /// [`WebauthnError::Refused`] and [`WebauthnError::LongId`].
    pub(in super::super) fn verify(
        &self,
        party: &RelyingParty,
        state: RegistrationState,
        naming: Naming,
    ) -> Result<StoredPasskey, WebauthnError> {
        let allowed_origins = origins(party);
        let wanted = RegistrationVerificationOptions::<Origin<'_>, Origin<'_>> {
            allowed_origins: &allowed_origins,
            // Some browsers and authenticators add some; 7.1, step 27, lets them.
            error_on_unsolicited_extensions: false,
            ..RegistrationVerificationOptions::default()
        };
        let credential = state.ceremony.verify(party.id(), &self.0, &wanted).map_err(refused)?;
        let id = credential.id().as_ref().to_vec();
        if id.len() > CREDENTIAL_ID_BYTES_MAX {
            return Err(WebauthnError::LongId);
        }
        Ok(StoredPasskey {
            passkey_id: naming.passkey_id,
            name: naming.name,
            credential_id: id,
            user_handle: state.user_handle,
            transports: credential.transports().encode().map_err(stored)?,
            static_state: credential.static_state().encode().map_err(stored)?,
            dynamic_state: credential.dynamic_state().encode().map_err(stored)?,
            created_at: naming.created_at,
            last_used_at: None,
        })
    }
}

fn refused(error: impl std::fmt::Display) -> WebauthnError {
    WebauthnError::Refused(error.to_string())
}
