//! Route from the plant to the broker: another address, own authorities, an HTTP proxy.

use std::path::PathBuf;

use daemon::{Confidential, client_certificate::ClientCertificateFiles};
use messaging::{BrokerUrl, HttpProxy, InvalidBrokerUrl, Login};
use serde::Deserialize;

/// Deviations from the route that the platform named at enrolment.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BrokerSection {
    /// Address that leads to the same broker, in the same protocol.
    pub url: Option<BrokerUrl>,
    /// Speak with a broker on another machine without TLS.
    pub allow_plaintext: bool,
    /// PEM file with the authorities of the broker's certificate; those of the enrolment where
    /// absent.
    pub root_certificates: Option<PathBuf>,
    /// Certificate and key by which the connector is known to the broker, beside user name and password.
    pub client_certificate: Option<ClientCertificateFiles>,
    /// HTTP proxy to connect through.
    pub proxy: Option<ProxySection>,
}

/// HTTP proxy that accepts CONNECT.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProxySection {
    /// Address as `http://host[:port]`; without user name and password.
    pub url: String,
    /// User name of the connector at the proxy, where it demands one.
    pub user_name: Option<String>,
    pub password: Option<Confidential<String>>,
    /// Send user name and password to a proxy on another machine, which they reach without TLS.
    #[serde(default)]
    pub allow_plaintext: bool,
}

impl BrokerSection {
    /// Returns the faults of the section: sentences that name key and remedy.
    pub(super) fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if let Some(proxy) = &self.proxy {
            if let Err(fault) = proxy.http_proxy() {
                faults.push(format!("broker.proxy.url: {fault}"));
            }
            if proxy.user_name.is_some() != proxy.password.is_some() {
                faults.push(
                    "broker.proxy: give both user_name and password, or none of them".to_owned(),
                );
            }
        }
        faults
    }
}

impl ProxySection {
    /// Returns the proxy in the form that the link takes.
    ///
    /// # Errors
    /// [`InvalidBrokerUrl`] when the address is none of a proxy.
    pub fn http_proxy(&self) -> Result<HttpProxy, InvalidBrokerUrl> {
        let login = self.user_name.as_ref().zip(self.password.as_ref());
        HttpProxy::new(
            &self.url,
            login.map(|(user_name, password)| Login::new(user_name, password.expose())),
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::config::ConnectorConfig;

    fn faults(text: &str) -> Vec<String> {
        let config: ConnectorConfig =
            daemon::configuration::parse(None, text, "VERBUND", std::iter::empty()).expect("valid");
        config.faults()
    }

    #[test]
    fn the_way_to_the_broker_is_checked() {
        for url in
            ["amqp+wss://broker.example", "amqps://broker.example", "amqp+ws://localhost:8080/x"]
        {
            assert_eq!(
                faults(&format!("[broker]\nurl = \"{url}\"\n")),
                Vec::<String>::new(),
                "{url}"
            );
        }
        for (text, words) in [
            ("[broker]\nurl = \"amqp+ws://broker.example\"\n", "without TLS"),
            ("[broker.proxy]\nurl = \"https://proxy\"\n", "begins with http://"),
            ("[broker.proxy]\nurl = \"http://u:canary@proxy\"\n", "settings of their own"),
            (
                "[broker.proxy]\nurl = \"http://proxy\"\nuser_name = \"u\"\n",
                "both user_name and password",
            ),
        ] {
            let faults = faults(text);
            assert!(
                faults.len() == 1 && faults[0].starts_with("broker.") && faults[0].contains(words),
                "{text}: {faults:?}"
            );
            assert!(!faults[0].contains("canary"), "{faults:?}");
        }
    }
}
