//! Requests for a factory's lease, and messages of connectors that do not hold it.

use std::{
    collections::HashMap,
    time::{Duration, Instant},
};

use asi_model::{
    DateTime, FactoryId,
    messages::{FactoryMessage, LeaseRequest},
};
use messaging::LogicalAddress;
use parking_lot::Mutex;

use super::{
    apply::Applier,
    decode::{Content, Incoming},
};
use crate::{
    leases::{FactoryLease, Verdict},
    store::StoreError,
};

/// When holders of leases were heard. Kept in memory and in spans of time, not in times of day, so
/// that neither a jumping clock nor a restart takes a lease from anybody.
#[derive(Debug)]
pub(super) struct Signs {
    silence: Duration,
    started: Instant,
    heard: Mutex<HashMap<FactoryId, Instant>>,
}

impl Signs {
    /// Nobody was heard yet; a holder counts as gone after so long.
    pub(super) fn new(silence: Duration) -> Self {
        Self { silence, started: Instant::now(), heard: Mutex::default() }
    }

    fn heard(&self, factory: &FactoryId) {
        self.heard.lock().insert(factory.clone(), Instant::now());
    }

    fn is_silent(&self, factory: &FactoryId) -> bool {
        let last = self.heard.lock().get(factory).copied().unwrap_or(self.started);
        last.elapsed() >= self.silence
    }
}

impl Applier<'_> {
    /// Answers a request for the lease; says of any other message whether it may have its effect.
    pub(super) async fn may_speak(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        let LogicalAddress::FactoryIngress(factory) = address else { return Ok(true) };
        if let Content::Factory(message) = &incoming.content
            && let FactoryMessage::LeaseRequest(request) = &**message
        {
            self.ask(factory, request, incoming.received_at).await?;
            return Ok(false);
        }
        // What carries no lease is taken as it comes: not every sender knows of leases.
        let Some(number) = incoming.lease else { return Ok(true) };
        let reason = match self.lease(factory).await? {
            Some(lease) if lease.number != number => lease.why_not(factory, number),
            _ => return Ok(true),
        };
        // Neither stored as seen nor receipted: whoever sent it keeps it.
        self.refuse(factory, incoming, "NOT_LEASED", reason).await?;
        Ok(false)
    }

    async fn ask(
        &mut self,
        factory: &FactoryId,
        request: &LeaseRequest,
        received_at: DateTime,
    ) -> Result<(), StoreError> {
        let before = self.lease(factory).await?.cloned();
        let former = before.as_ref().map(|lease| lease.holder.host.clone());
        let (lease, verdict) =
            FactoryLease::ask(before, request, self.signs.is_silent(factory), self.now);
        match verdict {
            Verdict::Renewed => self.signs.heard(factory),
            Verdict::Passed => {
                self.signs.heard(factory);
                tracing::info!(factory.id = %factory, host = %request.host, former, "The lease of a factory has passed.");
                if lease.number > 1 {
                    // What the former holder had received is unknown to this one.
                    self.work.parts().send_again(factory, self.now).await?;
                }
            }
            Verdict::Refused { is_news: true } => {
                let holder = &lease.holder.host;
                tracing::warn!(
                    factory.id = %factory, host = %request.host, holder,
                    "A second connector with the credential of a factory was refused. Stop it, or hand the lease over."
                );
            }
            Verdict::Refused { is_news: false } => {}
        }
        let is_refused = matches!(verdict, Verdict::Refused { .. });
        if !is_refused {
            let heard = self.heard.entry(factory.clone()).or_default();
            heard.at = heard.at.max(Some(received_at));
        }
        let result = if is_refused { "refused" } else { "granted" };
        metrics::counter!("verbund_lease_requests_total", "result" => result).increment(1);
        self.work.leases().put(factory, &lease).await?;
        self.effects.has_outgoing = true;
        // Where two read at one address a broker may serve them in turns, so that each would get
        // the other's answers for ever: of two equal ones each gets one.
        let copies = if lease.contenders.is_empty() { 1 } else { 2 };
        for _ in 0..copies {
            self.work
                .outbox()
                .add(&lease.answer(request, verdict, self.signs.silence, self.now))
                .await?;
        }
        self.leases.insert(factory.clone(), Some(lease));
        Ok(())
    }

    async fn lease(&mut self, factory: &FactoryId) -> Result<Option<&FactoryLease>, StoreError> {
        if !self.leases.contains_key(factory) {
            let lease = self.work.leases().lookup(factory).await?;
            self.leases.insert(factory.clone(), lease);
        }
        Ok(self.leases.get(factory).and_then(Option::as_ref))
    }
}
