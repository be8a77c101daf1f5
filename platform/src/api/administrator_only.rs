//! Operations that only those who run the platform may use.

use daemon::web::{Problem, session::SignedIn};

use crate::principal::Principal;

/// Lets administrators pass.
pub fn check(who: &SignedIn<Principal>) -> Result<(), Problem> {
    if who.principal.is_administrator() {
        Ok(())
    } else {
        Err(Problem::forbidden("This needs an administrator of the platform."))
    }
}
