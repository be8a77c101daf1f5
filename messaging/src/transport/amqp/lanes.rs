//! Sender and receiver links, one session each.

use std::collections::HashMap;

use async_trait::async_trait;
use fe2o3_amqp::{
    Receiver, Sendable, Sender,
    link::{RecvError, SendError, delivery::DeliveryInfo, receiver::CreditMode},
    session::SessionHandle,
    types::{
        definitions::{self, ReceiverSettleMode, SenderSettleMode},
        messaging::{self, Body, Source, Target},
        primitives::{Array, Symbol, Value},
    },
};
use futures::FutureExt;
use time::OffsetDateTime;
use tokio::time::timeout;

use super::{
    super::connection::{Incoming, LaneFault, Outcome, OutcomeFuture, Outgoing, Token},
    codec,
    error::{
        receiver_attach_fault, recv_fault, rejection, send_fault, sender_attach_fault, settle_fault,
    },
};
use crate::{
    config::LinkLimits,
    envelope::Envelope,
    inbox::{Delivery, Settlement},
    profile::Terminus,
    spool::Rejection,
};

/// How often in a row the connection's own tasks get a turn to bring more before a batch goes on:
/// storing and settling cost little more for many messages than for one.
const TURNS: u32 = 3;

/// A lane to send to.
pub(super) struct AmqpOutgoing {
    // Before the session: the link detaches first.
    sender: Sender,
    limits: LinkLimits,
    _session: SessionHandle<()>,
}

impl AmqpOutgoing {
    pub(super) async fn attach(
        mut session: SessionHandle<()>,
        terminus: &Terminus,
        limits: &LinkLimits,
    ) -> Result<Self, LaneFault> {
        let target = Target {
            address: Some(terminus.address.clone()),
            capabilities: capabilities(terminus),
            ..Target::default()
        };
        let attaching = Sender::builder()
            .name(link_name("to", terminus))
            .target(target)
            .sender_settle_mode(SenderSettleMode::Unsettled)
            .receiver_settle_mode(ReceiverSettleMode::First)
            .attach(&mut session);
        let sender = timeout(limits.outcome_timeout, attaching)
            .await
            .map_err(|_| {
                LaneFault::Stalled("the broker did not answer an attach in time".to_owned())
            })?
            .map_err(sender_attach_fault)?;
        Ok(Self { sender, limits: *limits, _session: session })
    }
}

#[async_trait]
impl Outgoing for AmqpOutgoing {
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, LaneFault> {
        let message = codec::to_message(envelope, OffsetDateTime::now_utc());
        let sending = self.sender.send_batchable(Sendable::builder().message(message).build());
        let sent = timeout(self.limits.outcome_timeout, sending).await.map_err(|_| {
            LaneFault::Stalled("the broker gave no room for a message in time".to_owned())
        })?;
        let outcome = match sent {
            Ok(outcome) => outcome,
            // Told by the broker beforehand: nothing was sent, the lane is sound.
            Err(SendError::MessageSizeExceeded(_)) => {
                let limit = self.sender.max_message_size().unwrap_or(0);
                let too_large = Rejection {
                    code: "amqp:link:message-size-exceeded".to_owned(),
                    reason: format!("the broker takes at most {limit} bytes"),
                };
                return Ok(futures::future::ready(Ok(Outcome::Rejected(too_large))).boxed());
            }
            Err(error) => return Err(send_fault(error)),
        };
        let wait = self.limits.outcome_timeout;
        Ok(async move {
            match timeout(wait, outcome).await {
                Ok(Ok(outcome)) => Ok(outcome_of(outcome)),
                Ok(Err(error)) => Err(send_fault(error)),
                Err(_) => Err(LaneFault::Stalled(
                    "the broker did not settle a message in time".to_owned(),
                )),
            }
        }
        .boxed())
    }
}

fn outcome_of(outcome: messaging::Outcome) -> Outcome {
    match outcome {
        messaging::Outcome::Accepted(_) => Outcome::Accepted,
        messaging::Outcome::Rejected(rejected) => {
            Outcome::Rejected(rejected.error.as_ref().map_or_else(
                || Rejection {
                    code: "amqp:rejected".to_owned(),
                    reason: "the broker gave no reason".to_owned(),
                },
                rejection,
            ))
        }
        _ => Outcome::Released,
    }
}

/// A lane to receive from.
pub(super) struct AmqpIncoming {
    receiver: Receiver,
    held: HashMap<Token, DeliveryInfo>,
    next_token: u64,
    _session: SessionHandle<()>,
}

