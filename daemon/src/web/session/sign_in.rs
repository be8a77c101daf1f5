//! Signing in: name and password, then a second factor where one is on, then a session.

use axum::http::StatusCode;
use axum_extra::extract::cookie::Cookie;

use super::{
    accounts::Accounts,
    credentials::{Caller, SignIn},
    passkeys::OwnPasskeys,
    second_factor::ActiveFactors,
    sessions::{Sessions, SignedIn, internal},
    sign_in_gate::{OpenSignIn, count},
};
use crate::web::problem::{Problem, SecondFactorKind, SecondFactorNeeded};

/// Outcome of looking at credentials.
enum Decision<P> {
    Right(P),
    Wrong,
    /// Name and password are right, and there is no second factor where one is needed.
    FactorNeeded(SecondFactorNeeded),
}

/// Checks credentials and opens a session; the cookie goes into the answer. The session that the browser
/// had before ends.
///
/// # Errors
/// A [`Problem`]: 401 for a wrong name, password or second factor (without saying which) and for a second
/// factor that is missing, 429 after too many attempts, 503 when too many sign in at once.
pub async fn sign_in<A: Accounts>(
    sessions: &Sessions<A>,
    caller: &Caller,
    sign_in: &SignIn,
) -> Result<(Cookie<'static>, SignedIn<A::Principal>), Problem> {
    let user_name = sign_in.user_name.as_str();
    let open = sessions.gate().enter(caller.address, user_name).await?;
    let decided = decide(sessions, &open, sign_in).await;
    let principal = match decided {
        Ok(Decision::Right(principal)) => principal,
        Ok(Decision::Wrong) => {
            drop(open);
            count("refused");
            tracing::warn!(client = %caller.address, "An attempt to sign in was refused.");
            return Err(wrong_credentials());
        }
        Ok(Decision::FactorNeeded(needed)) => {
            // Given back, but failures are not forgotten: else this would be the way to try as
            // many codes as one likes.
            open.withdrawn();
            count("code_needed");
            return Err(factor_needed(needed));
        }
        Err(problem) => {
            open.withdrawn();
            return Err(problem);
        }
    };
    open.succeeded();
    count("accepted");
    let (cookie, session) = sessions.open_session(caller, user_name).await?;
    let signed_in = SignedIn {
        session: session.id,
        user_name: session.user_name,
        principal,
        csrf_token: session.csrf_token,
    };
    Ok((cookie, signed_in))
}

async fn decide<A: Accounts>(
    sessions: &Sessions<A>,
    open: &OpenSignIn<'_>,
    sign_in: &SignIn,
) -> Result<Decision<A::Principal>, Problem> {
    let user_name = sign_in.user_name.as_str();
    let is_password = sessions.is_password(user_name, sign_in.password.clone());
    if !open.unless_displaced(is_password).await? {
        return Ok(Decision::Wrong);
    }
    let factors = sessions.second_factors(user_name).await?;
    if factors.is_any() {
        let passkeys = OwnPasskeys::of(sessions, user_name);
        let is_right = match (&sign_in.code, &sign_in.passkey) {
            (Some(code), _) => sessions.is_code(user_name, code).await?,
            (None, Some(assertion)) => passkeys.is_right(assertion).await?,
            (None, None) => return Ok(Decision::FactorNeeded(needed(&passkeys, &factors)?)),
        };
        if !is_right {
            return Ok(Decision::Wrong);
        }
    }
    let principal = sessions.accounts().principal(user_name).await.map_err(internal)?;
    Ok(principal.map_or(Decision::Wrong, Decision::Right))
}

/// Names the second factors of a user, with a challenge for the passkeys.
fn needed<A: Accounts>(
    passkeys: &OwnPasskeys<'_, A>,
    factors: &ActiveFactors,
) -> Result<SecondFactorNeeded, Problem> {
    let mut needed = SecondFactorNeeded { kinds: Vec::new(), passkey_options: None };
    if factors.has_codes {
        needed.kinds.push(SecondFactorKind::Code);
    }
    if !factors.passkeys.is_empty() {
        needed.kinds.push(SecondFactorKind::Passkey);
        needed.passkey_options = passkeys.options(&factors.passkeys)?;
    }
    Ok(needed)
}

fn wrong_credentials() -> Problem {
    let detail = "User name, password or second factor is wrong.";
    Problem::new(StatusCode::UNAUTHORIZED, "WRONG_CREDENTIALS", detail)
}

/// Returns the problem of a sign-in that needs a second factor, too.
fn factor_needed(needed: SecondFactorNeeded) -> Problem {
    let detail = match needed.kinds[..] {
        [SecondFactorKind::Passkey] => "Signing in needs a passkey, or a recovery code.",
        [SecondFactorKind::Code] => {
            "Signing in needs a code from the authenticator app, or a recovery code."
        }
        _ => "Signing in needs a passkey, a code from the authenticator app, or a recovery code.",
    };
    Problem {
        second_factor: Some(Box::new(needed)),
        ..Problem::new(StatusCode::UNAUTHORIZED, "SECOND_FACTOR_NEEDED", detail)
    }
}
