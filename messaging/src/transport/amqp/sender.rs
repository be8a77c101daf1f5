//! The sender: an AMQP sender link in a session of its own.

use async_trait::async_trait;
use fe2o3_amqp::{
    Sendable, Sender,
    link::{DetachError, SendError, SessionStopReason},
    session::SessionHandle,
    types::{
        definitions::{ReceiverSettleMode, SenderSettleMode},
        messaging::{self, Target},
    },
};
use futures::FutureExt;
use tokio::time::timeout;

use super::{
    super::connection::{BrokerOutcome, EndpointFault, MessageSender, OutcomeFuture},
    codec,
    error::{rejection, send_fault, sender_attach_fault, state_fault},
    terminus::{capabilities, link_name},
};
use crate::{clock, config::LinkLimits, envelope::Envelope, profile::Terminus, spool::Rejection};

/// A sender link with its session.
pub(super) struct AmqpSender {
    // Declared before the session: fields drop in order, and the link must detach first.
    sender: Sender,
    limits: LinkLimits,
    _session: SessionHandle<()>,
}

impl AmqpSender {
    pub(super) async fn attach(
        mut session: SessionHandle<()>,
        terminus: &Terminus,
        limits: &LinkLimits,
    ) -> Result<Self, EndpointFault> {
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
                EndpointFault::Stalled("the broker did not answer an attach in time".to_owned())
            })?
            .map_err(sender_attach_fault)?;
        Ok(Self { sender, limits: *limits, _session: session })
    }
}

#[async_trait]
impl MessageSender for AmqpSender {
    async fn send(&mut self, envelope: &Envelope) -> Result<OutcomeFuture, EndpointFault> {
        let message = codec::to_message(envelope, clock::now());
        let sending = self.sender.send_batchable(Sendable::builder().message(message).build());
        let sent = timeout(self.limits.outcome_timeout, sending).await.map_err(|_| {
            EndpointFault::Stalled("the broker granted no credit for a message in time".to_owned())
        })?;
        let outcome = match sent {
            Ok(outcome) => outcome,
            // The broker announced its limit: nothing was sent, and the link works.
            Err(SendError::MessageSizeExceeded(_)) => {
                let limit = self.sender.max_message_size().unwrap_or(0);
                let too_large = Rejection {
                    code: "amqp:link:message-size-exceeded".to_owned(),
                    reason: format!("the broker accepts at most {limit} bytes"),
                };
                return Ok(futures::future::ready(Ok(BrokerOutcome::Rejected(too_large))).boxed());
            }
            Err(error) => return Err(send_fault(error)),
        };
        let wait = self.limits.outcome_timeout;
        Ok(async move {
            match timeout(wait, outcome).await {
                Ok(Ok(outcome)) => Ok(outcome_of(outcome)),
                Ok(Err(error)) => Err(send_fault(error)),
                Err(_) => Err(EndpointFault::Stalled(
                    "the broker did not settle a message in time".to_owned(),
                )),
            }
        }
        .boxed())
    }

    async fn ended(&mut self) -> EndpointFault {
        match self.sender.on_detach().await {
            // Some brokers end the whole session where they end its link.
            DetachError::SessionStopped(SessionStopReason::RemoteEndedWithError(error)) => {
                EndpointFault::Refused(rejection(&error))
            }
            DetachError::SessionStopped(_) | DetachError::IllegalState => {
                std::future::pending().await
            }
            error => state_fault(error.into()),
        }
    }
}

fn outcome_of(outcome: messaging::Outcome) -> BrokerOutcome {
    match outcome {
        messaging::Outcome::Accepted(_) => BrokerOutcome::Accepted,
        messaging::Outcome::Rejected(rejected) => {
            BrokerOutcome::Rejected(rejected.error.as_ref().map_or_else(
                || Rejection {
                    code: "amqp:rejected".to_owned(),
                    reason: "the broker gave no reason".to_owned(),
                },
                rejection,
            ))
        }
        // Released or modified: the broker does not keep it, so it is sent again.
        _ => BrokerOutcome::Released,
    }
}
