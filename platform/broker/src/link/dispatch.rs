//! Delivers messages to a consumer and does what it decides about them.

use std::{collections::HashMap, sync::Arc, time::Duration};

use fe2o3_amqp::{
    Sendable, Sender,
    link::SendError,
    types::{
        definitions::{AmqpError, ErrorCondition},
        messaging::Outcome,
    },
};
use futures::{FutureExt, StreamExt, future::BoxFuture, stream::FuturesUnordered};
use tokio::time::{timeout, timeout_at};
use tokio_util::sync::CancellationToken;
use tracing::{debug, error};

use crate::{
    connection,
    core::Core,
    message::{self, AnyMessage},
    queue::{Entry, Next, Queue, Subscription},
};

/// How long a consumer without credit stays behind the others after it gave a message back.
const BACK_SEAT: Duration = Duration::from_millis(50);
/// Pause after the database could not be read.
const READ_RETRY: Duration = Duration::from_secs(1);
const CLOSE_TIMEOUT: Duration = Duration::from_secs(2);

/// A delivered message whose outcome is awaited.
struct Delivered {
    entry: Entry,
    message: Arc<AnyMessage>,
}

/// What a consumer holds. Kept apart from the futures of its outcomes, because those may never
/// resolve.
#[derive(Default)]
struct Unsettled {
    delivered: HashMap<i64, Delivered>,
    outcomes: FuturesUnordered<BoxFuture<'static, (i64, Result<Outcome, SendError>)>>,
}

impl Unsettled {
    /// The next message with its outcome; none when nothing is awaited.
    async fn next(&mut self) -> Option<(Delivered, Result<Outcome, SendError>)> {
        loop {
            let (id, outcome) = self.outcomes.next().await?;
            if let Some(delivered) = self.delivered.remove(&id) {
                return Some((delivered, outcome));
            }
        }
    }
}

/// What happened to an attempt to send.
enum Sent {
    Delivered,
    GivenBack,
    LinkEnded,
}

/// Serves a consumer until it leaves; what it has not settled is delivered to the next one.
pub(crate) async fn dispatch(
    core: Arc<Core>,
    queue: Arc<Queue>,
    mut sender: Sender,
    cut: CancellationToken,
) {
    let subscription = Subscription::new(Arc::clone(&queue));
    let mut unsettled = Unsettled::default();
    let consumer = Consumer { core: &core, queue: &queue, subscription: &subscription, cut: &cut };
    let is_deleted = consumer.serve(&mut sender, &mut unsettled).await;
    if is_deleted {
        let gone = connection::error(AmqpError::ResourceDeleted, "the queue was deleted");
        let _ = timeout(CLOSE_TIMEOUT, sender.close_with_error(gone)).await;
    } else {
        // Dropping the sender resolves the outcomes that will never come.
        drop(sender);
    }
    drop(subscription);
    consumer_left(&core, &queue, unsettled).await;
}

struct Consumer<'a> {
    core: &'a Arc<Core>,
    queue: &'a Arc<Queue>,
    subscription: &'a Subscription,
    cut: &'a CancellationToken,
}

