//! Receiving from one publisher: a message is stored first and accepted then.

use std::{sync::Arc, time::Duration};

use fe2o3_amqp::{
    Receiver,
    link::{RecvError, delivery::DeliveryInfo, receiver::CreditMode},
    types::{
        definitions::{self, AmqpError, LinkError},
        messaging::Body,
        primitives::Value,
    },
};
use futures::{FutureExt, StreamExt, stream::FuturesOrdered};
use tokio::{
    sync::{Semaphore, oneshot},
    time::timeout,
};
use tokio_util::sync::CancellationToken;
use tracing::debug;

use crate::{
    amqp_error::amqp_error,
    clock,
    core::Core,
    elements::{self, ELEMENTS_MAX},
    message::{self, AnyMessage},
    queue::{Queue, QueueEntry, QueueRefusal},
    shares::UserShare,
    store::{LinkOrder, NewMessage, StoreCommand, WriteFailed},
};

/// Deliveries settled by one pass.
const SETTLED_AT_ONCE_MAX: usize = 256;
/// Reasons for which messages are refused that are shares of their user.
const OF_SHARES: [&str; 3] = ["disk", "full", "size"];
/// Time for a publisher to answer the close of its link.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// Reply of the writer to one insert.
type Reply = oneshot::Receiver<Result<(), WriteFailed>>;

/// A delivery whose message is being stored; resolves to true when it was committed.
type Pending = futures::future::Map<
    Reply,
    Box<
        dyn FnOnce(
                Result<Result<(), WriteFailed>, oneshot::error::RecvError>,
            ) -> (DeliveryInfo, bool)
            + Send,
    >,
>;

/// User who sends.
pub(crate) struct Publisher {
    pub user_name: Arc<str>,
    /// Share of the user, under whose name refusals are counted.
    pub share: Arc<UserShare>,
    /// One permit per byte of the user's messages that wait for their commit.
    pub uncommitted: Arc<Semaphore>,
}

impl Publisher {
    /// Counts refused messages, with the user where it has used up a share of its own.
    fn count_refused(&self, reason: &'static str) {
        count_refused(reason, 1);
        if OF_SHARES.contains(&reason) {
            self.share.count_refusal(reason);
        }
    }
}

/// Serves a publisher until it detaches.
pub(crate) async fn ingest(
    core: Arc<Core>,
    queue: Arc<Queue>,
    publisher: Publisher,
    mut receiver: Receiver,
    cut: CancellationToken,
) {
    let mut pending: FuturesOrdered<Pending> = FuturesOrdered::new();
    // A publisher that reads nothing must not outlast its right to send.
    let ended = tokio::select! {
        () = cut.cancelled() => return,
        ended = take_messages(&core, &queue, &publisher, &mut receiver, &mut pending) => ended,
    };
    if let Ended::Refused(reason) = ended {
        tokio::select! {
            () = cut.cancelled() => {}
            () = close(receiver, pending, reason) => {}
        }
    }
}

/// Takes messages and answers them, until the link ends or has to.
async fn take_messages(
    core: &Core,
    queue: &Arc<Queue>,
    publisher: &Publisher,
    receiver: &mut Receiver,
    pending: &mut FuturesOrdered<Pending>,
) -> Ended {
    let credit = core.config.limits.publisher_credit;
    receiver.set_credit_mode(CreditMode::Auto(credit));
    if receiver.set_credit(credit).await.is_err() {
        return Ended::Gone;
    }
    let order = LinkOrder::default();
    loop {
        let received = tokio::select! {
            Some(first) = pending.next() => {
                match settle(receiver, first, pending).await {
                    Ok(()) => continue,
                    Err(ended) => return ended,
                }
            }
            received = receiver.recv::<Body<Value>>() => received,
        };
        let answered = match received {
            Ok(delivery) => {
                let (info, body) = delivery.into_parts();
                let taken = store(core, queue, publisher, &order, body).await;
                answer(receiver, publisher, info, taken, pending).await
            }
            Err(RecvError::MessageDecode(undecodable)) => {
                publisher.count_refused("decode");
                let error = amqp_error(AmqpError::DecodeError, "the message cannot be decoded");
                receiver.reject(undecodable.info, error).await.map_err(|_| Ended::Gone)
            }
            Err(problem) => {
                if let RecvError::MessageSizeExceeded(_) = problem {
                    publisher.count_refused("size");
                }
                debug!(
                    queue = %queue.name, user = %publisher.user_name, error = %problem,
                    "a publisher's link has ended"
                );
                return Ended::Gone;
            }
        };
        if let Err(ended) = answered {
            return ended;
        }
    }
}

