//! Addresses without TLS to other machines.

use daemon::plaintext::{HttpWay, PlaintextWay, http_way};
use messaging::BrokerUrl;

use super::PlatformConfig;

/// Remedy for an address of a broker.
const BROKER_REMEDY: &str = "write amqps://, amqp+wss://, mqtts:// or mqtt+wss://";

/// A way with the section whose key allows it, and the remedy that needs no key.
struct Use {
    way: PlaintextWay,
    section: &'static str,
    is_allowed: bool,
    remedy: &'static str,
}

impl PlatformConfig {
    /// Returns the ways to other machines without TLS that the configuration allows.
    #[must_use]
    pub fn plaintext_ways(&self) -> Vec<PlaintextWay> {
        self.plaintext_uses().into_iter().map(|used| used.way).collect()
    }

    /// Returns the faults of addresses: those without TLS that no section allows, and what is no address.
    pub(super) fn address_faults(&self) -> Vec<String> {
        let mut faults: Vec<String> = self
            .plaintext_uses()
            .iter()
            .filter(|used| !used.is_allowed)
            .map(|used| used.way.fault(used.section, used.remedy))
            .collect();
        let public_url = self.web.public_url.as_deref();
        if public_url.is_some_and(|url| http_way(url) == HttpWay::Invalid) {
            faults.push("web.public_url: write an address as https://verbund.example".to_owned());
        }
        faults.extend(self.web.page_listener().proxy_faults());
        faults
    }

    fn plaintext_uses(&self) -> Vec<Use> {
        let pages = self.web.page_listener().plain_ways().into_iter();
        let of_pages = pages.map(|(way, remedy)| Use {
            way,
            section: "web",
            is_allowed: self.web.allow_plaintext,
            remedy,
        });
        let mut uses: Vec<_> = of_pages.collect();
        let public_url = self.broker.public_url.iter().filter(|url| is_plaintext(url));
        uses.extend(public_url.map(|url| Use {
            way: PlaintextWay::new("broker.public_url", url),
            section: "broker",
            is_allowed: self.broker.allow_plaintext,
            remedy: BROKER_REMEDY,
        }));
        if let Some(external) = &self.broker.external {
            let urls = external.urls.iter().filter(|url| is_plaintext(url));
            uses.extend(urls.map(|url| Use {
                way: PlaintextWay::new("broker.external.urls", url),
                section: "broker.external",
                is_allowed: external.allow_plaintext,
                remedy: BROKER_REMEDY,
            }));
        }
        uses
    }
}

fn is_plaintext(url: &BrokerUrl) -> bool {
    !url.is_encrypted() && !url.is_loopback()
}

#[cfg(test)]
mod tests {
    use crate::config::PlatformConfig;

    fn parse(text: &str) -> PlatformConfig {
        daemon::configuration::parse(None, text, "VERBUND", []).expect("valid")
    }

    fn external(urls: &str, more: &str) -> String {
        format!(
            "[broker.external]\nurls = [{urls}]\nprofile = \"rabbitmq-4\"\nuser_name = \"p\"\npassword = \"sixteen characters\"\n{more}"
        )
    }

    #[test]
    fn plaintext_to_other_machines_is_refused_unless_its_section_allows_it() {
        let allowed = "allow_plaintext = true\n";
        for (text, key) in [
            (
                "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"http://verbund.example\"\n"
                    .to_owned(),
                "web.public_url",
            ),
            ("[web]\npublic_url = \"http://verbund.example\"\n".to_owned(), "web.public_url"),
            ("[web]\nlisten = \"0.0.0.0:80\"\n".to_owned(), "web.listen"),
            // An address that looks safe closes no listener.
            (
                "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"http://localhost\"\n".to_owned(),
                "web.listen",
            ),
            (
                "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"https://verbund.example\"\n"
                    .to_owned(),
                "web.listen",
            ),
            // The TLS of a proxy on another machine ends there.
            (
                "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"https://verbund.example\"\n\
                 trusted_proxies = [\"127.0.0.1\", \"10.0.0.7\"]\n"
                    .to_owned(),
                "web.trusted_proxies: 10.0.0.7/32 ",
            ),
            ("[broker]\npublic_url = \"amqp://broker.example\"\n".to_owned(), "broker.public_url"),
            (external("\"amqp://broker.example\"", ""), "broker.external.urls"),
            (
                external("\"amqps://a.example\", \"amqp+ws://b.example\"", ""),
                "broker.external.urls",
            ),
            (external("\"mqtt://broker.example\"", ""), "broker.external.urls"),
        ] {
            let faults = parse(&text).faults();
            assert!(
                faults.len() == 1
                    && faults[0].starts_with(key)
                    && faults[0].contains(".allow_plaintext = true"),
                "{text}: {faults:?}"
            );
            let config = parse(&(text.clone() + allowed));
            assert_eq!(config.faults(), Vec::<String>::new(), "{text}");
            assert_eq!(config.plaintext_ways().len(), 1, "it is told all the same: {text}");
        }
    }

    #[test]
    fn one_section_allows_nothing_for_another() {
        let text = format!(
            "[web]\nallow_plaintext = true\n[broker]\npublic_url = \"amqp://a.example\"\n{}",
            external("\"amqp://b.example\"", "")
        );
        let faults = parse(&text).faults();
        assert_eq!(faults.len(), 2, "{faults:?}");
    }

    #[test]
    fn tls_and_this_machine_need_no_word() {
        for text in [
            "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"https://verbund.example\"\n\
             trusted_proxies = [\"127.0.0.1\", \"::1\"]\n"
                .to_owned(),
            "[web]\npublic_url = \"https://verbund.example\"\ntrusted_proxies = [\"10.0.0.7\"]\n"
                .to_owned(),
            "[web]\npublic_url = \"https://verbund.example\"\n".to_owned(),
            "[web]\npublic_url = \"http://127.0.0.1:8080\"\n".to_owned(),
            "[broker]\npublic_url = \"amqps://broker.example\"\n".to_owned(),
            external("\"amqp://127.0.0.1\", \"amqps://broker.example\"", ""),
        ] {
            let config = parse(&text);
            assert_eq!(config.faults(), Vec::<String>::new(), "{text}");
            assert_eq!(config.plaintext_ways(), [], "{text}");
        }
    }

    #[test]
    fn who_goes_round_a_proxy_elsewhere_is_not_served_though_its_way_is_allowed() {
        let config = parse(
            "[web]\nlisten = \"0.0.0.0:80\"\npublic_url = \"https://verbund.example\"\n\
             trusted_proxies = [\"10.0.0.7\"]\nallow_plaintext = true\n",
        );
        assert_eq!(config.faults(), Vec::<String>::new());
        assert!(config.web.limits().only_shared);
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
    fn what_is_no_address_is_named() {
        for url in ["verbund.example", "ftp://verbund.example", ""] {
            let faults = parse(&format!("[web]\npublic_url = \"{url}\"\n")).faults();
            assert!(faults.len() == 1 && faults[0].starts_with("web.public_url"), "{faults:?}");
        }
    }
}
