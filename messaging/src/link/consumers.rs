//! Receiving: one consumer per address, in batches that the inbox stores before they are settled.

use std::{collections::HashMap, sync::Arc};

use tokio::{sync::mpsc, task::JoinSet};
use tokio_util::sync::CancellationToken;
use tracing::{debug, warn};

use super::{backoff::Backoff, context::LinkContext};
use crate::{
    address::LogicalAddress,
    config::LinkLimits,
    inbox::{Delivery, Inbox, Settlement},
    profile::BrokerProfile,
    transport::{Connection, DeliveryToken, EndpointFault, MessageReceiver},
};

/// The receiving side of one connection.
pub(super) struct Consumers {
    pub connection: Arc<dyn Connection>,
    pub inbox: Arc<dyn Inbox>,
    pub context: Arc<LinkContext>,
    pub profile: BrokerProfile,
    pub limits: LinkLimits,
    /// Reports that the broker does not answer any more; the supervisor drops the connection.
    pub stalls: mpsc::Sender<String>,
    pub stop: CancellationToken,
}

impl Consumers {
    /// Runs one consumer per configured address until stopped.
    pub(super) async fn run(self) {
        let this = Arc::new(self);
        let mut consumed = this.context.consumed.subscribe();
        let mut running: HashMap<LogicalAddress, CancellationToken> = HashMap::new();
        let mut tasks = JoinSet::new();
        loop {
            let addresses = consumed.borrow_and_update().clone();
            running.retain(|address, stop| {
                let stays = addresses.contains(address);
                if !stays {
                    stop.cancel();
                }
                stays
            });
            for address in addresses {
                running.entry(address).or_insert_with_key(|address| {
                    let stop = this.stop.child_token();
                    tasks.spawn(Arc::clone(&this).consume(address.clone(), stop.clone()));
                    stop
                });
            }
            tokio::select! {
                () = this.stop.cancelled() => break,
                Some(_) = tasks.join_next() => {}
                changed = consumed.changed() => {
                    if changed.is_err() {
                        break;
                    }
                }
            }
        }
        // Each finishes the batch that the inbox is storing.
        while tasks.join_next().await.is_some() {}
    }

    async fn consume(self: Arc<Self>, address: LogicalAddress, stop: CancellationToken) {
        let terminus = self.profile.consume(&address);
        let activity = format!("receiving from {address}");
        // An address that stays refused needs a person as well, so its pauses grow as long as those
        // of permanent faults, while the other addresses go on.
        let mut backoff = Backoff::new(
            self.limits.address_backoff,
            self.limits.backoff_permanent,
            self.limits.backoff_permanent,
        );
        while !stop.is_cancelled() {
            let opened = tokio::select! {
                () = stop.cancelled() => break,
                opened = self.connection.receiver(&terminus) => opened,
            };
            let fault = match opened {
                Ok(receiver) => {
                    debug!(%address, "Receiving from an address.");
                    self.context.clear_obstacle(&activity);
                    self.receive(&address, receiver, &stop, &mut backoff).await
                }
                Err(fault) => Err(fault),
            };
            let Err(fault) = fault else { break };
            if let EndpointFault::Stalled(reason) = fault {
                // One report suffices: the supervisor ends the whole connection.
                let _ = self.stalls.try_send(reason);
                break;
            }
            let pause = backoff.after_failure(false, rand::random());
            if !stop.is_cancelled() {
                warn!(%address, reason = %fault, "Messages cannot be received from an address at the moment.");
                self.context.report_obstacle(&activity, fault.to_string());
            }
            tokio::select! {
                () = stop.cancelled() => {}
                () = tokio::time::sleep(pause) => {}
            }
        }
        self.context.clear_obstacle(&activity);
    }

    /// Receives until stopped (`Ok`) or the receiver fails.
    async fn receive(
        &self,
        address: &LogicalAddress,
        mut receiver: Box<dyn MessageReceiver>,
        stop: &CancellationToken,
        backoff: &mut Backoff,
    ) -> Result<(), EndpointFault> {
        loop {
            let batch = tokio::select! {
                () = stop.cancelled() => {
                    // Not when the whole link stops: the broker then stores new messages meanwhile.
                    if !self.stop.is_cancelled() {
                        receiver.leave().await;
                    }
                    return Ok(());
                }
                batch = receiver.receive(self.limits.batch) => batch?,
            };
            backoff.reset();
            if let Some((_, last)) = batch.last() {
                self.context.received(last.received_at);
            }
            if self.store(address, receiver.as_mut(), batch).await? {
                // Messages on their way already must not overtake the released ones. Dropping the
                // receiver returns all of them to the broker, which delivers them in order later.
                return Err(EndpointFault::Broken(
                    "messages could not be stored; they stay with the broker".to_owned(),
                ));
            }
        }
    }

    /// Hands a batch to the inbox, then settles it as the inbox answered. Returns whether a
    /// message was released.
    async fn store(
        &self,
        address: &LogicalAddress,
        receiver: &mut dyn MessageReceiver,
        batch: Vec<(DeliveryToken, Delivery)>,
    ) -> Result<bool, EndpointFault> {
        let (tokens, deliveries): (Vec<_>, Vec<_>) = batch.into_iter().unzip();
        let answers = self.inbox.receive(address, deliveries).await;
        // A delivery without an answer stays with the broker: nothing is settled that may not be
        // stored.
        let answers = answers.into_iter().chain(std::iter::repeat(Settlement::Release));
        let settlements: Vec<_> = tokens.into_iter().zip(answers).collect();
        let count = |name: &'static str, predicate: fn(&Settlement) -> bool| {
            let n = settlements.iter().filter(|(_, s)| predicate(s)).count();
            metrics::counter!("link_messages_received_total", "settlement" => name)
                .increment(n as u64);
            n
        };
        count("accepted", |s| *s == Settlement::Accept);
        count("rejected", |s| matches!(s, Settlement::Reject(_)));
        let released = count("released", |s| *s == Settlement::Release);
        receiver.settle(settlements).await?;
        Ok(released > 0)
    }
}