/// End of a publisher's link.
enum Ended {
    /// The publisher has ended it, or is gone.
    Gone,
    /// A message was refused that is welcome later. None that was sent behind it may be taken before, so this side
    /// ends the link: what comes by another one was sent by a publisher who knows.
    Refused(definitions::Error),
}

/// Answers what is being stored still, and closes the link.
async fn close(
    receiver: Receiver,
    mut pending: FuturesOrdered<Pending>,
    reason: definitions::Error,
) {
    while let Some(next) = pending.next().await {
        if let Err(Ended::Gone) = settle(&receiver, next, &mut pending).await {
            return;
        }
    }
    // A publisher that does not answer is not waited for.
    let _ = timeout(CLOSE_TIMEOUT, receiver.close_with_error(reason)).await;
}

/// Lets a delivery wait for its commit, or rejects it at once.
async fn answer(
    receiver: &Receiver,
    publisher: &Publisher,
    info: DeliveryInfo,
    taken: Result<Reply, RejectedTransfer>,
    pending: &mut FuturesOrdered<Pending>,
) -> Result<(), Ended> {
    match taken {
        Ok(reply) => {
            let is_stored = move |answer| (info, matches!(answer, Ok(Ok(()))));
            pending.push_back(reply.map(Box::new(is_stored)));
            Ok(())
        }
        Err(RejectedTransfer { reason, error, is_welcome_later }) => {
            publisher.count_refused(reason);
            receiver.reject(info, error.clone()).await.map_err(|_| Ended::Gone)?;
            if is_welcome_later { Err(Ended::Refused(error)) } else { Ok(()) }
        }
    }
}

/// Settles the deliveries that are stored by now, with as few frames as possible.
async fn settle(
    receiver: &Receiver,
    first: (DeliveryInfo, bool),
    pending: &mut FuturesOrdered<Pending>,
) -> Result<(), Ended> {
    let mut accepted = Vec::new();
    let mut refused = Vec::new();
    let mut sort =
        |(info, is_stored)| if is_stored { accepted.push(info) } else { refused.push(info) };
    sort(first);
    for _ in 1..SETTLED_AT_ONCE_MAX {
        match pending.next().now_or_never() {
            Some(Some(next)) => sort(next),
            _ => break,
        }
    }
    metrics::counter!("broker_messages_accepted_total").increment(accepted.len() as u64);
    if !accepted.is_empty() {
        receiver.accept_all(accepted).await.map_err(|_| Ended::Gone)?;
    }
    if refused.is_empty() {
        return Ok(());
    }
    count_refused("store", refused.len() as u64);
    let reason = amqp_error(
        AmqpError::ResourceLimitExceeded,
        "the broker could not store the message; try again later",
    );
    receiver.reject_all(refused, reason.clone()).await.map_err(|_| Ended::Gone)?;
    Err(Ended::Refused(reason))
}

/// Refusal of a message: the label of the metric, and the error for the publisher.
struct RejectedTransfer {
    reason: &'static str,
    error: definitions::Error,
    /// True where it may be taken when it is sent again.
    is_welcome_later: bool,
}

