//! The subscriber: receives the messages of one address.

use std::{collections::HashMap, sync::Arc};

use async_trait::async_trait;
use rumqttc::v5::mqttbytes::{
    QoS,
    v5::{Filter, Packet, PubAck, PubAckReason, RetainForwardRule, Subscribe, SubscribeReasonCode},
};
use tokio::{
    sync::{mpsc, oneshot},
    time::timeout,
};

use super::{
    super::connection::{DeliveryToken, EndpointFault, MessageReceiver},
    codec,
    config::CLOSE_TIMEOUT,
    held::{Held, HeldMemory},
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
    /// True where the session is for this address alone, and ends its connection with it.
    is_alone: bool,
    topics: Vec<String>,
    arrived: mpsc::Receiver<Held>,
    answer: Answer,
    /// Messages that are handed out and not settled yet.
    unsettled: HashMap<DeliveryToken, Unsettled>,
    next_token: u64,
}

/// The broker's answer to a subscription.
struct Answer {
    /// None once it has come.
    awaited: Option<oneshot::Receiver<Vec<SubscribeReasonCode>>>,
    topic: String,
}

impl Answer {
    /// Waits for the answer; for ever once it has come.
    async fn wait(&mut self) -> Result<(), EndpointFault> {
        let Some(awaited) = &mut self.awaited else { return std::future::pending().await };
        let codes = awaited.await;
        self.awaited = None;
        // The second topic is for replay, which only some senders have. The broker may refuse it.
        match codes.map_err(|_| broken())?.first() {
            Some(SubscribeReasonCode::Success(_)) => Ok(()),
            Some(SubscribeReasonCode::NotAuthorized) => {
                Err(refused("amqp:unauthorized-access", &self.topic))
            }
            code => Err(refused("amqp:not-allowed", &format!("{}: {code:?}", self.topic))),
        }
    }
}

struct Unsettled {
    /// Packet identifier; none of a message that asks for no acknowledgement.
    id: Option<u16>,
    _memory: HeldMemory,
}

impl MqttSubscriber {
    /// Subscribes. A broker may send what its session holds before its answer, and more than there
    /// is memory for: the answer is then awaited while messages are received.
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
        let mut subscription = Self {
            network: Arc::clone(&network),
            is_alone: false,
            topics,
            arrived,
            answer: Answer { awaited: Some(answer), topic },
            unsettled: HashMap::new(),
            next_token: 0,
        };
        tokio::select! {
            answered = timeout(limits.outcome_timeout, subscription.answer.wait()) => {
                answered.map_err(|_| {
                    EndpointFault::Stalled(
                        "the broker did not answer a subscription in time".to_owned(),
                    )
                })??;
            }
            () = network.congested() => {}
        }
        Ok(subscription)
    }

    /// Subscribes in a session that is for this address alone.
    pub(super) async fn subscribe_alone(
        network: Arc<NetworkConnection>,
        topic: String,
        limits: &LinkLimits,
    ) -> Result<Self, EndpointFault> {
        let subscribed = Self::subscribe(Arc::clone(&network), topic, limits).await;
        let mut subscriber =
            subscribed.inspect_err(|_| network.close()).map_err(|fault| match fault {
                // It is this session's: the other addresses go on.
                EndpointFault::Stalled(reason) => EndpointFault::Broken(reason),
                fault => fault,
            })?;
        subscriber.is_alone = true;
        Ok(subscriber)
    }

    /// Converts a message, or rejects it at once when it cannot be read.
    async fn accept_or_reject(
        &mut self,
        Held { publish, memory }: Held,
    ) -> Result<Option<(DeliveryToken, Delivery)>, EndpointFault> {
        let id = (publish.qos != QoS::AtMostOnce).then_some(publish.pkid);
        match codec::to_delivery(publish, clock::now()) {
            Ok(delivery) => {
                self.next_token += 1;
                let token = DeliveryToken(self.next_token);
                self.unsettled.insert(token, Unsettled { id, _memory: memory });
                Ok(Some((token, delivery)))
            }
            Err(rejection) => {
                tracing::warn!(
                    code = rejection.code,
                    reason = rejection.reason,
                    "A received message cannot be read and is rejected."
                );
                if let Some(id) = id {
                    self.reject(id).await?;
                }
                Ok(None)
            }
        }
    }

    /// Waits until the broker has what was settled, for a moment: what is still to be written when the connection is
    /// closed may not be.
    async fn write_out(&self) {
        if self.is_alone {
            let _ = timeout(CLOSE_TIMEOUT, self.network.answers()).await;
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
            // `held` is lost when this future is dropped during `accept_or_reject`. That waits
            // only to reject, and the broker delivers an unacknowledged message again.
            let held = tokio::select! {
                held = self.arrived.recv() => held.ok_or_else(broken)?,
                answered = self.answer.wait() => {
                    answered?;
                    continue;
                }
                _ = self.network.lost() => return Err(broken()),
            };
            batch.extend(self.accept_or_reject(held).await?);
        }
        while batch.len() < limit
            && let Ok(held) = self.arrived.try_recv()
        {
            batch.extend(self.accept_or_reject(held).await?);
        }
        Ok(batch)
    }

    async fn settle(
        &mut self,
        settlements: Vec<(DeliveryToken, Settlement)>,
    ) -> Result<(), EndpointFault> {
        let mut is_released = false;
        for (token, settlement) in settlements {
            let Some(Unsettled { id, .. }) = self.unsettled.remove(&token) else { continue };
            match (id, settlement) {
                // The broker does not wait for the outcome of such a message.
                (None, _) => {}
                (Some(id), Settlement::Accept) => {
                    self.network.acknowledge(PubAck::new(id, None)).await?;
                }
                (Some(id), Settlement::Reject(_)) => self.reject(id).await?,
                (Some(_), Settlement::Release) => is_released = true,
            }
        }
        if is_released {
            self.write_out().await;
            let reason = "messages could not be stored; the broker is to deliver them again";
            // Only a reconnect makes it do so, which other addresses feel where they have the same session.
            let fault = if self.is_alone { EndpointFault::Broken } else { EndpointFault::Stalled };
            return Err(fault(reason.to_owned()));
        }
        Ok(())
    }

    async fn leave(&mut self) {
        let topics = std::mem::take(&mut self.topics);
        self.network.forget(&topics);
        self.network.unsubscribe(topics).await;
        self.write_out().await;
    }
}

impl Drop for MqttSubscriber {
    fn drop(&mut self) {
        // The broker keeps the subscription and stores new messages while the link is down.
        self.network.forget(&self.topics);
        if self.is_alone {
            self.network.close();
        }
    }
}
