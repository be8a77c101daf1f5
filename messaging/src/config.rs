//! Configuration of a link: brokers, credentials, trust and limits.

mod broker_url;
mod http_proxy;
mod limits;
mod login;
mod tls;

pub use broker_url::{BrokerUrl, InvalidBrokerUrl};
pub use http_proxy::HttpProxy;
pub use limits::LinkLimits;
pub use login::Login;
pub use tls::{ClientIdentity, Roots, TlsConfig};

use crate::{address::LogicalAddress, profile::BrokerProfile};

/// Configuration of a [`Link`](crate::Link). [`LinkConfig::new`] has defaults for all but three
/// members.
#[derive(Debug, Clone)]
pub struct LinkConfig {
    /// The broker's addresses; the next one is tried when one fails. Never empty.
    pub brokers: Vec<BrokerUrl>,
    /// The broker's names for logical addresses.
    pub profile: BrokerProfile,
    pub login: Login,
    /// Trust and identity, used where a broker's URL asks for TLS.
    pub tls: TlsConfig,
    /// The HTTP proxy between the link and the broker.
    pub proxy: Option<HttpProxy>,
    /// Name of this process at an AMQP broker; unique per running instance. An MQTT session is
    /// named after the user instead.
    pub container_id: String,
    /// Addresses to receive from at the start; see
    /// [`LinkHandle::set_consumed`](crate::LinkHandle::set_consumed).
    pub consumed: Vec<LogicalAddress>,
    /// Receive from each address in an MQTT session of its own: a broker bounds what waits by the session.
    pub has_session_per_address: bool,
    pub limits: LinkLimits,
}

impl LinkConfig {
    /// A link to one embedded broker that trusts the system's roots.
    #[must_use]
    pub fn new(broker: BrokerUrl, login: Login, container_id: impl Into<String>) -> Self {
        Self {
            brokers: vec![broker],
            profile: BrokerProfile::default(),
            login,
            tls: TlsConfig::default(),
            proxy: None,
            container_id: container_id.into(),
            consumed: Vec::new(),
            has_session_per_address: false,
            limits: LinkLimits::default(),
        }
    }
}

/// Fault of a configuration with which no link can ever work.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    #[error("no broker address is configured")]
    NoBroker,
    /// Some addresses are AMQP, some MQTT.
    #[error("the broker addresses must all be of one protocol")]
    MixedProtocols,
    /// The trusted roots or the client certificate cannot be used.
    #[error("the TLS settings of the link cannot be used: {reason}")]
    Tls { reason: String },
}
