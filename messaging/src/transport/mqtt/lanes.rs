//! Topics to publish to and subscriptions to read.

use std::{collections::HashMap, sync::Arc};

use async_trait::async_trait;
use futures::FutureExt;
use rumqttc::v5::mqttbytes::{
    QoS,
    v5::{
        Filter, Packet, PubAck, PubAckReason, Publish, RetainForwardRule, Subscribe,
        SubscribeReasonCode,
    },
};
use time::OffsetDateTime;
use tokio::{sync::mpsc, time::timeout};

use super::{
    super::connection::{Incoming, LaneFault, Outcome, OutcomeFuture, Outgoing, Token},
    codec,
    wire::{Wire, broken},
};
use crate::{
    config::LinkLimits,
    envelope::Envelope,
    inbox::{Delivery, Settlement},
    spool::Rejection,
};

/// A topic to publish to.
pub(super) struct MqttOutgoing {
    wire: Arc<Wire>,
    topic: String,
    limits: LinkLimits,
}

impl MqttOutgoing {
    pub(super) const fn new(wire: Arc<Wire>, topic: String, limits: LinkLimits) -> Self {
        Self { wire, topic, limits }
    }
}

#[async_trait]
impl Outgoing for MqttOutgoing {
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, LaneFault> {
        let publish = codec::to_publish(&self.topic, envelope, OffsetDateTime::now_utc());
        if let Some(limit) = self.wire.packet_bytes_max
            && publish.size() > limit as usize
        {
            let reason = format!("the broker takes at most {limit} bytes");
            let too_large =
                Rejection { code: "amqp:link:message-size-exceeded".to_owned(), reason };
            return Ok(futures::future::ready(Ok(Outcome::Rejected(too_large))).boxed());
        }
        let wait = self.limits.outcome_timeout;
        let acknowledgement = timeout(wait, self.wire.publish(publish)).await.map_err(|_| {
            LaneFault::Stalled("the broker gave no room for a message in time".to_owned())
        })??;
        Ok(async move {
            match timeout(wait, acknowledgement).await {
                Ok(Ok(acknowledgement)) => Ok(outcome_of(acknowledgement)),
                Ok(Err(_)) => Err(broken()),
                Err(_) => Err(LaneFault::Stalled(
                    "the broker did not acknowledge a message in time".to_owned(),
                )),
            }
        }
        .boxed())
    }
}

fn outcome_of(acknowledgement: PubAck) -> Outcome {
    let told = acknowledgement.properties.and_then(|p| p.reason_string);
    let reason = told.unwrap_or_else(|| format!("{:?}", acknowledgement.reason));
    let rejected = |code: &str| Outcome::Rejected(Rejection { code: code.to_owned(), reason });
    match acknowledgement.reason {
        PubAckReason::Success => Outcome::Accepted,
        // Nobody has a session for it yet, so the broker kept nothing.
        PubAckReason::NoMatchingSubscribers => Outcome::Released,
        PubAckReason::NotAuthorized => rejected("amqp:unauthorized-access"),
        PubAckReason::QuotaExceeded => rejected("amqp:resource-limit-exceeded"),
        PubAckReason::TopicNameInvalid => rejected("amqp:not-found"),
        PubAckReason::PayloadFormatInvalid => rejected("amqp:decode-error"),
        PubAckReason::UnspecifiedError
        | PubAckReason::ImplementationSpecificError
        | PubAckReason::PacketIdentifierInUse => rejected("amqp:internal-error"),
    }
}

/// A subscription.
pub(super) struct MqttIncoming {
    wire: Arc<Wire>,
    topics: Vec<String>,
    arrived: mpsc::Receiver<Publish>,
    held: HashMap<Token, u16>,
    next_token: u64,
}

