//! Listener of pages and API, and what is in front of it.

use std::{
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
};

use daemon::web::{
    address_range::AddressRange,
    client_address::{ForwardedHeader, TrustedProxies},
    page_listener::PageListener,
    server::{ListenerLimits, TlsFiles},
    shares::{FairShareConfig, OrganisationShare, PersonShare},
};
use serde::Deserialize;

/// Pages and API.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WebConfig {
    /// Address to listen on.
    pub listen: SocketAddr,
    /// Base URL for browsers and connectors; part of enrolment tokens.
    pub public_url: Option<String>,
    /// Certificate and key; without them plain HTTP, for loopback or behind a proxy on this machine that speaks
    /// TLS.
    pub tls: Option<TlsFiles>,
    /// PEM file of the certificate that clients are shown at the public URL, or of an authority that is
    /// sent along; that of `tls` where absent. Connectors enrol with nobody else.
    pub public_certificate: Option<PathBuf>,
    /// Speak plain HTTP with other machines.
    pub allow_plaintext: bool,
    /// Proxies in front of the pages, whose word about their clients counts.
    pub trusted_proxies: Vec<AddressRange>,
    /// Header in which these proxies tell the address of their client.
    pub forwarded_header: ForwardedHeader,
    /// Share of a person in requests, downloads and live streams.
    pub share_per_person: PersonShare,
    /// Share of all people of an organisation together.
    pub share_per_organisation: OrganisationShare,
}

impl Default for WebConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 8080)),
            public_url: None,
            tls: None,
            public_certificate: None,
            allow_plaintext: false,
            trusted_proxies: Vec::new(),
            forwarded_header: ForwardedHeader::default(),
            share_per_person: PersonShare::default(),
            share_per_organisation: OrganisationShare::default(),
        }
    }
}

impl WebConfig {
    /// Returns the proxies in front of the pages.
    #[must_use]
    pub fn proxies(&self) -> TrustedProxies {
        TrustedProxies { ranges: self.trusted_proxies.clone(), header: self.forwarded_header }
    }

    /// Returns the shares of people and organisations.
    #[must_use]
    pub fn shares(&self) -> FairShareConfig {
        FairShareConfig {
            person: self.share_per_person.clone(),
            organisation: self.share_per_organisation.clone(),
        }
    }

    /// Returns what to say where enrolment tokens name no certificate although others speak TLS for the platform.
    #[must_use]
    pub fn unpinned_tokens(&self) -> Option<String> {
        let public_url = self.public_url.as_deref().filter(|url| url.starts_with("https://"))?;
        (self.tls.is_none() && self.public_certificate.is_none()).then(|| {
            format!(
                "web.public_certificate: it is not set, so enrolment tokens do not name the certificate of {public_url}, \
                 and a connector enrols with any machine at that address that its own system believes. Give the \
                 certificate that the proxy shows there."
            )
        })
    }

    /// Returns the listener with what is in front of it.
    #[must_use]
    pub fn page_listener(&self) -> PageListener<'_> {
        PageListener {
            listen: self.listen,
            has_tls: self.tls.is_some(),
            public_url: self.public_url.as_deref(),
            trusted_proxies: &self.trusted_proxies,
        }
    }

    /// Returns the bounds of their server.
    #[must_use]
    pub fn limits(&self) -> ListenerLimits {
        ListenerLimits {
            shared_addresses: self.trusted_proxies.clone(),
            only_shared: self.page_listener().serves_proxies_alone(),
            ..ListenerLimits::default()
        }
    }
}
