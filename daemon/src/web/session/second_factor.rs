//! Second factor of a user: codes by time from an authenticator app, and recovery codes in place of each
//! kind. [`super::passkeys`] has the other kind.
//!
//! A code is good once: of each user the newest time step that was used is stored. The secret is shown
//! when it is made and never again.

mod enrolment;
mod totp;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    accounts::{AccountChange, Accounts, StoredPasskey, StoredSecondFactor, second_factor_purpose},
    credentials::Caller,
    sessions::{Sessions, SignedIn, internal, now},
};
use crate::{
    Confidential,
    sealing::SealingError,
    web::problem::{Problem, ProblemFault},
};

/// Longest code that is looked at, in bytes: a recovery code with blanks.
const CODE_BYTES_MAX: usize = 64;
/// Digits of a code by time.
pub(super) const CODE_DIGITS: usize = 6;

/// State of a user's second factor.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SecondFactorState {
    /// True if codes of an authenticator app are on. Passkeys are listed by themselves.
    pub is_on: bool,
    /// Recovery codes that are left, for codes of an app and passkeys alike.
    pub recovery_codes_left: usize,
}

/// Password that a change of the second factor takes.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SecondFactorBegin {
    #[schema(value_type = String, format = Password)]
    pub password: Confidential<String>,
}

/// New secret for an authenticator app, shown this once.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SecondFactorOffer {
    /// The secret in base 32, to type.
    pub secret: String,
    /// URI `otpauth://...` of the secret, for the app.
    pub uri: String,
    /// SVG image of a QR code with the URI.
    pub qr_code: String,
}

/// A code from the authenticator app.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SecondFactorCode {
    #[schema(value_type = String)]
    pub code: Confidential<String>,
}

/// Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
/// codes of before, which stay good.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct RecoveryCodes {
    pub recovery_codes: Vec<String>,
}

/// Password and code with which a second factor is removed.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SecondFactorRemoval {
    #[schema(value_type = String, format = Password)]
    pub password: Confidential<String>,
    /// A code from the app, or a recovery code.
    #[schema(value_type = String)]
    pub code: Confidential<String>,
}

/// Second factors of a user that are on.
pub(super) struct ActiveFactors {
    /// True if codes of an authenticator app are.
    pub has_codes: bool,
    pub passkeys: Vec<StoredPasskey>,
    /// Digests of recovery codes, good in place of each.
    recovery_digests: Vec<String>,
}

impl ActiveFactors {
    pub(super) const fn is_any(&self) -> bool {
        self.has_codes || !self.passkeys.is_empty()
    }

    /// Returns true where recovery codes are to be made: there is no other second factor, or all are used up.
    pub(super) const fn lacks_recovery_codes(&self) -> bool {
        !self.is_any() || self.recovery_digests.is_empty()
    }
}

/// New recovery codes, and the digests by which they are stored.
pub(super) struct NewRecoveryCodes {
    pub codes: Vec<String>,
    pub digests: Vec<String>,
}

/// Makes recovery codes.
pub(super) fn new_recovery_codes() -> NewRecoveryCodes {
    let codes = enrolment::new_recovery_codes();
    let digests = codes.iter().map(|code| enrolment::recovery_digest(code)).collect();
    NewRecoveryCodes { codes, digests }
}

