//! Delivery of messages to one consumer, and settlement by its outcomes.

use std::{collections::HashMap, sync::Arc, time::Duration};

use fe2o3_amqp::{
    Sendable, Sender,
    link::{SendError, delivery::DeliveryFut},
    types::{
        definitions::{AmqpError, LinkError},
        messaging::{Body, Outcome},
        primitives::Value,
    },
};
use futures::{FutureExt, StreamExt, future::BoxFuture, stream::FuturesUnordered};
use tokio::time::{Instant, sleep_until, timeout, timeout_at};
use tokio_util::sync::CancellationToken;
use tracing::{debug, error};

use crate::{
    amqp_error::{amqp_error, condition_text},
    clock,
    config::BrokerLimits,
    core::Core,
    elements,
    message::{self, AnyMessage},
    queue::{Next, Queue, QueueEntry, Subscription},
    shares::UnsettledShare,
};

/// Pause of a consumer without credit after it has requeued a message, so that others get it first.
const YIELD_PAUSE: Duration = Duration::from_millis(50);
/// Pause after the database could not be read.
const READ_RETRY: Duration = Duration::from_secs(1);
/// Time for a consumer to settle and to answer a close.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// A delivered message that is not settled yet.
struct Delivered {
    entry: QueueEntry,
    message: Arc<AnyMessage>,
}

impl Delivered {
    /// Estimates the memory that it takes.
    fn bytes(&self) -> u64 {
        elements::memory(self.entry.bytes, &self.message)
    }
}

/// Deliveries that a consumer has not settled. Stored apart from the futures of their outcomes,
/// because those may never resolve.
struct Unsettled {
    delivered: HashMap<i64, Delivered>,
    /// Memory of the delivered messages.
    bytes: u64,
    /// Memory of those of all consumers of the user.
    share: Arc<UnsettledShare>,
    outcomes: FuturesUnordered<BoxFuture<'static, (i64, Result<Outcome, SendError>)>>,
}

impl Unsettled {
    fn new(share: Arc<UnsettledShare>) -> Self {
        Self { delivered: HashMap::new(), bytes: 0, share, outcomes: FuturesUnordered::new() }
    }

    /// Returns true where one more message may be delivered. A consumer without any gets one, however
    /// much others of its user have: it would wait for them otherwise.
    fn has_room(&self, limits: &BrokerLimits) -> bool {
        self.delivered.is_empty()
            || (self.delivered.len() < limits.unsettled_per_link_max
                && self.bytes < limits.unsettled_bytes_per_link_max
                && self.share.has_room())
    }

    fn add(&mut self, delivered: Delivered) {
        let bytes = delivered.bytes();
        self.bytes += bytes;
        self.share.add(bytes);
        self.delivered.insert(delivered.entry.id, delivered);
    }

    /// Waits for the next outcome; none when nothing is unsettled.
    async fn next(&mut self) -> Option<(Delivered, Result<Outcome, SendError>)> {
        loop {
            let (id, outcome) = self.outcomes.next().await?;
            if let Some(delivered) = self.delivered.remove(&id) {
                let bytes = delivered.bytes();
                self.bytes = self.bytes.saturating_sub(bytes);
                self.share.remove(bytes);
                return Some((delivered, outcome));
            }
        }
    }
}

impl Drop for Unsettled {
    fn drop(&mut self) {
        self.share.remove(self.bytes);
    }
}

/// Result of an attempt to deliver.
enum Sent {
    /// Sent, or dropped because it has expired.
    Done,
    /// Ready again; this consumer takes no other message for so long.
    Requeued(Duration),
    LinkEnded,
}