impl Consumer<'_> {
    /// Delivers until the link ends. Returns whether the queue was deleted.
    async fn serve(&self, sender: &mut Sender, unsettled: &mut Unsettled) -> bool {
        let window = self.core.config.limits.unsettled_per_link_max;
        let mut in_back_seat = false;
        loop {
            let has_room = unsettled.delivered.len() < window;
            if !has_room {
                self.subscription.pause();
            }
            tokio::select! {
                biased;
                () = self.cut.cancelled() => return false,
                Some((delivered, outcome)) = unsettled.next() => self.settle(delivered, outcome).await,
                () = tokio::time::sleep(BACK_SEAT), if in_back_seat => in_back_seat = false,
                next = self.subscription.next(), if has_room && !in_back_seat => {
                    let Next::Lease(entry) = next else { return true };
                    match self.deliver(sender, unsettled, entry).await {
                        Sent::Delivered => {}
                        Sent::GivenBack => in_back_seat = true,
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

    async fn deliver(&self, sender: &mut Sender, unsettled: &mut Unsettled, entry: Entry) -> Sent {
        let now_ms = message::now_ms();
        if entry.expires_at_ms.is_some_and(|at| at <= now_ms) {
            metrics::counter!("broker_messages_expired_total").increment(1);
            self.core.remove(self.queue, &entry).await;
            return Sent::Delivered;
        }
        let message = match self.core.body(self.queue, &entry).await {
            Ok(Some(message)) => message,
            Ok(None) => {
                error!(queue = %self.queue.name, message = entry.id, "a stored message is gone or damaged; it is dropped");
                self.core.remove(self.queue, &entry).await;
                return Sent::Delivered;
            }
            Err(problem) => {
                error!(queue = %self.queue.name, error = %problem, "a message could not be read; it is tried again");
                self.queue.requeue(entry);
                tokio::time::sleep(READ_RETRY).await;
                return Sent::GivenBack;
            }
        };
        let ttl = entry.expires_at_ms.map(|at| Duration::from_millis((at - now_ms).unsigned_abs()));
        let copy = message::for_delivery(&message, entry.delivery_count, entry.is_redelivered, ttl);
        self.send(
            sender,
            unsettled,
            Delivered { entry, message },
            Sendable::builder().message(copy).build(),
        )
        .await
    }

    /// Waits for credit, but not at the expense of others: a message that another consumer could
    /// take is given back.
    async fn send(
        &self,
        sender: &mut Sender,
        unsettled: &mut Unsettled,
        delivered: Delivered,
        sendable: Sendable<fe2o3_amqp_types::messaging::Body<fe2o3_amqp_types::primitives::Value>>,
    ) -> Sent {
        let mut sending = Box::pin(sender.send_batchable(sendable));
        if let Some(result) = (&mut sending).now_or_never() {
            return self.sent(unsettled, delivered, result);
        }
        self.subscription.hold();
        let result = loop {
            tokio::select! {
                biased;
                result = &mut sending => break Some(result),
                () = self.cut.cancelled() => break None,
                () = self.subscription.wanted_elsewhere() => break None,
                Some((earlier, outcome)) = unsettled.next() => self.settle(earlier, outcome).await,
            }
        };
        drop(sending);
        self.subscription.release_hold();
        match result {
            Some(result) => self.sent(unsettled, delivered, result),
            None => {
                self.queue.requeue(delivered.entry);
                Sent::GivenBack
            }
        }
    }

    fn sent(
        &self,
        unsettled: &mut Unsettled,
        delivered: Delivered,
        result: Result<
            fe2o3_amqp::link::delivery::DeliveryFut<Result<Outcome, SendError>>,
            SendError,
        >,
    ) -> Sent {
        match result {
            Ok(outcome) => {
                metrics::counter!("broker_messages_delivered_total").increment(1);
                let id = delivered.entry.id;
                unsettled.delivered.insert(id, delivered);
                unsettled.outcomes.push(outcome.map(move |outcome| (id, outcome)).boxed());
                Sent::Delivered
            }
            Err(problem) => {
                debug!(queue = %self.queue.name, error = %problem, "a consumer's link has ended while sending");
                self.queue.requeue(delivered.entry);
                Sent::LinkEnded
            }
        }
    }

    async fn settle(&self, delivered: Delivered, outcome: Result<Outcome, SendError>) {
        settle(self.core, self.queue, delivered, outcome).await;
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
            core.bury(queue, entry, &message, code, reason).await;
        }
        Ok(Outcome::Released(_)) => queue.requeue(Entry { is_redelivered: true, ..entry }),
        Ok(Outcome::Modified(modified)) => {
            if modified.delivery_failed == Some(true) || modified.undeliverable_here == Some(true) {
                core.fail(queue, entry, &message).await;
            } else {
                queue.requeue(Entry { is_redelivered: true, ..entry });
            }
        }
        // A lost connection is not the message's fault, so it does not count: a receiver that is
        // restarted often must not turn sound messages into dead letters.
        Err(_) => queue.requeue(Entry { is_redelivered: true, ..entry }),
    }
}

async fn consumer_left(core: &Arc<Core>, queue: &Arc<Queue>, mut unsettled: Unsettled) {
    let deadline = tokio::time::Instant::now() + CLOSE_TIMEOUT;
    while let Ok(Some((delivered, outcome))) = timeout_at(deadline, unsettled.next()).await {
        settle(core, queue, delivered, outcome).await;
    }
    for delivered in unsettled.delivered.into_values() {
        queue.requeue(Entry { is_redelivered: true, ..delivered.entry });
    }
}

/// The condition as it stands on the wire.
pub(super) fn condition_text(condition: &ErrorCondition) -> String {
    serde_amqp::to_vec(condition)
        .ok()
        .and_then(|bytes| {
            serde_amqp::from_slice::<fe2o3_amqp_types::primitives::Symbol>(&bytes).ok()
        })
        .map_or_else(|| format!("{condition:?}"), |symbol| symbol.0)
}
