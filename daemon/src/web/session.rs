//! Sign-in with a cookie, a CSRF token and throttled attempts. The daemon stores users and sessions.
//!
//! The cookie is `HttpOnly; SameSite=Strict` and holds a random token of which the store knows only
//! the hash. Changes need the session's CSRF token in `x-csrf-token`. The user of
//! a session is read again for each request, so that a changed role or a removed user takes effect at once.

mod accounts;
mod credentials;
mod guard;
mod hashing;
mod known_cookies;
mod own_account;
mod passkeys;
mod password;
mod password_field;
mod second_factor;
mod session_config;
mod sessions;
mod sign_in;
mod sign_in_gate;
mod sign_in_places;
mod throttle;
mod webauthn;

pub use accounts::{
    AccountChange, Accounts, AccountsError, DYNAMIC_STATE_BYTES, PASSKEYS_MAX, PasskeyUse,
    SessionId, StoredPasskey, StoredSecondFactor, StoredSession, USER_HANDLE_BYTES,
    second_factor_purpose,
};
pub use credentials::{Caller, PasskeyAssertion, SignIn, UserName, UserNameError};
pub use guard::require_session;
pub use hashing::{HashingError, PasswordHashing};
pub use own_account::{PasswordChange, SessionList, SessionSummary};
pub use passkeys::{
    NewPasskey, OwnPasskeys, PasskeyBegin, PasskeyList, PasskeyOffer, PasskeyRemoval,
    PasskeySummary,
};
pub use password::{PasswordError, PasswordHash, PasswordPolicy};
pub use password_field::{PasswordFieldError, check_password_field};
pub use second_factor::{
    RecoveryCodes, SecondFactorBegin, SecondFactorCode, SecondFactorOffer, SecondFactorRemoval,
    SecondFactorState,
};
pub use session_config::SessionConfig;
pub use sessions::{CSRF_HEADER, Sessions, SignedIn, random_token};
pub use sign_in::sign_in;
pub use throttle::{LoginThrottle, ThrottleConfig};
pub use webauthn::{PasskeysUnavailable, RelyingParty};