impl AmqpIncoming {
    pub(super) async fn attach(
        mut session: SessionHandle<()>,
        terminus: &Terminus,
        limits: &LinkLimits,
    ) -> Result<Self, LaneFault> {
        let source = Source {
            address: Some(terminus.address.clone()),
            capabilities: capabilities(terminus),
            ..Source::default()
        };
        let attaching = Receiver::builder()
            .name(link_name("from", terminus))
            .source(source)
            .receiver_settle_mode(ReceiverSettleMode::First)
            .max_message_size(limits.message_bytes_max)
            .credit_mode(CreditMode::Auto(limits.credit))
            .attach(&mut session);
        let receiver = timeout(limits.outcome_timeout, attaching)
            .await
            .map_err(|_| {
                LaneFault::Stalled("the broker did not answer an attach in time".to_owned())
            })?
            .map_err(receiver_attach_fault)?;
        Ok(Self { receiver, held: HashMap::new(), next_token: 0, _session: session })
    }

    /// Takes a message over, or rejects it at once when it can be nothing for us.
    async fn take(
        &mut self,
        received: Result<fe2o3_amqp::link::delivery::Delivery<Body<Value>>, RecvError>,
    ) -> Result<Option<(Token, Delivery)>, LaneFault> {
        let refused = match received {
            Ok(delivery) => {
                let (info, message) = delivery.into_parts();
                match codec::to_delivery(message, OffsetDateTime::now_utc()) {
                    Ok(delivery) => {
                        self.next_token += 1;
                        let token = Token(self.next_token);
                        self.held.insert(token, info);
                        return Ok(Some((token, delivery)));
                    }
                    Err(refusal) => (info, refusal),
                }
            }
            Err(RecvError::MessageDecode(broken)) => {
                let reason = "the message cannot be decoded".to_owned();
                (broken.info, Rejection { code: "amqp:decode-error".to_owned(), reason })
            }
            Err(error) => return Err(recv_fault(error)),
        };
        let (info, refusal) = refused;
        metrics::counter!("link_messages_rejected_total", "reason" => "form").increment(1);
        tracing::warn!(
            code = refusal.code,
            reason = refusal.reason,
            "a message has a form that cannot be read; it is rejected"
        );
        self.receiver.reject(info, amqp_error(&refusal)).await.map_err(settle_fault)?;
        Ok(None)
    }
}

#[async_trait]
impl Incoming for AmqpIncoming {
    async fn receive(&mut self, limit: usize) -> Result<Vec<(Token, Delivery)>, LaneFault> {
        let mut batch = Vec::new();
        while batch.is_empty() {
            let received = self.receiver.recv::<Body<Value>>().await;
            batch.extend(self.take(received).await?);
        }
        let mut turns_left = TURNS;
        while batch.len() < limit {
            let Some(received) = self.receiver.recv::<Body<Value>>().now_or_never() else {
                if turns_left == 0 {
                    break;
                }
                turns_left -= 1;
                tokio::task::yield_now().await;
                continue;
            };
            turns_left = TURNS;
            match self.take(received).await {
                Ok(next) => batch.extend(next),
                // What has arrived is delivered first; the fault shows again with the next call.
                Err(_) => break,
            }
        }
        Ok(batch)
    }

    async fn settle(&mut self, settlements: Vec<(Token, Settlement)>) -> Result<(), LaneFault> {
        let mut accepted = Vec::with_capacity(settlements.len());
        let mut released = Vec::new();
        for (token, settlement) in settlements {
            let Some(info) = self.held.remove(&token) else { continue };
            match settlement {
                Settlement::Accept => accepted.push(info),
                Settlement::Release => released.push(info),
                Settlement::Reject(reason) => {
                    self.receiver.reject(info, amqp_error(&reason)).await.map_err(settle_fault)?;
                }
            }
        }
        if !accepted.is_empty() {
            self.receiver.accept_all(accepted).await.map_err(settle_fault)?;
        }
        if !released.is_empty() {
            // Never modified: some brokers end the session over it.
            self.receiver.release_all(released).await.map_err(settle_fault)?;
        }
        Ok(())
    }

    async fn leave(&mut self) {
        // The queue is not ours; detaching with the drop is all.
    }
}

fn amqp_error(rejection: &Rejection) -> definitions::Error {
    let condition = Symbol::from(rejection.code.as_str());
    definitions::Error::new(
        definitions::ErrorCondition::Custom(condition),
        rejection.reason.clone(),
        None,
    )
}

/// Unique per attempt: a broker may still hold a link of the same name from a connection that we
/// gave up.
fn link_name(direction: &str, terminus: &Terminus) -> String {
    format!("{direction} {} {}", terminus.address, uuid::Uuid::new_v4().simple())
}

fn capabilities(terminus: &Terminus) -> Option<Array<Symbol>> {
    terminus
        .capability
        .as_ref()
        .map(|capability| Array::from(vec![Symbol::from(capability.as_str())]))
}
