//! The subscriber: receives the messages of one address.

use std::{collections::HashMap, sync::Arc};

use async_trait::async_trait;
use rumqttc::v5::mqttbytes::{
    QoS,
    v5::{
        Filter, Packet, PubAck, PubAckReason, Publish, RetainForwardRule, Subscribe,
        SubscribeReasonCode,
    },
};
use tokio::{sync::mpsc, time::timeout};

use super::{
    super::connection::{DeliveryToken, EndpointFault, MessageReceiver},
    codec,
    network_connection::{NetworkConnection, broken},
};
use crate::{
    clock,
    config::LinkLimits,
    inbox::{Delivery, Settlement},
    spool::Rejection,
};

/// A subscription to the live and the replay topic of an address.
pub(super) struct MqttSubscriber {
    network: Arc<NetworkConnection>,
    topics: Vec<String>,
    arrived: mpsc::Receiver<Publish>,
    /// Packet identifiers of the messages that are not acknowledged yet.
    unsettled: HashMap<DeliveryToken, u16>,
    next_token: u64,
}

impl MqttSubscriber {
    pub(super) async fn subscribe(
        network: Arc<NetworkConnection>,
        topic: String,
        limits: &LinkLimits,
    ) -> Result<Self, EndpointFault> {
        let topics = vec![topic.clone(), format!("{topic}{}", codec::REPLAY)];
        let (subscriber, arrived) = mpsc::channel(network.receive_max);
        let filters: Vec<_> = topics
            .iter()
            .map(|topic| {
                let mut filter = Filter::new(topic.clone(), QoS::AtLeastOnce);
                // A retained message would arrive again with each subscription.
                filter.retain_forward_rule = RetainForwardRule::Never;
                filter
            })
            .collect();
        let packet = |id| {
            let mut subscribe = Subscribe::new_many(filters, None);
            subscribe.pkid = id;
            Packet::Subscribe(subscribe)
        };
        let answer = network.subscribe(&topics, &subscriber, packet).await?;
        let subscription =
            Self { network, topics, arrived, unsettled: HashMap::new(), next_token: 0 };
        let codes = timeout(limits.outcome_timeout, answer)
            .await
            .map_err(|_| {
                EndpointFault::Stalled(
                    "the broker did not answer a subscription in time".to_owned(),
                )
            })?
            .map_err(|_| broken())?;
        // The second topic is for replay, which only some senders have. The broker may refuse it.
        match codes.first() {
            Some(SubscribeReasonCode::Success(_)) => Ok(subscription),
            Some(SubscribeReasonCode::NotAuthorized) => {
                Err(refused("amqp:unauthorized-access", &topic))
            }
            code => Err(refused("amqp:not-allowed", &format!("{topic}: {code:?}"))),
        }
    }

    /// Converts a message, or rejects it at once when it cannot be read.
    async fn accept_or_reject(
        &mut self,
        publish: Publish,
    ) -> Result<Option<(DeliveryToken, Delivery)>, EndpointFault> {
        let (id, qos) = (publish.pkid, publish.qos);
        match codec::to_delivery(publish, clock::now()) {
            Ok(delivery) => {
                self.next_token += 1;
                let token = DeliveryToken(self.next_token);
                if qos != QoS::AtMostOnce {
                    self.unsettled.insert(token, id);
                }
                Ok(Some((token, delivery)))
            }
            Err(rejection) => {
                tracing::warn!(
                    code = rejection.code,
                    reason = rejection.reason,
                    "A received message cannot be read and is rejected."
                );
                if qos != QoS::AtMostOnce {
                    self.reject(id).await?;
                }
                Ok(None)
            }
        }
    }

    async fn reject(&self, id: u16) -> Result<(), EndpointFault> {
        let mut rejection = PubAck::new(id, None);
        rejection.reason = PubAckReason::PayloadFormatInvalid;
        self.network.acknowledge(rejection).await
    }
}

fn refused(code: &str, reason: &str) -> EndpointFault {
    EndpointFault::Refused(Rejection { code: code.to_owned(), reason: reason.to_owned() })
}

#[async_trait]
impl MessageReceiver for MqttSubscriber {
    async fn receive(
        &mut self,
        limit: usize,
    ) -> Result<Vec<(DeliveryToken, Delivery)>, EndpointFault> {
        let mut batch = Vec::new();
        while batch.is_empty() {
            // `publish` is lost when this future is dropped during `accept_or_reject`. That waits
            // only to reject, and the broker delivers an unacknowledged message again.
            let publish = tokio::select! {
                publish = self.arrived.recv() => publish.ok_or_else(broken)?,
                _ = self.network.lost() => return Err(broken()),
            };
            batch.extend(self.accept_or_reject(publish).await?);
        }
        while batch.len() < limit
            && let Ok(publish) = self.arrived.try_recv()
        {
            batch.extend(self.accept_or_reject(publish).await?);
        }
        Ok(batch)
    }

    async fn settle(
        &mut self,
        settlements: Vec<(DeliveryToken, Settlement)>,
    ) -> Result<(), EndpointFault> {
        let mut is_released = false;
        for (token, settlement) in settlements {
            let Some(id) = self.unsettled.remove(&token) else { continue };
            match settlement {
                Settlement::Accept => self.network.acknowledge(PubAck::new(id, None)).await?,
                Settlement::Reject(_) => self.reject(id).await?,
                Settlement::Release => is_released = true,
            }
        }
        if is_released {
            return Err(EndpointFault::Stalled(
                "messages could not be stored; the broker is to deliver them again".to_owned(),
            ));
        }
        Ok(())
    }

    async fn leave(&mut self) {
        let topics = std::mem::take(&mut self.topics);
        self.network.forget(&topics);
        self.network.unsubscribe(topics).await;
    }
}

impl Drop for MqttSubscriber {
    fn drop(&mut self) {
        // The broker keeps the subscription and stores new messages while the link is down.
        self.network.forget(&self.topics);
    }
}
