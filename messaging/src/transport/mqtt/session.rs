//! Opening of a session at a broker.

use std::sync::Arc;

use futures::{SinkExt, StreamExt};
use rumqttc::v5::mqttbytes::v5::{
    Connect, ConnectProperties, ConnectReturnCode, Login as MqttLogin, Packet,
};
use tokio::{sync::watch, time::timeout};
use tokio_util::codec::Framed;

use super::{
    super::{
        connection::ConnectionFault,
        dial::{Dialler, Stream},
    },
    config::{SESSION_EXPIRY, no_properties},
    framing::{Incoming, PacketCodec},
    held::Memory,
    network_connection::NetworkConnection,
};
use crate::config::{BrokerUrl, LinkLimits, Login};

/// Opens sessions of one user.
pub(super) struct SessionOpener {
    pub dialler: Dialler,
    /// The login at the time of each session.
    pub login: watch::Receiver<Login>,
    pub limits: LinkLimits,
}

impl SessionOpener {
    /// Connects, and takes up the user's session of this name, or its only one.
    pub(super) async fn open(
        &self,
        broker: &BrokerUrl,
        name: Option<&str>,
        memory: Memory,
    ) -> Result<Arc<NetworkConnection>, ConnectionFault> {
        let connecting = async {
            let stream = self.dialler.dial(broker).await?;
            self.start(stream, name, memory).await
        };
        timeout(self.limits.connect_timeout, connecting)
            .await
            .map_err(|_| ConnectionFault::transient(format!("{broker} did not answer in time")))?
    }

    fn packet_bytes_max(&self) -> u32 {
        u32::try_from(self.limits.message_bytes_max).unwrap_or(u32::MAX)
    }

    fn connect_packet(&self, name: Option<&str>) -> Packet {
        let mut properties = ConnectProperties::new();
        properties.session_expiry_interval = u32::try_from(SESSION_EXPIRY.as_secs()).ok();
        properties.receive_maximum =
            Some(u16::try_from(self.limits.credit.max(1)).unwrap_or(u16::MAX));
        properties.max_packet_size = Some(self.packet_bytes_max());
        let Login { user_name, password } = self.login.borrow().clone();
        let connect = Connect {
            keep_alive: u16::try_from(self.limits.idle_timeout.as_secs().max(2))
                .unwrap_or(u16::MAX),
            client_id: client_id(&user_name, name),
            // The session holds what arrived while the link was down.
            clean_start: false,
            properties: Some(properties),
        };
        let login = MqttLogin { username: user_name, password: password.to_string() };
        Packet::Connect(connect, None, Some(login))
    }

    async fn start(
        &self,
        stream: Box<dyn Stream>,
        name: Option<&str>,
        memory: Memory,
    ) -> Result<Arc<NetworkConnection>, ConnectionFault> {
        let mut framed = Framed::new(stream, PacketCodec::new(self.packet_bytes_max()));
        let broken = |e: &dyn std::fmt::Debug| {
            ConnectionFault::transient(format!("the connection could not be opened: {e:?}"))
        };
        framed.send(self.connect_packet(name)).await.map_err(|e| broken(&e))?;
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
        Ok(NetworkConnection::start(framed, &granted, &self.limits, memory))
    }
}

/// Returns the name of a session at the broker: that of its user alone, or one that begins with it.
fn client_id(user_name: &str, name: Option<&str>) -> String {
    name.map_or_else(|| user_name.to_owned(), |name| format!("{user_name}:{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_address_has_a_session_of_its_own() {
        assert_eq!(client_id("platform", None), "platform");
        let of_address = client_id("platform", Some("verbund/v1/factory/f1/ingress"));
        assert_eq!(of_address, "platform:verbund/v1/factory/f1/ingress");
    }
}