impl<A: Accounts> Sessions<A> {
    /// Returns the state of a user's second factor.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn second_factor_state(&self, user_name: &str) -> Result<SecondFactorState, Problem> {
        let factors = self.second_factors(user_name).await?;
        let recovery_codes_left = if factors.is_any() { factors.recovery_digests.len() } else { 0 };
        Ok(SecondFactorState { is_on: factors.has_codes, recovery_codes_left })
    }

    /// Returns the second factors of a user that are on.
    pub(super) async fn second_factors(&self, user_name: &str) -> Result<ActiveFactors, Problem> {
        let codes = self.accounts().second_factor(user_name).await.map_err(internal)?;
        let codes = codes.unwrap_or_default();
        Ok(ActiveFactors {
            has_codes: codes.is_confirmed,
            passkeys: self.accounts().passkeys(user_name).await.map_err(internal)?,
            recovery_digests: codes.recovery_digests,
        })
    }

    /// Makes a secret, which counts once it is confirmed.
    ///
    /// # Errors
    /// A [`Problem`]: 403 where the sign-in of a user with passkeys is not recent, 409 where a second factor is on,
    /// 422 for a wrong password, 503 without a key to seal with, and those of a sign-in.
    pub async fn begin_second_factor(
        &self,
        caller: &Caller,
        user: &SignedIn<A::Principal>,
        body: SecondFactorBegin,
    ) -> Result<SecondFactorOffer, Problem> {
        self.check_recent(&user.user_name, &user.session).await?;
        self.check_password(caller, &user.user_name, body.password).await?;
        let factors = self.keep_confirmed(&user.user_name).await?;
        let secret = enrolment::new_secret();
        let purpose = second_factor_purpose(&user.user_name);
        let sealed = self.sealer().seal(&purpose, &hex::encode(&secret)).map_err(not_sealed)?;
        let factor = StoredSecondFactor {
            sealed_secret: Some(sealed),
            is_confirmed: false,
            last_step: 0,
            recovery_digests: factors.recovery_digests,
        };
        self.put_codes(&user.user_name, &factor, "beginSecondFactor").await?;
        let uri = enrolment::uri(&self.config().issuer, &user.user_name, &secret);
        let qr_code = enrolment::qr_code(&uri).unwrap_or_default();
        Ok(SecondFactorOffer { secret: totp::base32(&secret), uri, qr_code })
    }

    /// Turns the second factor on with a code of the new secret.
    ///
    /// # Errors
    /// A [`Problem`]: 409 where none was begun or one is on, 422 for a wrong code.
    pub async fn confirm_second_factor(
        &self,
        user: &SignedIn<A::Principal>,
        body: &SecondFactorCode,
    ) -> Result<RecoveryCodes, Problem> {
        let factors = self.keep_confirmed(&user.user_name).await?;
        let begun = self.accounts().second_factor(&user.user_name).await.map_err(internal)?;
        // Recovery codes of passkeys are there without a secret.
        let Some(begun) = begun.filter(|begun| begun.sealed_secret.is_some()) else {
            return Err(Problem::conflict("NOT_BEGUN", "Make a secret first, then confirm it."));
        };
        let code = digits(body.code.expose());
        let secret = self.opened(&user.user_name, &begun)?;
        let Some(last_step) = totp::step_of(secret.expose(), &code, now()) else {
            return Err(wrong(
                "/code",
                "WRONG_CODE",
                "The code is wrong. Is the phone's time right?",
            ));
        };
        let mut factor = StoredSecondFactor { is_confirmed: true, last_step, ..begun };
        let mut recovery_codes = Vec::new();
        if factors.lacks_recovery_codes() {
            let new = new_recovery_codes();
            (recovery_codes, factor.recovery_digests) = (new.codes, new.digests);
        }
        self.put_codes(&user.user_name, &factor, "confirmSecondFactor").await?;
        tracing::info!(user.name = user.user_name, "A second factor was turned on.");
        Ok(RecoveryCodes { recovery_codes })
    }

    /// Turns codes of the app off, with password and code. Passkeys stay, and with them recovery codes.
    ///
    /// # Errors
    /// A [`Problem`]: 404 where none is on, 422 for a wrong password or code, and those of a sign-in.
    pub async fn remove_second_factor(
        &self,
        caller: &Caller,
        user: &SignedIn<A::Principal>,
        body: SecondFactorRemoval,
    ) -> Result<(), Problem> {
        if !self.second_factors(&user.user_name).await?.has_codes {
            return Err(Problem::not_found("second factor"));
        }
        let open = self.gate().enter(caller.address, &user.user_name).await?;
        let is_password = self.is_password(&user.user_name, body.password);
        let is_right = match open.unless_displaced(is_password).await {
            Ok(true) => self.is_code(&user.user_name, &body.code).await,
            other => other,
        };
        match is_right {
            Ok(true) => open.succeeded(),
            Ok(false) => {
                return Err(wrong("/code", "WRONG_CODE", "The password or the code is wrong."));
            }
            Err(problem) => {
                open.withdrawn();
                return Err(problem);
            }
        }
        // Read again: the code may have been a recovery code, which is used up now.
        let factors = self.second_factors(&user.user_name).await?;
        if !factors.passkeys.is_empty() {
            let recovery_digests = factors.recovery_digests;
            let codes = StoredSecondFactor { recovery_digests, ..StoredSecondFactor::default() };
            return self.put_codes(&user.user_name, &codes, "removeSecondFactor").await;
        }
        let change = AccountChange { by: &user.user_name, operation: "removeSecondFactor" };
        self.reset_second_factor(&user.user_name, change).await?;
        Ok(())
    }

    /// Removes all of the second factor of a user who cannot, passkeys included; false where there is none.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn reset_second_factor(
        &self,
        user_name: &str,
        change: AccountChange<'_>,
    ) -> Result<bool, Problem> {
        let removal = self.accounts().delete_second_factor(user_name, change);
        let is_removed = removal.await.map_err(internal)?;
        if is_removed {
            tracing::info!(user.name = user_name, "A second factor was removed.");
        }
        Ok(is_removed)
    }

    /// Returns true if a code is the user's, from the app or for recovery, and uses it up.
    pub(super) async fn is_code(
        &self,
        user_name: &str,
        code: &Confidential<String>,
    ) -> Result<bool, Problem> {
        let code = code.expose();
        if code.len() > CODE_BYTES_MAX {
            return Ok(false);
        }
        let factor = self.accounts().second_factor(user_name).await.map_err(internal)?;
        let Some(factor) = factor else { return Ok(false) };
        let digits = digits(code);
        if digits.len() != CODE_DIGITS {
            let digest = enrolment::recovery_digest(code);
            return self.accounts().use_recovery_code(user_name, &digest).await.map_err(internal);
        }
        if !factor.is_confirmed {
            return Ok(false);
        }
        let secret = self.opened(user_name, &factor)?;
        let Some(step) = totp::step_of(secret.expose(), &digits, now()) else { return Ok(false) };
        // The store decides: of two requests with the same code one is refused.
        self.accounts().use_time_step(user_name, step).await.map_err(internal)
    }

    /// Opens the secret of a user's second factor. Without its key no code is right: a recovery code is,
    /// or an administrator takes the second factor away.
    fn opened(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
    ) -> Result<Confidential<Vec<u8>>, Problem> {
        let sealed = factor.sealed_secret.as_deref().unwrap_or_default();
        let opened = self.sealer().open(&second_factor_purpose(user_name), sealed);
        let secret = opened.map_err(not_sealed)?;
        let bytes = hex::decode(secret.expose().as_bytes()).ok();
        bytes.map(Into::into).ok_or_else(|| not_sealed(SealingError::Unreadable))
    }

    async fn keep_confirmed(&self, user_name: &str) -> Result<ActiveFactors, Problem> {
        let factors = self.second_factors(user_name).await?;
        if factors.has_codes {
            let detail = "A second factor is on. Turn it off first.";
            return Err(Problem::conflict("SECOND_FACTOR_ON", detail));
        }
        Ok(factors)
    }

    async fn put_codes(
        &self,
        user_name: &str,
        factor: &StoredSecondFactor,
        operation: &'static str,
    ) -> Result<(), Problem> {
        let change = AccountChange { by: user_name, operation };
        self.accounts().put_second_factor(user_name, factor, change).await.map_err(internal)
    }
}

fn not_sealed(error: SealingError) -> Problem {
    tracing::error!(
        error = &error as &dyn std::error::Error,
        "A second factor cannot be used: its secret does not open."
    );
    Problem::unavailable(
        "SECOND_FACTOR_SEALED",
        "Codes of the app cannot be checked now. Use a recovery code, or have the second factor removed.",
    )
}

/// A code as it was meant: apps show it in groups.
fn digits(code: &str) -> String {
    code.chars().filter(|letter| !letter.is_whitespace()).collect()
}

/// Returns the problem of a member that is wrong.
pub(super) fn wrong(pointer: &str, code: &str, message: &str) -> Problem {
    let fault = ProblemFault {
        pointer: pointer.to_owned(),
        code: code.to_owned(),
        message: message.to_owned(),
    };
    Problem::unprocessable(code, message, vec![fault])
}
