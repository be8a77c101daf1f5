//! MQTT 5. Of rumqttc only the codec is used: its client does not assign acknowledgements to
//! publishes, and connects by itself. Nothing of it leaves this module.
//!
//! Mapping of the link's guarantees to MQTT: QoS 1 in both directions, acknowledged after storing;
//! persistent sessions with the user's name as client id. An acknowledgement does not say that a message is stored: a
//! broker that answers a ping some time later has done so ([`Connection::answers`]). A rejection is acknowledged with a
//! failure code, because MQTT has no dead letters. A release sends no acknowledgement and
//! reconnects, because only a reconnect makes a broker deliver again. Two processes with one user
//! disconnect each other; a broker may report that (Mosquitto 2.0 does not).
//!
//! A broker bounds what waits by the session that is to receive it. Who receives from many that do not trust each
//! other has a session for each address ([`LinkConfig::has_session_per_address`]): what one of them fills is its own.

mod codec;
mod config;
mod framing;
mod held;
mod network_connection;
mod publisher;
#[cfg(feature = "test-support")]
mod reading;
mod session;
mod subscriber;

use std::sync::Arc;

use async_trait::async_trait;
use futures::{FutureExt, future::BoxFuture};
use tokio::{sync::watch, time::timeout};

use super::{
    connection::{
        Connection, ConnectionFault, EndpointFault, MessageReceiver, MessageSender, Transport,
    },
    dial::Dialler,
};
use crate::{
    config::{BrokerUrl, LinkConfig, Login},
    profile::Terminus,
};
#[cfg(feature = "test-support")]
pub use reading::read_mqtt;

use config::CLOSE_TIMEOUT;
use held::Memory;
use network_connection::NetworkConnection;
use publisher::MqttPublisher;
use session::SessionOpener;
use subscriber::MqttSubscriber;

/// Name of the session that only sends, where each address has its own.
const SENDER: &str = "sender";

/// Connects to MQTT 5 brokers.
pub(crate) struct MqttTransport {
    opener: Arc<SessionOpener>,
    has_session_per_address: bool,
}

impl MqttTransport {
    pub(super) fn new(
        config: &LinkConfig,
        login: watch::Receiver<Login>,
        dialler: Dialler,
    ) -> Self {
        let opener = Arc::new(SessionOpener { dialler, login, limits: config.limits });
        Self { opener, has_session_per_address: config.has_session_per_address }
    }
}

#[async_trait]
impl Transport for MqttTransport {
    async fn connect(&self, broker: &BrokerUrl) -> Result<Box<dyn Connection>, ConnectionFault> {
        let memory = Memory::new(self.opener.limits.message_bytes_max);
        // Not the session with the user's name alone: it may hold subscriptions from before.
        let name = self.has_session_per_address.then_some(SENDER);
        let network = self.opener.open(broker, name, memory.clone()).await?;
        let broker = self.has_session_per_address.then(|| broker.clone());
        Ok(Box::new(Opened { network, opener: Arc::clone(&self.opener), memory, broker }))
    }
}

/// A connection that the broker has accepted.
struct Opened {
    network: Arc<NetworkConnection>,
    opener: Arc<SessionOpener>,
    /// Memory for what all sessions have received.
    memory: Memory,
    /// Place of the sessions of addresses; none where they have none.
    broker: Option<BrokerUrl>,
}

#[async_trait]
impl Connection for Opened {
    async fn sender(&self, terminus: &Terminus) -> Result<Box<dyn MessageSender>, EndpointFault> {
        let network = Arc::clone(&self.network);
        let limits = self.opener.limits;
        Ok(Box::new(MqttPublisher::new(network, terminus.address.clone(), limits)))
    }

    async fn receiver(
        &self,
        terminus: &Terminus,
    ) -> Result<Box<dyn MessageReceiver>, EndpointFault> {
        let topic = terminus.address.clone();
        let limits = &self.opener.limits;
        let Some(broker) = &self.broker else {
            let network = Arc::clone(&self.network);
            return Ok(Box::new(MqttSubscriber::subscribe(network, topic, limits).await?));
        };
        let opened = self.opener.open(broker, Some(&topic), self.memory.part()).await;
        // The connection of the link goes on; this address is tried again.
        let network = opened.map_err(|fault| EndpointFault::Broken(fault.reason))?;
        Ok(Box::new(MqttSubscriber::subscribe_alone(network, topic, limits).await?))
    }

    async fn lost(&self) -> ConnectionFault {
        self.network.lost().await
    }

    fn answers(&self) -> Option<BoxFuture<'static, bool>> {
        let network = Arc::clone(&self.network);
        Some(async move { network.answers().await }.boxed())
    }

    async fn close(&self) {
        self.network.close();
        let _ = timeout(CLOSE_TIMEOUT, self.network.lost()).await;
    }
}

impl Drop for Opened {
    fn drop(&mut self) {
        self.network.close();
    }
}
