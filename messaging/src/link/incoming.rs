//! Receives: one lane per address, in batches; stored by the inbox before anything is settled.

use std::{collections::HashMap, sync::Arc};

use tokio::{sync::mpsc, task::JoinSet};
use tokio_util::sync::CancellationToken;
use tracing::{debug, warn};

use super::{backoff::Backoff, shared::Shared};
use crate::{
    address::LogicalAddress,
    config::LinkLimits,
    inbox::{Delivery, Inbox, Settlement},
    profile::BrokerProfile,
    transport::{Connection, Incoming, LaneFault, Token},
};

/// All receiving of one connection.
pub(super) struct Consumers {
    pub connection: Arc<dyn Connection>,
    pub inbox: Arc<dyn Inbox>,
    pub shared: Arc<Shared>,
    pub profile: BrokerProfile,
    pub limits: LinkLimits,
    pub stalls: mpsc::Sender<String>,
    pub stop: CancellationToken,
}

impl Consumers {
    /// Keeps one consumer per wanted address until stopped.
    pub(super) async fn run(self) {
        let this = Arc::new(self);
        let mut wanted = this.shared.consumed.subscribe();
        let mut running: HashMap<LogicalAddress, CancellationToken> = HashMap::new();
        let mut tasks = JoinSet::new();
        loop {
            let addresses = wanted.borrow_and_update().clone();
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
                changed = wanted.changed() => {
                    if changed.is_err() {
                        break;
                    }
                }
            }
        }
        // Each finishes the batch that the inbox has in hand.
        while tasks.join_next().await.is_some() {}
    }

    async fn consume(self: Arc<Self>, address: LogicalAddress, stop: CancellationToken) {
        let terminus = self.profile.consume(&address);
        let what = format!("receiving from {address}");
        let rest = self.limits.address_backoff;
        let mut backoff =
            Backoff::new(rest, self.limits.backoff_permanent, self.limits.backoff_permanent);
        while !stop.is_cancelled() {
            let opened = tokio::select! {
                () = stop.cancelled() => break,
                opened = self.connection.incoming(&terminus) => opened,
            };
            let fault = match opened {
                Ok(lane) => {
                    debug!(%address, "receiving");
                    self.shared.hinder(&what, None);
                    self.receive(&address, lane, &stop, &mut backoff).await
                }
                Err(fault) => Err(fault),
            };
            let Err(fault) = fault else { break };
            if let LaneFault::Stalled(reason) = fault {
                let _ = self.stalls.try_send(reason);
                break;
            }
            let pause = backoff.after_failure(false, rand::random());
            if !stop.is_cancelled() {
                warn!(%address, reason = %fault, "messages cannot be received from an address at the moment");
                self.shared.hinder(&what, Some(fault.to_string()));
            }
            tokio::select! {
                () = stop.cancelled() => {}
                () = tokio::time::sleep(pause) => {}
            }
        }
        self.shared.hinder(&what, None);
    }

    /// Receives until stopped (`Ok`) or the lane fails.
    async fn receive(
        &self,
        address: &LogicalAddress,
        mut lane: Box<dyn Incoming>,
        stop: &CancellationToken,
        backoff: &mut Backoff,
    ) -> Result<(), LaneFault> {
        loop {
            let batch = tokio::select! {
                () = stop.cancelled() => {
                    // Not when the whole link stops: then the broker keeps what comes meanwhile.
                    if !self.stop.is_cancelled() {
                        lane.leave().await;
                    }
                    return Ok(());
                }
                batch = lane.receive(self.limits.batch) => batch?,
            };
            backoff.reset();
            if let Some((_, last)) = batch.last() {
                self.shared.received(last.received_at);
            }
            if self.store(address, lane.as_mut(), batch).await? {
                // What is on its way already must not overtake what was given back: with the lane
                // all of it goes back to its place, and comes again in its order after a rest.
                return Err(LaneFault::Broken(
                    "messages could not be stored; they stay with the broker".to_owned(),
                ));
            }
        }
    }

    /// Hands a batch to the inbox, then settles what it answered. Returns whether something was
    /// released.
    async fn store(
        &self,
        address: &LogicalAddress,
        lane: &mut dyn Incoming,
        batch: Vec<(Token, Delivery)>,
    ) -> Result<bool, LaneFault> {
        let (tokens, deliveries): (Vec<_>, Vec<_>) = batch.into_iter().unzip();
        let answers = self.inbox.receive(address, deliveries).await;
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
        lane.settle(settlements).await?;
        Ok(released > 0)
    }
}
