//! Credentials.

use std::fmt;

use zeroize::Zeroizing;

/// A user name and password, for SASL PLAIN, an MQTT CONNECT or an HTTP proxy.
#[derive(Clone)]
pub struct Login {
    pub user_name: String,
    /// The password; wiped from memory when dropped, never shown.
    pub password: Zeroizing<String>,
}

impl Login {
    /// A login of a user with a password.
    #[must_use]
    pub fn new(user_name: impl Into<String>, password: impl Into<String>) -> Self {
        Self { user_name: user_name.into(), password: Zeroizing::new(password.into()) }
    }
}

impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Login").field("user_name", &self.user_name).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn debug_output_hides_the_password() {
        let shown = format!("{:?}", Login::new("f1", "canary"));
        assert!(shown.contains("f1") && !shown.contains("canary"), "{shown}");
    }
}
