//! Takes messages from a publisher: stored first, then accepted.

use std::sync::Arc;

use fe2o3_amqp::{
    Receiver,
    link::{RecvError, delivery::DeliveryInfo, receiver::CreditMode},
    types::{
        definitions::{self, AmqpError},
        messaging::Body,
        primitives::Value,
    },
};
use futures::{FutureExt, StreamExt, stream::FuturesOrdered};
use tokio::sync::oneshot;
use tokio_util::sync::CancellationToken;
use tracing::debug;

use crate::{
    connection::error,
    core::Core,
    message,
    queue::{Entry, Queue, Refusal},
    store::{Command, NewMessage, WriteFailed},
};

/// Settlements sent in one go.
const SETTLED_AT_ONCE: usize = 256;

type Stored = futures::future::Map<
    oneshot::Receiver<Result<(), WriteFailed>>,
    Box<
        dyn FnOnce(
                Result<Result<(), WriteFailed>, oneshot::error::RecvError>,
            ) -> (DeliveryInfo, bool)
            + Send,
    >,
>;

/// Serves a publisher until it leaves.
pub(crate) async fn ingest(
    core: Arc<Core>,
    queue: Arc<Queue>,
    user_name: Arc<str>,
    mut receiver: Receiver,
    cut: CancellationToken,
) {
    let credit = core.config.limits.publisher_credit;
    receiver.set_credit_mode(CreditMode::Auto(credit));
    if receiver.set_credit(credit).await.is_err() {
        return;
    }
    let mut pending: FuturesOrdered<Stored> = FuturesOrdered::new();
    loop {
        tokio::select! {
            () = cut.cancelled() => return,
            Some(first) = pending.next() => {
                if settle(&receiver, first, &mut pending).await.is_err() {
                    return;
                }
            }
            received = receiver.recv::<Body<Value>>() => {
                let outcome = match received {
                    Ok(delivery) => {
                        let (info, body) = delivery.into_parts();
                        match store(&core, &queue, &user_name, body).await {
                            Ok(stored) => {
                                pending.push_back(when_stored(info, stored));
                                continue;
                            }
                            Err(refusal) => receiver.reject(info, refusal).await,
                        }
                    }
                    Err(RecvError::MessageDecode(broken)) => {
                        metrics::counter!("broker_messages_refused_total", "reason" => "decode").increment(1);
                        receiver.reject(broken.info, error(AmqpError::DecodeError, "the message cannot be decoded")).await
                    }
                    Err(problem) => {
                        if let RecvError::MessageSizeExceeded(_) = problem {
                            metrics::counter!("broker_messages_refused_total", "reason" => "size").increment(1);
                        }
                        return debug!(queue = %queue.name, user = %user_name, error = %problem, "a publisher's link has ended");
                    }
                };
                if outcome.is_err() {
                    return;
                }
            }
        }
    }
}

/// Settles what is stored by now, with as few frames as possible.
async fn settle(
    receiver: &Receiver,
    first: (DeliveryInfo, bool),
    pending: &mut FuturesOrdered<Stored>,
) -> Result<(), ()> {
    let mut accepted = Vec::new();
    let mut refused = Vec::new();
    let mut sort =
        |(info, is_stored)| if is_stored { accepted.push(info) } else { refused.push(info) };
    sort(first);
    for _ in 1..SETTLED_AT_ONCE {
        match pending.next().now_or_never() {
            Some(Some(next)) => sort(next),
            _ => break,
        }
    }
    metrics::counter!("broker_messages_accepted_total").increment(accepted.len() as u64);
    if !accepted.is_empty() {
        receiver.accept_all(accepted).await.map_err(drop)?;
    }
    if !refused.is_empty() {
        metrics::counter!("broker_messages_refused_total", "reason" => "store")
            .increment(refused.len() as u64);
        let reason = error(
            AmqpError::ResourceLimitExceeded,
            "the broker could not store the message; try again later",
        );
        receiver.reject_all(refused, reason).await.map_err(drop)?;
    }
    Ok(())
}

fn when_stored(info: DeliveryInfo, stored: oneshot::Receiver<Result<(), WriteFailed>>) -> Stored {
    stored.map(Box::new(move |answer| (info, matches!(answer, Ok(Ok(()))))))
}

async fn store(
    core: &Core,
    queue: &Arc<Queue>,
    user_name: &str,
    mut received: message::AnyMessage,
) -> Result<oneshot::Receiver<Result<(), WriteFailed>>, definitions::Error> {
    let refuse = |reason: &'static str, refusal: definitions::Error| {
        metrics::counter!("broker_messages_refused_total", "reason" => reason).increment(1);
        Err(refusal)
    };
    message::stamp(&mut received, user_name);
    let Ok(wire) = message::encode(&received) else {
        return refuse(
            "decode",
            error(AmqpError::DecodeError, "the message cannot be encoded again"),
        );
    };
    let bytes = wire.len() as u64;
    if bytes > core.config.limits.message_bytes_max {
        let reason = format!("the message exceeds {} bytes", core.config.limits.message_bytes_max);
        return refuse("size", error(definitions::LinkError::MessageSizeExceeded, reason));
    }
    match queue.reserve(bytes) {
        Ok(()) => {}
        Err(Refusal::Full) => {
            return refuse(
                "full",
                error(
                    AmqpError::ResourceLimitExceeded,
                    format!("the queue {} is full", queue.name),
                ),
            );
        }
        Err(Refusal::Deleted) => {
            return refuse("deleted", error(AmqpError::ResourceDeleted, "the queue was deleted"));
        }
    }
    let id = core.next_message_id();
    let entry = Entry {
        id,
        bytes,
        expires_at_ms: message::expires_at_ms(&received, message::now_ms()),
        delivery_count: 0,
        is_redelivered: false,
    };
    // Before it is stored, so that the consumer that waits for it finds it.
    core.cache.insert(id, bytes, Arc::new(received));
    let (done, stored) = oneshot::channel();
    let command = Command::Insert(NewMessage { queue: Arc::clone(queue), entry, wire, done });
    if core.writer.send(command).await.is_err() {
        queue.give_back(bytes);
        core.cache.remove(id);
        return refuse("store", error(AmqpError::ResourceLimitExceeded, "the broker is stopping"));
    }
    Ok(stored)
}
