//! HTTP proxies.

use super::{
    broker_url::{InvalidBrokerUrl, authority, is_loopback},
    login::Login,
};

/// Port of a proxy whose address names none.
const DEFAULT_PORT: u16 = 8080;

/// An HTTP proxy that supports CONNECT (RFC 9110 §9.3.6): `http://host[:port]`.
#[derive(Debug, Clone)]
pub struct HttpProxy {
    pub(crate) host: String,
    pub(crate) port: u16,
    /// Credentials for the proxy, if it asks for any.
    pub login: Option<Login>,
}

impl HttpProxy {
    /// Parses the address of a proxy.
    ///
    /// # Errors
    /// [`InvalidBrokerUrl::ProxyScheme`], [`InvalidBrokerUrl::Credentials`] or
    /// [`InvalidBrokerUrl::Authority`] when the text is no such address.
    pub fn new(url: &str, login: Option<Login>) -> Result<Self, InvalidBrokerUrl> {
        let rest = url
            .strip_prefix("http://")
            .ok_or_else(|| InvalidBrokerUrl::ProxyScheme { found: url.to_owned() })?;
        if rest.contains('@') {
            return Err(InvalidBrokerUrl::Credentials);
        }
        let (host, port) =
            authority(rest).ok_or_else(|| InvalidBrokerUrl::Authority { found: url.to_owned() })?;
        Ok(Self { host, port: port.unwrap_or(DEFAULT_PORT), login })
    }

    /// Returns whether the credentials go to another machine, in the clear: between link and proxy
    /// there is no TLS.
    #[must_use]
    pub fn reveals_login(&self) -> bool {
        self.login.is_some() && !is_loopback(&self.host)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_in_an_address_is_not_repeated_in_the_error() {
        let error = HttpProxy::new("http://user:canary@h:3128", None).expect_err("credentials");
        assert!(!error.to_string().contains("canary"), "{error}");
    }
}
