//! MQTT 5. Of rumqttc only the codec is used: its client does not assign acknowledgements to
//! publishes, and connects by itself. Nothing of it leaves this module.
//!
//! Mapping of the link's guarantees to MQTT: QoS 1 in both directions, acknowledged after storing;
//! persistent sessions with the user's name as client id. An acknowledgement does not say that a message is stored: a
//! broker that answers a ping some time later has done so ([`Connection::answers`]). A rejection is acknowledged with a
//! failure code, because MQTT has no dead letters. A release sends no acknowledgement and
//! reconnects, because only a reconnect makes a broker deliver again. Two processes with one user
//! disconnect each other; a broker may report that (Mosquitto 2.0 does not).

mod codec;
mod config;
mod framing;
mod held;
mod network_connection;
mod publisher;
#[cfg(feature = "test-support")]
mod reading;
mod subscriber;

use std::sync::Arc;

use async_trait::async_trait;
use futures::{FutureExt, SinkExt, StreamExt, future::BoxFuture};
use rumqttc::v5::mqttbytes::v5::{
    Connect, ConnectProperties, ConnectReturnCode, Login as MqttLogin, Packet,
};
use tokio::{sync::watch, time::timeout};
use tokio_util::codec::Framed;

use super::{
    connection::{
        Connection, ConnectionFault, EndpointFault, MessageReceiver, MessageSender, Transport,
    },
    dial::{Dialler, Stream},
};
use crate::{
    config::{BrokerUrl, LinkConfig, LinkLimits, Login},
    profile::Terminus,
};
#[cfg(feature = "test-support")]
pub use reading::read_mqtt;

use config::{CLOSE_TIMEOUT, SESSION_EXPIRY, no_properties};
use framing::{Incoming, PacketCodec};
use network_connection::NetworkConnection;
use publisher::MqttPublisher;
use subscriber::MqttSubscriber;

/// Connects to MQTT 5 brokers.
pub(crate) struct MqttTransport {
    dialler: Dialler,
    login: watch::Receiver<Login>,
    limits: LinkLimits,
}

impl MqttTransport {
    pub(super) fn new(
        config: &LinkConfig,
        login: watch::Receiver<Login>,
        dialler: Dialler,
    ) -> Self {
        Self { dialler, login, limits: config.limits }
    }

    fn packet_bytes_max(&self) -> u32 {
        u32::try_from(self.limits.message_bytes_max).unwrap_or(u32::MAX)
    }

    fn connect_packet(&self) -> Packet {
        let mut properties = ConnectProperties::new();
        properties.session_expiry_interval = u32::try_from(SESSION_EXPIRY.as_secs()).ok();
        properties.receive_maximum =
            Some(u16::try_from(self.limits.credit.max(1)).unwrap_or(u16::MAX));
        properties.max_packet_size = Some(self.packet_bytes_max());
        let Login { user_name, password } = self.login.borrow().clone();
        let connect = Connect {
            keep_alive: u16::try_from(self.limits.idle_timeout.as_secs().max(2))
                .unwrap_or(u16::MAX),
            client_id: user_name.clone(),
            // The session holds what arrived while the link was down.
            clean_start: false,
            properties: Some(properties),
        };
        let login = MqttLogin { username: user_name, password: password.to_string() };
        Packet::Connect(connect, None, Some(login))
    }

    async fn open(&self, stream: Box<dyn Stream>) -> Result<Box<dyn Connection>, ConnectionFault> {
        let mut framed = Framed::new(stream, PacketCodec::new(self.packet_bytes_max()));
        let broken = |e: &dyn std::fmt::Debug| {
            ConnectionFault::transient(format!("the connection could not be opened: {e:?}"))
        };
        framed.send(self.connect_packet()).await.map_err(|e| broken(&e))?;
        let answer = match framed.next().await {
            Some(Ok(Incoming::Packet(Packet::ConnAck(answer)))) => answer,
            Some(Ok(_)) => {
                return Err(ConnectionFault::permanent(
                    "the peer does not speak MQTT 5; is the port right?",
                ));
            }
            Some(Err(e)) => return Err(broken(&e)),
            None => {
                return Err(ConnectionFault::transient(
                    "the broker closed the connection without an answer",
                ));
            }
        };
        match answer.code {
            ConnectReturnCode::Success => {}
            ConnectReturnCode::BadUserNamePassword
            | ConnectReturnCode::NotAuthorized
            | ConnectReturnCode::Banned => {
                return Err(ConnectionFault::permanent("the broker refused the user or password"));
            }
            code @ (ConnectReturnCode::RefusedProtocolVersion
            | ConnectReturnCode::UnsupportedProtocolVersion
            | ConnectReturnCode::ClientIdentifierNotValid
            | ConnectReturnCode::BadAuthenticationMethod) => {
                return Err(ConnectionFault::permanent(format!(
                    "the broker refused the connection: {code:?}"
                )));
            }
            code => {
                return Err(ConnectionFault::transient(format!(
                    "the broker refused the connection: {code:?}"
                )));
            }
        }
        let granted = answer.properties.unwrap_or(no_properties());
        let network = NetworkConnection::start(framed, &granted, &self.limits);
        Ok(Box::new(Opened { network, limits: self.limits }))
    }
}

#[async_trait]
impl Transport for MqttTransport {
    async fn connect(&self, broker: &BrokerUrl) -> Result<Box<dyn Connection>, ConnectionFault> {
        let connecting = async {
            let stream = self.dialler.dial(broker).await?;
            self.open(stream).await
        };
        timeout(self.limits.connect_timeout, connecting)
            .await
            .map_err(|_| ConnectionFault::transient(format!("{broker} did not answer in time")))?
    }
}

/// A connection that the broker has accepted.
struct Opened {
    network: Arc<NetworkConnection>,
    limits: LinkLimits,
}

#[async_trait]
impl Connection for Opened {
    async fn sender(&self, terminus: &Terminus) -> Result<Box<dyn MessageSender>, EndpointFault> {
        let network = Arc::clone(&self.network);
        Ok(Box::new(MqttPublisher::new(network, terminus.address.clone(), self.limits)))
    }

    async fn receiver(
        &self,
        terminus: &Terminus,
    ) -> Result<Box<dyn MessageReceiver>, EndpointFault> {
        let network = Arc::clone(&self.network);
        let topic = terminus.address.clone();
        Ok(Box::new(MqttSubscriber::subscribe(network, topic, &self.limits).await?))
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
