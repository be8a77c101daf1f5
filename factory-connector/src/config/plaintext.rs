//! Addresses without TLS to other machines.

use daemon::plaintext::{HttpWay, PlaintextWay, http_way};
use messaging::BrokerUrl;

use super::ConnectorConfig;

/// Remedy for an address of the broker.
const BROKER_REMEDY: &str = "write amqps://, amqp+wss://, mqtts:// or mqtt+wss://";
/// Remedy for a proxy that is to know who connects.
const PROXY_REMEDY: &str =
    "use a proxy on 127.0.0.1, or one that asks for no user name and password";

impl ConnectorConfig {
    /// Returns the ways to other machines without TLS that are used and allowed. `named` is the broker's
    /// address of the enrolment, used where none is configured.
    #[must_use]
    pub fn plaintext_ways(&self, named: &BrokerUrl) -> Vec<PlaintextWay> {
        let broker = match &self.broker.url {
            Some(url) => plain_broker("broker.url", url),
            None => plain_broker("the enrolment's broker", named),
        };
        let pages = self.web.page_listener().plain_ways().into_iter().map(|(way, _)| way);
        pages.chain(broker).chain(self.plain_proxy()).collect()
    }

    /// Returns the faults of addresses without TLS that no section allows.
    pub(super) fn plaintext_faults(&self) -> Vec<String> {
        let listener = self.web.page_listener();
        let pages = listener.plain_ways().into_iter().filter(|_| !self.web.allow_plaintext);
        let public_url = self.web.public_url.as_deref();
        let is_invalid = public_url.is_some_and(|url| http_way(url) == HttpWay::Invalid);
        let invalid = is_invalid
            .then(|| "web.public_url: write an address as https://plant.example".to_owned());
        let broker = self.broker.url.as_ref().and_then(|url| plain_broker("broker.url", url));
        let broker = broker.filter(|_| !self.broker.allow_plaintext);
        let is_allowed = self.broker.proxy.as_ref().is_some_and(|proxy| proxy.allow_plaintext);
        let proxy = self.plain_proxy().filter(|_| !is_allowed);
        pages
            .map(|(way, remedy)| way.fault("web", remedy))
            .chain(invalid)
            .chain(listener.proxy_faults())
            .chain(broker.map(|way| way.fault("broker", BROKER_REMEDY)))
            .chain(proxy.map(|way| way.fault("broker.proxy", PROXY_REMEDY)))
            .collect()
    }

    /// Checks the broker's address that the platform named at enrolment, as an own one is.
    ///
    /// # Errors
    /// A sentence with the remedy.
    pub fn check_named_broker(&self, named: &BrokerUrl) -> Result<(), String> {
        let way = plain_broker("the broker's address that the platform named", named);
        match way.filter(|_| !self.broker.allow_plaintext) {
            Some(way) => Err(way.fault("broker", "have the platform's broker.public_url mended")),
            None => Ok(()),
        }
    }

    /// Checks the address of a platform to enrol at.
    ///
    /// # Errors
    /// A sentence with the remedy.
    pub fn check_platform(&self, address: &str) -> Result<(), String> {
        match http_way(address) {
            HttpWay::Plaintext if !self.enrolment.allow_plaintext => {
                Err(PlaintextWay::new("the platform's address", address)
                    .fault("enrolment", "write https://"))
            }
            HttpWay::Safe | HttpWay::Plaintext => Ok(()),
            HttpWay::Invalid => {
                Err(format!("{address} is no address of a platform; write https://verbund.example"))
            }
        }
    }

    /// The proxy, if it gets user name and password without TLS. What goes through it to the broker has
    /// the broker's TLS.
    fn plain_proxy(&self) -> Option<PlaintextWay> {
        let section = self.broker.proxy.as_ref()?;
        // An address that is none is a fault of its own.
        let proxy = section.http_proxy().ok()?;
        proxy.reveals_login().then(|| PlaintextWay::new("broker.proxy.url", &section.url))
    }
}

