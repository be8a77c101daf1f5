//! Enrolment tokens: `<platform's address>.<pin of its certificate>.<secret>`, without the pin where the
//! platform does not know its certificate.

use anyhow::Context as _;
use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::certificate_pin::CertificatePin;

/// Parts of a token that say where it may go.
pub(super) struct TokenParts {
    /// Base URL of the platform.
    address: Option<String>,
    /// Certificate that the platform has to show.
    pub(super) pin: Option<CertificatePin>,
}

impl TokenParts {
    /// Takes a token apart.
    ///
    /// # Errors
    /// A pin that is none: sending the token regardless would give up what it is there for.
    pub(super) fn of(token: &str) -> anyhow::Result<Self> {
        let mut parts = token.split('.');
        let (address, pin) = match (parts.next(), parts.next(), parts.next(), parts.next()) {
            (Some(address), Some(pin), Some(_), None) => (address, Some(pin)),
            (Some(address), Some(_), None, None) => (address, None),
            (Some(_), None, None, None) => ("", None),
            _ => anyhow::bail!("this is no token; copy it again"),
        };
        let address =
            URL_SAFE_NO_PAD.decode(address).ok().and_then(|it| String::from_utf8(it).ok());
        let pin = pin.map(str::parse).transpose().context("reading the token; copy it again")?;
        Ok(Self { address: address.filter(|address| !address.is_empty()), pin })
    }

    /// Returns the address of the platform.
    ///
    /// # Errors
    /// A sentence with the remedy, when the token carries none.
    pub(super) fn address(&self) -> anyhow::Result<String> {
        self.address.clone().context(
            "the token carries no address of a platform; copy it again, or give --platform URL",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_carries_the_address_of_its_platform_and_the_pin() {
        const ADDRESS: &str = "aHR0cHM6Ly92ZXJidW5kLmV4YW1wbGU";
        let pin = URL_SAFE_NO_PAD.encode([7; 32]);
        let short = TokenParts::of(&format!("{ADDRESS}.secret")).expect("a token");
        let long = TokenParts::of(&format!("{ADDRESS}.{pin}.secret")).expect("a token");
        for parts in [&short, &long] {
            assert_eq!(parts.address().ok().as_deref(), Some("https://verbund.example"));
        }
        assert!(short.pin.is_none());
        assert_eq!(long.pin.map(|pin| pin.to_string()), Some(pin));
        let bare = TokenParts::of("secret").expect("a token with --platform");
        assert!(bare.address().is_err());
        for broken in [format!("{ADDRESS}.rubbish.secret"), "a.b.c.d".to_owned()] {
            assert!(TokenParts::of(&broken).is_err(), "{broken}");
        }
    }
}
