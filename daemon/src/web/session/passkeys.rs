//! Passkeys of a user: registration, use at a sign-in, and removal.

use std::time::Instant;

use rand::RngCore as _;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use time::OffsetDateTime;
use utoipa::ToSchema;

use super::{
    accounts::{
        AccountChange, Accounts, PASSKEYS_MAX, PasskeyUse, SessionId, StoredPasskey,
        USER_HANDLE_BYTES,
    },
    credentials::{Caller, PasskeyAssertion},
    second_factor::{RecoveryCodes, new_recovery_codes, wrong},
    sessions::{Sessions, internal, now, random_token},
    webauthn::{
        Assertion, Attestation, Naming, Registrant, RelyingParty, WebauthnError, begin_assertion,
        begin_registration,
    },
};
use crate::{Confidential, web::problem::Problem};

/// Longest name of a passkey in characters.
const NAME_CHARS_MAX: usize = 64;

/// Password that a new passkey takes.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct PasskeyBegin {
    #[schema(value_type = String, format = Password)]
    pub password: Confidential<String>,
}

/// Options with which a browser makes a passkey.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PasskeyOffer {
    /// Options of `navigator.credentials.create`: `PublicKeyCredentialCreationOptionsJSON` of WebAuthn Level 3.
    /// Their challenge is good once, for two minutes.
    #[schema(value_type = Object)]
    pub options: Value,
}

/// New passkey from a browser.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct NewPasskey {
    /// Name by which its owner knows it, at most 64 characters.
    pub name: String,
    /// Credential that the browser made: `RegistrationResponseJSON` of WebAuthn Level 3.
    #[schema(value_type = Object)]
    pub credential: Value,
}

impl NewPasskey {
    /// Reads name, challenge and credential.
    fn read(&self) -> Result<(&str, u128, Attestation), Problem> {
        let name = self.name.trim();
        let chars = name.chars().count();
        if chars == 0 || chars > NAME_CHARS_MAX || name.chars().any(char::is_control) {
            let message = format!("A name has 1 to {NAME_CHARS_MAX} characters.");
            return Err(wrong("/name", "NAME_REFUSED", &message));
        }
        let (challenge, attestation) = Attestation::parse(&self.credential).map_err(refused)?;
        Ok((name, challenge, attestation))
    }

    /// Judges the form, before it is known whose passkey it is and for which challenge.
    ///
    /// # Errors
    /// A [`Problem`]: 422 for a name or a credential that is refused.
    pub fn check_form(&self) -> Result<(), Problem> {
        self.read().map(drop)
    }
}

/// Password with which a passkey is removed.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct PasskeyRemoval {
    #[schema(value_type = String, format = Password)]
    pub password: Confidential<String>,
}

/// Passkeys of a person, the oldest first.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PasskeyList {
    pub items: Vec<PasskeySummary>,
    /// Reason why browsers make no passkeys for these pages, for people; absent where they do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unavailable: Option<String>,
}

/// A passkey, shown to its owner.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PasskeySummary {
    /// Name by which the passkey is removed.
    pub passkey_id: String,
    /// Name that its owner gave.
    pub name: String,
    #[serde(with = "time::serde::rfc3339")]
    #[schema(value_type = String, format = DateTime)]
    pub created_at: OffsetDateTime,
    /// Last sign-in with it.
    #[serde(with = "time::serde::rfc3339::option", skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>, format = DateTime)]
    pub last_used_at: Option<OffsetDateTime>,
}

impl From<StoredPasskey> for PasskeySummary {
    fn from(passkey: StoredPasskey) -> Self {
        Self {
            passkey_id: passkey.passkey_id,
            name: passkey.name,
            created_at: passkey.created_at.into(),
            last_used_at: passkey.last_used_at.map(Into::into),
        }
    }
}

/// Passkeys of one user.
pub struct OwnPasskeys<'s, A: Accounts> {
    sessions: &'s Sessions<A>,
    user_name: &'s str,
}