fn plain_broker(key: &str, url: &BrokerUrl) -> Option<PlaintextWay> {
    (!url.is_encrypted() && !url.is_loopback()).then(|| PlaintextWay::new(key, url))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> ConnectorConfig {
        daemon::configuration::parse(None, text, "VERBUND", std::iter::empty()).expect("valid")
    }

    fn url(text: &str) -> BrokerUrl {
        text.parse().expect("an address")
    }

    #[test]
    fn plaintext_to_other_machines_is_refused_unless_its_section_allows_it() {
        for (text, key) in [
            ("[web]\nlisten = \"0.0.0.0:8090\"\n", "web.listen"),
            ("[web]\npublic_url = \"http://plant.example\"\n", "web.public_url"),
            // The TLS of a proxy on another machine ends there.
            (
                "[web]\nlisten = \"0.0.0.0:8090\"\npublic_url = \"https://plant.example\"\n\
                 trusted_proxies = [\"127.0.0.1\", \"10.0.0.7\"]\n",
                "web.trusted_proxies",
            ),
            ("[broker]\nurl = \"amqp://broker.example\"\n", "broker.url"),
            ("[broker]\nurl = \"mqtt+ws://broker.example\"\n", "broker.url"),
            (
                "[broker.proxy]\nurl = \"http://proxy.example\"\nuser_name = \"u\"\npassword = \"p\"\n",
                "broker.proxy.url",
            ),
        ] {
            let faults = parse(text).faults();
            let is_named = faults.len() == 1 && faults[0].starts_with(key);
            assert!(is_named && faults[0].contains(".allow_plaintext = true"), "{faults:?}");
            let config = parse(&format!("{text}allow_plaintext = true\n"));
            assert_eq!(config.faults(), Vec::<String>::new());
            let ways = config.plaintext_ways(&url("amqps://broker.example"));
            assert_eq!(ways.len(), 1, "it is shown all the same");
            assert_eq!(ways[0].key, key);
        }
    }

    #[test]
    fn a_proxy_that_gets_no_password_or_is_on_this_machine_needs_no_word() {
        let login = "user_name = \"u\"\npassword = \"p\"\n";
        for (proxy, login) in
            [("proxy.example", ""), ("127.0.0.1:3128", login), ("localhost:3128", login)]
        {
            let config = parse(&format!("[broker.proxy]\nurl = \"http://{proxy}\"\n{login}"));
            assert_eq!(config.faults(), Vec::<String>::new(), "{proxy}");
            assert_eq!(config.plaintext_ways(&url("amqps://broker.example")), [], "{proxy}");
        }
        let text = format!(
            "[broker]\nallow_plaintext = true\n[broker.proxy]\nurl = \"http://proxy.example\"\n{login}"
        );
        assert_eq!(parse(&text).faults().len(), 1, "the word for the broker is none for the proxy");
    }

    #[test]
    fn proxies_of_the_pages_on_this_machine_need_no_word_and_others_are_served_alone() {
        let open = "[web]\nlisten = \"0.0.0.0:8090\"\npublic_url = \"https://plant.example\"\n";
        let own = parse(&format!("{open}trusted_proxies = [\"127.0.0.1\"]\n"));
        assert_eq!(own.faults(), Vec::<String>::new());
        assert_eq!(own.plaintext_ways(&url("amqps://broker.example")), []);
        let text = format!("{open}trusted_proxies = [\"10.0.0.7\"]\nallow_plaintext = true\n");
        for config in [own, parse(&text)] {
            assert!(config.web.limits().only_shared);
        }
    }

    #[test]
    fn the_whole_world_is_no_proxy() {
        for range in ["0.0.0.0/0", "8.0.0.0/7", "::/0"] {
            let text = format!("[web]\nallow_plaintext = true\ntrusted_proxies = [\"{range}\"]\n");
            let faults = parse(&text).faults();
            let is_named = faults.len() == 1 && faults[0].starts_with("web.trusted_proxies");
            assert!(is_named && faults[0].contains(range), "{faults:?}");
        }
    }

    #[test]
    fn what_the_platform_named_is_checked_like_an_own_address() {
        let (config, allowing) = (parse(""), parse("[broker]\nallow_plaintext = true\n"));
        for named in
            ["amqps://broker.example", "amqp://127.0.0.1:5672", "mqtt+wss://broker.example"]
        {
            assert_eq!(config.check_named_broker(&url(named)), Ok(()), "{named}");
        }
        for named in ["amqp://broker.example", "mqtt+ws://broker.example"] {
            let fault = config.check_named_broker(&url(named)).expect_err("refused");
            assert!(fault.contains("broker.allow_plaintext"), "{fault}");
            assert_eq!(allowing.check_named_broker(&url(named)), Ok(()));
            assert_eq!(allowing.plaintext_ways(&url(named)).len(), 1);
        }
    }

    #[test]
    fn a_token_goes_to_other_machines_with_tls_alone() {
        let (config, allowing) = (parse(""), parse("[enrolment]\nallow_plaintext = true\n"));
        for address in ["https://verbund.example", "http://127.0.0.1:8080"] {
            assert_eq!(config.check_platform(address), Ok(()), "{address}");
        }
        assert!(config.check_platform("http://verbund.example").is_err());
        assert_eq!(allowing.check_platform("http://verbund.example"), Ok(()));
        assert!(allowing.check_platform("verbund.example").is_err());
    }
}
