//! Sign-in by a protocol with one field for the secret, as OPC UA: the code of the authenticator app follows the
//! password. Attempts are those of the pages, in the same counts.

use std::net::IpAddr;

use axum::http::StatusCode;

use super::{
    accounts::Accounts,
    second_factor::CODE_DIGITS,
    sessions::{Sessions, internal},
    sign_in_gate::{OpenSignIn, count},
};
use crate::{Confidential, web::problem::Problem};

/// Reason why a user was not signed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PasswordFieldError {
    #[error("user name, password or code is wrong")]
    Wrong,
    /// The password is right. No passkey fits into the field.
    #[error("the user's second factor is a passkey alone, which this protocol cannot ask for")]
    PasskeyAlone,
    /// Refusal before any check, for too many attempts failed.
    #[error("too many attempts failed")]
    Throttled,
    /// Failure to decide: too many sign in at once, or the store failed.
    #[error("the credentials could not be checked now")]
    NotChecked,
}

/// Checks a user's name and the content of the field: the password, followed by the six digits of the present code where
/// codes are on. A code is good once, here and on the pages. Recovery codes are for the pages alone.
///
/// # Errors
/// [`PasswordFieldError`], which the client must not learn.
pub async fn check_password_field<A: Accounts>(
    sessions: &Sessions<A>,
    client: IpAddr,
    user_name: &str,
    field: Confidential<String>,
) -> Result<A::Principal, PasswordFieldError> {
    let open =
        sessions.gate().enter(client, user_name).await.map_err(|problem| not_let_in(&problem))?;
    let decided = decide(sessions, &open, user_name, field).await;
    match decided {
        Ok(Ok(principal)) => {
            open.succeeded();
            count("accepted");
            Ok(principal)
        }
        Ok(Err(refusal)) => {
            count("refused");
            if refusal == PasswordFieldError::PasskeyAlone {
                // As on the pages, where the second factor is missing.
                open.withdrawn();
            }
            Err(refusal)
        }
        Err(_) => {
            open.withdrawn();
            Err(PasswordFieldError::NotChecked)
        }
    }
}

async fn decide<A: Accounts>(
    sessions: &Sessions<A>,
    open: &OpenSignIn<'_>,
    user_name: &str,
    field: Confidential<String>,
) -> Result<Result<A::Principal, PasswordFieldError>, Problem> {
    let factors = sessions.second_factors(user_name).await?;
    let (password, code) = if factors.has_codes { split(&field) } else { (field, None) };
    // Once for everybody: the time it takes tells neither who exists nor who has a second factor.
    if !open.unless_displaced(sessions.is_password(user_name, password)).await? {
        return Ok(Err(PasswordFieldError::Wrong));
    }
    if factors.has_codes {
        let is_code = match code {
            Some(code) => sessions.is_code(user_name, &code).await?,
            None => false,
        };
        if !is_code {
            return Ok(Err(PasswordFieldError::Wrong));
        }
    } else if factors.is_any() {
        return Ok(Err(PasswordFieldError::PasskeyAlone));
    }
    let principal = sessions.accounts().principal(user_name).await.map_err(internal)?;
    Ok(principal.ok_or(PasswordFieldError::Wrong))
}

/// Splits the code off; without six digits at the end all is the password.
fn split(field: &Confidential<String>) -> (Confidential<String>, Option<Confidential<String>>) {
    let text = field.expose();
    let at = text
        .len()
        .checked_sub(CODE_DIGITS)
        .filter(|at| text.as_bytes()[*at..].iter().all(u8::is_ascii_digit));
    match at {
        Some(at) => (text[..at].to_owned().into(), Some(text[at..].to_owned().into())),
        None => (text.clone().into(), None),
    }
}

fn not_let_in(problem: &Problem) -> PasswordFieldError {
    if problem.status == StatusCode::TOO_MANY_REQUESTS {
        PasswordFieldError::Throttled
    } else {
        PasswordFieldError::NotChecked
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_code_is_the_six_digits_at_the_end() {
        for (field, password, code) in [
            ("secret123456", "secret", Some("123456")),
            ("secret1234567", "secret1", Some("234567")),
            ("123456", "", Some("123456")),
            ("secret12345", "secret12345", None),
            ("secret 12345", "secret 12345", None),
            ("12345", "12345", None),
            ("", "", None),
            ("ä١٢٣٤٥٦", "ä١٢٣٤٥٦", None),
            ("ää123456", "ää", Some("123456")),
        ] {
            let (found, digits) = split(&field.to_owned().into());
            let digits = digits.map(|code| code.expose().clone());
            assert_eq!((found.expose().as_str(), digits.as_deref()), (password, code), "{field}");
        }
    }
}