/// Serves a consumer until it detaches; what it has not settled is delivered to the next one.
pub(crate) async fn dispatch(
    core: Arc<Core>,
    queue: Arc<Queue>,
    share: Arc<UnsettledShare>,
    mut sender: Sender,
    cut: CancellationToken,
) {
    let subscription = Subscription::new(Arc::clone(&queue));
    let mut unsettled = Unsettled::new(share);
    let consumer =
        Dispatcher { core: &core, queue: &queue, subscription: &subscription, cut: &cut };
    let is_deleted = consumer.serve(&mut sender, &mut unsettled).await;
    if is_deleted {
        let error = amqp_error(AmqpError::ResourceDeleted, "the queue was deleted");
        let _ = timeout(CLOSE_TIMEOUT, sender.close_with_error(error)).await;
    } else {
        // Dropping the sender resolves the outcomes that will never come.
        drop(sender);
    }
    // Wakes another consumer where several share the queue.
    subscription.pause();
    settle_rest(&core, &queue, unsettled).await;
    // Only now: a single active consumer that follows gets nothing before what this one had.
    drop(subscription);
}

struct Dispatcher<'a> {
    core: &'a Arc<Core>,
    queue: &'a Arc<Queue>,
    subscription: &'a Subscription,
    cut: &'a CancellationToken,
}

impl Dispatcher<'_> {
    /// Delivers until the link ends; returns true when it ends because the queue was deleted.
    async fn serve(&self, sender: &mut Sender, unsettled: &mut Unsettled) -> bool {
        let limits = &self.core.config.limits;
        let share = Arc::clone(&unsettled.share);
        let mut yields_until: Option<Instant> = None;
        loop {
            // Before the look: what others settle after it is not missed.
            let fewer = share.fewer();
            let has_room = unsettled.has_room(limits);
            if !has_room {
                self.subscription.pause();
            }
            tokio::select! {
                // A cut first: nothing more goes to a revoked user. Outcomes before deliveries,
                // since they make room.
                biased;
                () = self.cut.cancelled() => return false,
                Some((delivered, outcome)) = unsettled.next() => self.settle(delivered, outcome).await,
                () = fewer, if !has_room => {}
                () = over(yields_until), if yields_until.is_some() => yields_until = None,
                next = self.subscription.next(), if has_room && yields_until.is_none() => {
                    let Next::Lease(entry) = next else { return true };
                    match self.deliver(sender, unsettled, entry).await {
                        Sent::Done => {}
                        Sent::Requeued(pause) => yields_until = Some(Instant::now() + pause),
                        Sent::LinkEnded => return false,
                    }
                }
                ended = sender.on_detach() => {
                    debug!(queue = %self.queue.name, reason = ?ended, "a consumer's link has ended");
                    return false;
                }
            }
        }
    }

    async fn deliver(
        &self,
        sender: &mut Sender,
        unsettled: &mut Unsettled,
        entry: QueueEntry,
    ) -> Sent {
        let now_ms = clock::now_ms();
        if entry.expires_at_ms.is_some_and(|at| at <= now_ms) {
            metrics::counter!("broker_messages_expired_total").increment(1);
            self.core.remove(self.queue, &entry).await;
            return Sent::Done;
        }
        let message = match self.core.body(self.queue, &entry).await {
            Ok(Some(message)) => message,
            Ok(None) => {
                error!(
                    queue = %self.queue.name, message = entry.id,
                    "a stored message is gone or damaged; it is dropped"
                );
                self.core.remove(self.queue, &entry).await;
                return Sent::Done;
            }
            Err(problem) => {
                error!(
                    queue = %self.queue.name, error = %problem,
                    "a message could not be read; it is tried again"
                );
                self.queue.requeue(entry);
                return Sent::Requeued(READ_RETRY);
            }
        };
        let ttl = entry.expires_at_ms.map(|at| Duration::from_millis((at - now_ms).unsigned_abs()));
        let copy = message::for_delivery(&message, entry.delivery_count, entry.is_redelivered, ttl);
        let sendable = Sendable::builder().message(copy).build();
        self.send(sender, unsettled, Delivered { entry, message }, sendable).await
    }

    /// Sends, waiting for credit if need be; requeues the message as soon as another consumer could
    /// send it.
    async fn send(
        &self,
        sender: &mut Sender,
        unsettled: &mut Unsettled,
        delivered: Delivered,
        sendable: Sendable<Body<Value>>,
    ) -> Sent {
        let mut sending = Box::pin(sender.send_batchable(sendable));
        if let Some(result) = (&mut sending).now_or_never() {
            return self.sent(unsettled, delivered, result).await;
        }
        self.subscription.hold();
        let result = loop {
            tokio::select! {
                biased;
                result = &mut sending => break Some(result),
                () = self.cut.cancelled() => break None,
                () = self.subscription.give_way_requested() => break None,
                Some((earlier, outcome)) = unsettled.next() => self.settle(earlier, outcome).await,
            }
        };
        drop(sending);
        self.subscription.release_hold();
        match result {
            Some(result) => self.sent(unsettled, delivered, result).await,
            None => {
                self.queue.requeue(delivered.entry);
                Sent::Requeued(YIELD_PAUSE)
            }
        }
    }

    async fn sent(
        &self,
        unsettled: &mut Unsettled,
        delivered: Delivered,
        result: Result<DeliveryFut<Result<Outcome, SendError>>, SendError>,
    ) -> Sent {
        match result {
            Ok(outcome) => {
                metrics::counter!("broker_messages_delivered_total").increment(1);
                let id = delivered.entry.id;
                unsettled.add(delivered);
                unsettled.outcomes.push(outcome.map(move |outcome| (id, outcome)).boxed());
                Sent::Done
            }
            // A consumer that takes smaller messages only would be offered it again and again, and
            // none of those behind it.
            Err(SendError::MessageSizeExceeded(exceeded))
                if self.queue.id != self.core.dead_letters.id =>
            {
                let Delivered { entry, message } = delivered;
                let code = condition_text(&LinkError::MessageSizeExceeded.into());
                let reason = format!("a consumer takes no message of this size: {exceeded}");
                self.core.dead_letter(self.queue, entry, &message, code, reason).await;
                Sent::Done
            }
            Err(problem) => {
                debug!(
                    queue = %self.queue.name, error = %problem,
                    "a consumer's link has ended while sending"
                );
                self.queue.requeue(delivered.entry);
                Sent::LinkEnded
            }
        }
    }

    async fn settle(&self, delivered: Delivered, outcome: Result<Outcome, SendError>) {
        settle(self.core, self.queue, delivered, outcome).await;
    }
}