impl<'s, A: Accounts> OwnPasskeys<'s, A> {
    /// Returns those of a user who signs in or is signed in.
    #[must_use]
    pub const fn of(sessions: &'s Sessions<A>, user_name: &'s str) -> Self {
        Self { sessions, user_name }
    }

    /// Lists them.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn list(&self) -> Result<PasskeyList, Problem> {
        let passkeys = self.stored().await?;
        Ok(PasskeyList {
            items: passkeys.into_iter().map(Into::into).collect(),
            unavailable: self
                .sessions
                .config()
                .relying_party
                .as_ref()
                .err()
                .map(|why| format!("{why}.")),
        })
    }

    /// Makes the options with which a browser makes a passkey.
    ///
    /// # Errors
    /// A [`Problem`]: 403 where the sign-in of a user with a second factor is not recent, 409 where passkeys are
    /// unavailable or the user has as many as there may be, 422 for a wrong password, and those of a sign-in.
    pub async fn begin(
        &self,
        caller: &Caller,
        session: &SessionId,
        body: PasskeyBegin,
    ) -> Result<PasskeyOffer, Problem> {
        let party = self.relying_party()?;
        self.sessions.check_recent(self.user_name, session).await?;
        self.sessions.check_password(caller, self.user_name, body.password).await?;
        let (passkeys, config) = (self.stored().await?, self.sessions.config());
        if passkeys.len() >= PASSKEYS_MAX {
            let detail = format!("There are {PASSKEYS_MAX} passkeys. Remove one first.");
            return Err(Problem::conflict("TOO_MANY_PASSKEYS", detail));
        }
        let registrant = Registrant {
            user_name: self.user_name,
            issuer: &config.issuer,
            user_handle: passkeys.first().map_or_else(new_user_handle, |first| first.user_handle),
            passkeys: &passkeys,
        };
        let (challenge, state, options) =
            begin_registration(party, &registrant, config.challenge_lifetime)
                .map_err(|error| Problem::internal(&error))?;
        let mut open = self.sessions.registrations().lock();
        open.put(self.user_name, challenge, state, Instant::now());
        Ok(PasskeyOffer { options })
    }

    /// Adds a passkey that a browser made. The first second factor of a user comes with recovery codes.
    ///
    /// # Errors
    /// A [`Problem`]: 409 where passkeys are unavailable or this one is known, 422 for a name or a credential
    /// that is refused, as one for another challenge.
    pub async fn add(&self, body: &NewPasskey) -> Result<RecoveryCodes, Problem> {
        let party = self.relying_party()?;
        let (name, challenge, attestation) = body.read()?;
        let open = self.sessions.registrations();
        let state = open.lock().take(self.user_name, challenge, Instant::now());
        let state = state.ok_or_else(|| refused(WebauthnError::NoChallenge))?;
        let naming =
            Naming { passkey_id: random_token(), name: name.to_owned(), created_at: now() };
        let passkey = attestation.verify(party, state, naming).map_err(refused)?;

        let factors = self.sessions.second_factors(self.user_name).await?;
        let new_codes = factors.lacks_recovery_codes().then(new_recovery_codes);
        let digests = new_codes.as_ref().map(|codes| codes.digests.as_slice());
        let change = AccountChange { by: self.user_name, operation: "addPasskey" };
        let accounts = self.sessions.accounts();
        let added = accounts.add_passkey(self.user_name, &passkey, digests, change);
        if !added.await.map_err(internal)? {
            let detail = "This passkey is there already, or there are too many.";
            return Err(Problem::conflict("PASSKEY_KNOWN", detail));
        }
        tracing::info!(user.name = self.user_name, "A passkey was added.");
        let recovery_codes = new_codes.map(|codes| codes.codes).unwrap_or_default();
        Ok(RecoveryCodes { recovery_codes })
    }

    /// Removes one.
    ///
    /// # Errors
    /// A [`Problem`]: 403 where the sign-in is not recent, 404 where the user has no such passkey, 422 for a wrong
    /// password, and those of a sign-in.
    pub async fn remove(
        &self,
        caller: &Caller,
        session: &SessionId,
        passkey_id: &str,
        body: PasskeyRemoval,
    ) -> Result<(), Problem> {
        self.sessions.check_recent(self.user_name, session).await?;
        self.sessions.check_password(caller, self.user_name, body.password).await?;
        let change = AccountChange { by: self.user_name, operation: "removePasskey" };
        let accounts = self.sessions.accounts();
        let removed = accounts.delete_passkey(self.user_name, passkey_id, change);
        if !removed.await.map_err(internal)? {
            return Err(Problem::not_found("such passkey"));
        }
        tracing::info!(user.name = self.user_name, "A passkey was removed.");
        Ok(())
    }

    /// Makes the options with which a browser signs in by one of these passkeys; `None` where browsers
    /// cannot use them here.
    pub(super) fn options(&self, passkeys: &[StoredPasskey]) -> Result<Option<Value>, Problem> {
        let Ok(party) = self.relying_party() else { return Ok(None) };
        let begun = begin_assertion(party, passkeys, self.sessions.config().challenge_lifetime);
        let (challenge, state, options) = begun.map_err(|error| Problem::internal(&error))?;
        let mut open = self.sessions.assertions().lock();
        open.put(self.user_name, challenge, state, Instant::now());
        Ok(Some(options))
    }

    /// Returns true if an assertion is by one of them for a challenge that is open, and uses the challenge
    /// up.
    pub(super) async fn is_right(&self, sent: &PasskeyAssertion) -> Result<bool, Problem> {
        let Ok(party) = self.relying_party() else { return Ok(false) };
        let Ok((challenge, assertion)) = Assertion::parse(&sent.json()) else { return Ok(false) };
        let open = self.sessions.assertions();
        let state = open.lock().take(self.user_name, challenge, Instant::now());
        let Some(state) = state else { return Ok(false) };
        let passkeys = self.stored().await?;
        let id = assertion.credential_id();
        let Some(passkey) = passkeys.iter().find(|passkey| passkey.credential_id == id) else {
            return Ok(false);
        };
        let dynamic_state = match assertion.verify(party, state, passkey) {
            Ok(state) => state,
            Err(error) => {
                report(&error, self.user_name, passkey);
                return Ok(false);
            }
        };
        let used = PasskeyUse {
            passkey_id: passkey.passkey_id.clone(),
            former_state: passkey.dynamic_state,
            dynamic_state,
            at: now(),
        };
        // The store decides: of two uses at once with the same counter one is refused.
        self.sessions.accounts().use_passkey(self.user_name, &used).await.map_err(internal)
    }

    async fn stored(&self) -> Result<Vec<StoredPasskey>, Problem> {
        self.sessions.accounts().passkeys(self.user_name).await.map_err(internal)
    }

    fn relying_party(&self) -> Result<&'s RelyingParty, Problem> {
        self.sessions.config().relying_party.as_ref().map_err(|why| {
            Problem::conflict("PASSKEYS_UNAVAILABLE", format!("Passkeys are unavailable: {why}."))
        })
    }
}

/// Logs why an assertion was refused. What the authenticator sent is not logged.
fn report(error: &WebauthnError, user_name: &str, passkey: &StoredPasskey) {
    if matches!(error, WebauthnError::Counter) {
        tracing::warn!(
            user.name = user_name,
            passkey.id = passkey.passkey_id,
            "A passkey was refused: its counter went back. There is a copy of its key, or the authenticator was reset."
        );
        return;
    }
    tracing::warn!(
        user.name = user_name,
        passkey.id = passkey.passkey_id,
        error = error as &dyn std::error::Error,
        "A passkey was refused."
    );
}

/// Returns the problem of a credential that does not fit; the log says why.
fn refused(error: WebauthnError) -> Problem {
    tracing::warn!(
        error = &error as &dyn std::error::Error,
        "A new passkey was refused: it is for another address of the pages, or its challenge is over."
    );
    let message = "The passkey was not accepted. Begin again, at the address of the pages.";
    wrong("/credential", "PASSKEY_REFUSED", message)
}

fn new_user_handle() -> [u8; USER_HANDLE_BYTES] {
    let mut handle = [0; USER_HANDLE_BYTES];
    rand::rng().fill_bytes(&mut handle);
    handle
}
