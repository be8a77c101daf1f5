//! The receiver: an AMQP receiver link in a session of its own.

use std::collections::HashMap;

use async_trait::async_trait;
use fe2o3_amqp::{
    Receiver,
    link::{RecvError, delivery::DeliveryInfo, receiver::CreditMode},
    session::SessionHandle,
    types::{
        definitions::{self, ReceiverSettleMode},
        messaging::{Body, Source},
        primitives::{Symbol, Value},
    },
};
use futures::FutureExt;
use tokio::time::timeout;

use super::{
    super::connection::{DeliveryToken, EndpointFault, MessageReceiver},
    codec,
    error::{receiver_attach_fault, recv_fault, settle_fault},
    terminus::{capabilities, link_name},
};
use crate::{
    clock,
    config::LinkLimits,
    inbox::{Delivery, Settlement},
    profile::Terminus,
    spool::Rejection,
};

/// Turns in a row that the connection's own tasks get to receive more before a batch goes on:
/// storing and settling cost little more for many messages than for one.
const TURNS: u32 = 3;

/// Times the largest message accepted that a broker may send. What is larger than accepted is
/// rejected with its reason, so that the broker need not offer it again; what is larger than this
/// ends the link.
const OVERSIZE_FACTOR: u64 = 4;
/// Frames that may wait for a receiver.
const FRAMES_BUFFERED: usize = 256;

/// A receiver link with its session.
pub(super) struct AmqpReceiver {
    receiver: Receiver,
    message_bytes_max: u64,
    /// Messages that are not settled yet.
    unsettled: HashMap<DeliveryToken, DeliveryInfo>,
    next_token: u64,
    // After the receiver: fields drop in order, and the link must detach first.
    _session: SessionHandle<()>,
}

impl AmqpReceiver {
    pub(super) async fn attach(
        mut session: SessionHandle<()>,
        terminus: &Terminus,
        limits: &LinkLimits,
    ) -> Result<Self, EndpointFault> {
        let source = Source {
            address: Some(terminus.address.clone()),
            capabilities: capabilities(terminus),
            ..Source::default()
        };
        let attaching = Receiver::builder()
            .name(link_name("from", terminus))
            .source(source)
            .receiver_settle_mode(ReceiverSettleMode::First)
            .max_message_size(limits.message_bytes_max.saturating_mul(OVERSIZE_FACTOR))
            .buffer_size(FRAMES_BUFFERED)
            .credit_mode(CreditMode::Auto(limits.credit))
            .attach(&mut session);
        let receiver = timeout(limits.outcome_timeout, attaching)
            .await
            .map_err(|_| {
                EndpointFault::Stalled("the broker did not answer an attach in time".to_owned())
            })?
            .map_err(receiver_attach_fault)?;
        let message_bytes_max = limits.message_bytes_max;
        let unsettled = HashMap::new();
        Ok(Self { receiver, message_bytes_max, unsettled, next_token: 0, _session: session })
    }

    /// Converts a message, or rejects it at once when it cannot be read.
    async fn accept_or_reject(
        &mut self,
        received: Result<fe2o3_amqp::link::delivery::Delivery<Body<Value>>, RecvError>,
    ) -> Result<Option<(DeliveryToken, Delivery)>, EndpointFault> {
        let rejected = match received {
            Ok(delivery) => {
                let (info, message) = delivery.into_parts();
                match codec::to_delivery(message, clock::now(), self.message_bytes_max) {
                    Ok(delivery) => {
                        self.next_token += 1;
                        let token = DeliveryToken(self.next_token);
                        self.unsettled.insert(token, info);
                        return Ok(Some((token, delivery)));
                    }
                    Err(rejection) => (info, rejection),
                }
            }
            Err(RecvError::MessageDecode(broken)) => {
                let reason = "the message cannot be decoded".to_owned();
                (broken.info, Rejection { code: "amqp:decode-error".to_owned(), reason })
            }
            Err(error) => return Err(recv_fault(error)),
        };
        let (info, rejection) = rejected;
        metrics::counter!("link_messages_rejected_total", "reason" => "form").increment(1);
        tracing::warn!(
            code = rejection.code,
            reason = rejection.reason,
            "A received message cannot be read and is rejected."
        );
        self.receiver.reject(info, amqp_error(&rejection)).await.map_err(settle_fault)?;
        Ok(None)
    }
}

#[async_trait]
impl MessageReceiver for AmqpReceiver {
    async fn receive(
        &mut self,
        limit: usize,
    ) -> Result<Vec<(DeliveryToken, Delivery)>, EndpointFault> {
        let mut batch = Vec::new();
        while batch.is_empty() {
            let received = self.receiver.recv::<Body<Value>>().await;
            batch.extend(self.accept_or_reject(received).await?);
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
            match self.accept_or_reject(received).await {
                Ok(next) => batch.extend(next),
                // The batch is delivered first; the fault shows again with the next call.
                Err(_) => break,
            }
        }
        Ok(batch)
    }

    async fn settle(
        &mut self,
        settlements: Vec<(DeliveryToken, Settlement)>,
    ) -> Result<(), EndpointFault> {
        let mut accepted = Vec::with_capacity(settlements.len());
        let mut released = Vec::new();
        for (token, settlement) in settlements {
            let Some(info) = self.unsettled.remove(&token) else { continue };
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
            // Never `modified`: some brokers end the session over it.
            self.receiver.release_all(released).await.map_err(settle_fault)?;
        }
        Ok(())
    }

    async fn leave(&mut self) {
        // The broker owns the queue. The link detaches when it is dropped.
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
