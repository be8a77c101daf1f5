//! Transports: connections to brokers over AMQP 1.0 and MQTT 5, behind one set of traits.

mod amqp;
mod connection;
mod dial;
mod mqtt;
mod tls;

use tokio::sync::watch;

#[cfg(feature = "test-support")]
pub use mqtt::read_mqtt;

use crate::config::{BrokerUrl, LinkConfig, LinkError, Login};

#[cfg(test)]
pub(crate) use connection::OutcomeFuture;
pub(crate) use connection::{
    BrokerOutcome, Connection, ConnectionFault, DeliveryToken, EndpointFault, MessageReceiver,
    MessageSender, Transport,
};

/// Chooses the transport for the configured brokers.
/// The login is that of the time of each connection.
pub(crate) fn new(
    config: &LinkConfig,
    login: watch::Receiver<Login>,
) -> Result<Box<dyn Transport>, LinkError> {
    let is_encrypted = config.brokers.iter().any(BrokerUrl::is_encrypted);
    let client = is_encrypted.then(|| tls::client_config(&config.tls)).transpose()?;
    let dialler = dial::Dialler {
        client,
        tls: config.tls.clone(),
        proxy: config.proxy.clone(),
        stall_timeout: config.limits.stall_timeout,
        message_bytes_max: config.limits.message_bytes_max,
    };
    let mqtt = config.brokers.iter().filter(|broker| broker.is_mqtt()).count();
    if mqtt == 0 {
        Ok(Box::new(amqp::AmqpTransport::new(config, login, dialler)))
    } else if mqtt == config.brokers.len() {
        Ok(Box::new(mqtt::MqttTransport::new(config, login, dialler)))
    } else {
        Err(LinkError::MixedProtocols)
    }
}
