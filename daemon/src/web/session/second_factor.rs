//! Second factor of a user: codes by time from an authenticator app, and recovery codes.
//!
//! A code is good once: of each user the newest time step that was used is stored. The secret is shown
//! when it is made and never again.

mod enrolment;
mod totp;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    accounts::{AccountChange, Accounts, StoredSecondFactor, second_factor_purpose},
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
const CODE_DIGITS: usize = 6;

/// State of a user's second factor.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SecondFactorState {
    /// True if signing in takes a code.
    pub is_on: bool,
    /// Recovery codes that are left.
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

/// Codes that sign in once each when the app is lost; shown this once.
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

impl<A: Accounts> Sessions<A> {
    /// Returns the state of a user's second factor.
    ///
    /// # Errors
    /// A [`Problem`] when the store fails.
    pub async fn second_factor_state(&self, user_name: &str) -> Result<SecondFactorState, Problem> {
        let factor = self.accounts().second_factor(user_name).await.map_err(internal)?;
        let confirmed = factor.filter(|factor| factor.is_confirmed);
        Ok(SecondFactorState {
            is_on: confirmed.is_some(),
            recovery_codes_left: confirmed.map_or(0, |factor| factor.recovery_digests.len()),
        })
    }

    /// Makes a secret, which counts once it is confirmed.
    ///
    /// # Errors
    /// A [`Problem`]: 409 where a second factor is on, 422 for a wrong password, 503 without a key to seal
    /// with, and those of a sign-in.
    pub async fn begin_second_factor(
        &self,
        caller: &Caller,
        user: &SignedIn<A::Principal>,
        body: SecondFactorBegin,
    ) -> Result<SecondFactorOffer, Problem> {
        self.check_password(caller, &user.user_name, body.password).await?;
        self.keep_confirmed(&user.user_name).await?;
        let secret = enrolment::new_secret();
        let purpose = second_factor_purpose(&user.user_name);
        let sealed = self.sealer().seal(&purpose, &hex::encode(&secret)).map_err(not_sealed)?;
        let factor = StoredSecondFactor {
            sealed_secret: Some(sealed),
            is_confirmed: false,
            last_step: 0,
            recovery_digests: Vec::new(),
        };
        self.accounts().put_second_factor(&user.user_name, &factor).await.map_err(internal)?;
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
        self.keep_confirmed(&user.user_name).await?;
        let begun = self.accounts().second_factor(&user.user_name).await.map_err(internal)?;
        let Some(begun) = begun else {
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
        let recovery_codes = enrolment::new_recovery_codes();
        let factor = StoredSecondFactor {
            is_confirmed: true,
            last_step,
            recovery_digests: recovery_codes
                .iter()
                .map(|code| enrolment::recovery_digest(code))
                .collect(),
            ..begun
        };
        self.accounts().put_second_factor(&user.user_name, &factor).await.map_err(internal)?;
        tracing::info!(user.name = user.user_name, "A second factor was turned on.");
        Ok(RecoveryCodes { recovery_codes })
    }

    /// Turns the second factor off, with password and code.
    ///
    /// # Errors
    /// A [`Problem`]: 404 where none is on, 422 for a wrong password or code, and those of a sign-in.
    pub async fn remove_second_factor(
        &self,
        caller: &Caller,
        user: &SignedIn<A::Principal>,
        body: SecondFactorRemoval,
    ) -> Result<(), Problem> {
        if !self.second_factor_state(&user.user_name).await?.is_on {
            return Err(Problem::not_found("second factor"));
        }
        let open = self.gate().enter(caller.address, &user.user_name).await?;
        let is_right = match self.is_password(&user.user_name, body.password).await {
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
        let change = AccountChange { by: &user.user_name, operation: "removeSecondFactor" };
        self.reset_second_factor(&user.user_name, change).await?;
        Ok(())
    }

    /// Removes the second factor of a user who cannot; false where there is none.
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
        let Some(factor) = factor.filter(|factor| factor.is_confirmed) else { return Ok(false) };
        let digits = digits(code);
        if digits.len() != CODE_DIGITS {
            let digest = enrolment::recovery_digest(code);
            return self.accounts().use_recovery_code(user_name, &digest).await.map_err(internal);
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

    async fn keep_confirmed(&self, user_name: &str) -> Result<(), Problem> {
        if self.second_factor_state(user_name).await?.is_on {
            let detail = "A second factor is on. Turn it off first.";
            return Err(Problem::conflict("SECOND_FACTOR_ON", detail));
        }
        Ok(())
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