impl MqttIncoming {
    pub(super) async fn subscribe(
        wire: Arc<Wire>,
        topic: String,
        limits: &LinkLimits,
    ) -> Result<Self, LaneFault> {
        let topics = vec![topic.clone(), format!("{topic}{}", codec::REPLAY)];
        let (lane, arrived) = mpsc::channel(wire.receive_max);
        let filters: Vec<_> = topics
            .iter()
            .map(|topic| {
                let mut filter = Filter::new(topic.clone(), QoS::AtLeastOnce);
                filter.retain_forward_rule = RetainForwardRule::Never;
                filter
            })
            .collect();
        let packet = |id| {
            let mut subscribe = Subscribe::new_many(filters, None);
            subscribe.pkid = id;
            Packet::Subscribe(subscribe)
        };
        let answer = wire.subscribe(&topics, &lane, packet).await?;
        let incoming = Self { wire, topics, arrived, held: HashMap::new(), next_token: 0 };
        let codes = timeout(limits.outcome_timeout, answer)
            .await
            .map_err(|_| {
                LaneFault::Stalled("the broker did not answer a subscription in time".to_owned())
            })?
            .map_err(|_| broken())?;
        // The second topic is for backlogs, which only some senders have; it may be closed to us.
        match codes.first() {
            Some(SubscribeReasonCode::Success(_)) => Ok(incoming),
            Some(SubscribeReasonCode::NotAuthorized) => {
                Err(refused("amqp:unauthorized-access", &topic))
            }
            code => Err(refused("amqp:not-allowed", &format!("{topic}: {code:?}"))),
        }
    }

    /// Takes a message over; one that can be nothing for us is refused at once.
    async fn take(&mut self, publish: Publish) -> Result<Option<(Token, Delivery)>, LaneFault> {
        let (id, qos) = (publish.pkid, publish.qos);
        match codec::to_delivery(publish, OffsetDateTime::now_utc()) {
            Ok(delivery) => {
                self.next_token += 1;
                let token = Token(self.next_token);
                if qos != QoS::AtMostOnce {
                    self.held.insert(token, id);
                }
                Ok(Some((token, delivery)))
            }
            Err(refusal) => {
                tracing::warn!(
                    code = refusal.code,
                    reason = refusal.reason,
                    "a message has a form that cannot be read; it is rejected"
                );
                if qos != QoS::AtMostOnce {
                    self.refuse(id).await?;
                }
                Ok(None)
            }
        }
    }

    async fn refuse(&self, id: u16) -> Result<(), LaneFault> {
        let mut refusal = PubAck::new(id, None);
        refusal.reason = PubAckReason::PayloadFormatInvalid;
        self.wire.acknowledge(refusal).await
    }
}

fn refused(code: &str, reason: &str) -> LaneFault {
    LaneFault::Refused(Rejection { code: code.to_owned(), reason: reason.to_owned() })
}

#[async_trait]
impl Incoming for MqttIncoming {
    async fn receive(&mut self, limit: usize) -> Result<Vec<(Token, Delivery)>, LaneFault> {
        let mut batch = Vec::new();
        while batch.is_empty() {
            // `publish` is lost when this future is dropped during `take`; that waits only for
            // refusals, and an unacknowledged message comes again.
            let publish = tokio::select! {
                publish = self.arrived.recv() => publish.ok_or_else(broken)?,
                _ = self.wire.lost() => return Err(broken()),
            };
            batch.extend(self.take(publish).await?);
        }
        while batch.len() < limit
            && let Ok(publish) = self.arrived.try_recv()
        {
            batch.extend(self.take(publish).await?);
        }
        Ok(batch)
    }

    async fn settle(&mut self, settlements: Vec<(Token, Settlement)>) -> Result<(), LaneFault> {
        let mut is_released = false;
        for (token, settlement) in settlements {
            let Some(id) = self.held.remove(&token) else { continue };
            match settlement {
                Settlement::Accept => self.wire.acknowledge(PubAck::new(id, None)).await?,
                Settlement::Reject(_) => self.refuse(id).await?,
                Settlement::Release => is_released = true,
            }
        }
        if is_released {
            return Err(LaneFault::Stalled(
                "messages could not be stored and are asked for again".to_owned(),
            ));
        }
        Ok(())
    }

    async fn leave(&mut self) {
        let topics = std::mem::take(&mut self.topics);
        self.wire.forget(&topics);
        self.wire.unsubscribe(topics).await;
    }
}

impl Drop for MqttIncoming {
    fn drop(&mut self) {
        // The subscription stays, so that the broker keeps what comes while we are away.
        self.wire.forget(&self.topics);
    }
}