async fn over(pause: Option<Instant>) {
    if let Some(until) = pause {
        sleep_until(until).await;
    }
}

async fn settle(
    core: &Arc<Core>,
    queue: &Arc<Queue>,
    delivered: Delivered,
    outcome: Result<Outcome, SendError>,
) {
    let Delivered { entry, message } = delivered;
    match outcome {
        Ok(Outcome::Accepted(_)) => core.remove(queue, &entry).await,
        Ok(Outcome::Rejected(rejected)) => {
            let (code, reason) = match rejected.error {
                Some(error) => {
                    (condition_text(&error.condition), error.description.unwrap_or_default())
                }
                None => ("amqp:rejected".to_owned(), "rejected without a reason".to_owned()),
            };
            core.dead_letter(queue, entry, &message, code, reason).await;
        }
        Ok(Outcome::Released(_)) => queue.requeue(QueueEntry { is_redelivered: true, ..entry }),
        Ok(Outcome::Modified(modified)) => {
            if modified.delivery_failed == Some(true) || modified.undeliverable_here == Some(true) {
                core.fail(queue, entry, &message).await;
            } else {
                queue.requeue(QueueEntry { is_redelivered: true, ..entry });
            }
        }
        // A lost connection is not the message's fault, so it is no failed delivery: a receiver that
        // restarts often must not turn valid messages into dead letters.
        Err(_) => queue.requeue(QueueEntry { is_redelivered: true, ..entry }),
    }
}

/// Settles the outcomes that still arrive in time, and requeues the other messages.
async fn settle_rest(core: &Arc<Core>, queue: &Arc<Queue>, mut unsettled: Unsettled) {
    let deadline = Instant::now() + CLOSE_TIMEOUT;
    while let Ok(Some((delivered, outcome))) = timeout_at(deadline, unsettled.next()).await {
        settle(core, queue, delivered, outcome).await;
    }
    for delivered in std::mem::take(&mut unsettled.delivered).into_values() {
        queue.requeue(QueueEntry { is_redelivered: true, ..delivered.entry });
    }
}