impl RejectedTransfer {
    fn new(
        reason: &'static str,
        condition: impl Into<definitions::ErrorCondition>,
        description: impl Into<String>,
    ) -> Self {
        Self { reason, error: amqp_error(condition, description), is_welcome_later: false }
    }

    fn for_the_moment(reason: &'static str, description: impl Into<String>) -> Self {
        let refused = Self::new(reason, AmqpError::ResourceLimitExceeded, description);
        Self { is_welcome_later: true, ..refused }
    }
}

/// Refuses what takes much more memory when it is decoded than its bytes say.
fn check_shape(received: &AnyMessage) -> Result<(), RejectedTransfer> {
    if !elements::is_plain(received) {
        let reason = "only messages whose body is bytes or text are taken";
        return Err(RejectedTransfer::new("body", AmqpError::NotAllowed, reason));
    }
    if elements::elements(received) > ELEMENTS_MAX {
        let reason = format!("the message has more than {ELEMENTS_MAX} values");
        return Err(RejectedTransfer::new("elements", AmqpError::NotAllowed, reason));
    }
    Ok(())
}

/// Hands a message to the writer; the reply comes after the commit.
async fn store(
    core: &Core,
    queue: &Arc<Queue>,
    publisher: &Publisher,
    order: &LinkOrder,
    mut received: AnyMessage,
) -> Result<Reply, RejectedTransfer> {
    check_shape(&received)?;
    message::stamp(&mut received, &publisher.user_name);
    let wire = message::encode(&received).map_err(|_| {
        RejectedTransfer::new(
            "decode",
            AmqpError::DecodeError,
            "the message cannot be encoded again",
        )
    })?;
    let bytes = wire.len() as u64;
    let bytes_max = core.config.limits.message_bytes_max;
    if bytes > bytes_max {
        let reason = format!("the message exceeds {bytes_max} bytes");
        return Err(RejectedTransfer::new("size", LinkError::MessageSizeExceeded, reason));
    }
    let stopping = || RejectedTransfer::for_the_moment("store", "the broker is stopping");
    // The writer gives them back, so this waits for the disk and for nothing that waits for it.
    let permits = u32::try_from(bytes).unwrap_or(u32::MAX);
    let permits = permits.min(core.config.limits.uncommitted_bytes_per_user_max);
    let uncommitted = Arc::clone(&publisher.uncommitted).acquire_many_owned(permits).await;
    let uncommitted = uncommitted.map_err(|_| stopping())?;
    // The last wait: a publisher that is cut takes nothing with it that is reserved from here on.
    let place = core.writer.place().await.map_err(|WriteFailed| stopping())?;
    queue.reserve(bytes).map_err(|refusal| match refusal {
        QueueRefusal::Full => {
            RejectedTransfer::for_the_moment("full", format!("the queue {} is full", queue.name))
        }
        QueueRefusal::Deleted => {
            RejectedTransfer::new("deleted", AmqpError::ResourceDeleted, "the queue was deleted")
        }
    })?;
    // Behind the queue's own bound: what that refuses takes no room from others.
    core.take_room(queue, bytes).map_err(|lack| {
        queue.release_reservation(bytes);
        RejectedTransfer::for_the_moment("disk", lack)
    })?;
    let id = core.next_message_id();
    let entry = QueueEntry {
        id,
        bytes,
        expires_at_ms: message::expires_at_ms(&received, clock::now_ms()),
        delivery_count: 0,
        is_redelivered: false,
    };
    // Before the insert: the consumer that the commit wakes finds the body in the cache.
    core.cache.insert(id, bytes, Arc::new(received));
    let (done, stored) = oneshot::channel();
    let (queue, order) = (Arc::clone(queue), order.clone());
    place.send(StoreCommand::Insert(NewMessage { queue, entry, wire, order, uncommitted, done }));
    Ok(stored)
}

fn count_refused(reason: &'static str, count: u64) {
    metrics::counter!("broker_messages_refused_total", "reason" => reason).increment(count);
}

#[cfg(test)]
mod tests;
