//! The publisher: sends messages to one topic.

use std::sync::Arc;

use async_trait::async_trait;
use futures::FutureExt;
use rumqttc::v5::mqttbytes::v5::{PubAck, PubAckReason};
use tokio::time::timeout;

use super::{
    super::connection::{BrokerOutcome, EndpointFault, MessageSender, OutcomeFuture},
    codec,
    network_connection::{NetworkConnection, broken},
};
use crate::{clock, config::LinkLimits, envelope::Envelope, spool::Rejection};

/// A topic of a connection.
pub(super) struct MqttPublisher {
    network: Arc<NetworkConnection>,
    topic: String,
    limits: LinkLimits,
}

impl MqttPublisher {
    pub(super) const fn new(
        network: Arc<NetworkConnection>,
        topic: String,
        limits: LinkLimits,
    ) -> Self {
        Self { network, topic, limits }
    }
}

#[async_trait]
impl MessageSender for MqttPublisher {
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, EndpointFault> {
        let publish = codec::to_publish(&self.topic, envelope, clock::now());
        // Before it is sent: a broker may end the connection over a packet that is too large.
        if let Some(limit) = self.network.packet_bytes_max
            && publish.size() > limit as usize
        {
            let reason = format!("the broker accepts at most {limit} bytes");
            let too_large =
                Rejection { code: "amqp:link:message-size-exceeded".to_owned(), reason };
            return Ok(futures::future::ready(Ok(BrokerOutcome::Rejected(too_large))).boxed());
        }
        let wait = self.limits.outcome_timeout;
        let acknowledgement =
            timeout(wait, self.network.publish(publish)).await.map_err(|_| {
                EndpointFault::Stalled(
                    "the broker granted no credit for a message in time".to_owned(),
                )
            })??;
        Ok(async move {
            match timeout(wait, acknowledgement).await {
                Ok(Ok(acknowledgement)) => Ok(outcome_of(acknowledgement)),
                Ok(Err(_)) => Err(broken()),
                Err(_) => Err(EndpointFault::Stalled(
                    "the broker did not acknowledge a message in time".to_owned(),
                )),
            }
        }
        .boxed())
    }

    async fn ended(&mut self) -> EndpointFault {
        // A topic has no endpoint of its own.
        std::future::pending().await
    }
}

fn outcome_of(acknowledgement: PubAck) -> BrokerOutcome {
    let reason_string = acknowledgement.properties.and_then(|p| p.reason_string);
    let reason = reason_string.unwrap_or_else(|| format!("{:?}", acknowledgement.reason));
    let rejected =
        |code: &str| BrokerOutcome::Rejected(Rejection { code: code.to_owned(), reason });
    match acknowledgement.reason {
        PubAckReason::Success => BrokerOutcome::Accepted,
        // No client has a session for the topic yet, so the broker stored nothing.
        PubAckReason::NoMatchingSubscribers => BrokerOutcome::Released,
        PubAckReason::NotAuthorized => rejected("amqp:unauthorized-access"),
        PubAckReason::QuotaExceeded => rejected("amqp:resource-limit-exceeded"),
        PubAckReason::TopicNameInvalid => rejected("amqp:not-found"),
        PubAckReason::PayloadFormatInvalid => rejected("amqp:decode-error"),
        PubAckReason::UnspecifiedError
        | PubAckReason::ImplementationSpecificError
        | PubAckReason::PacketIdentifierInUse => rejected("amqp:internal-error"),
    }
}
