//! Arbitration of leases: requests are answered, and messages under a lease that has passed on are
//! rejected.

use std::{collections::HashMap, time::Duration};

use asi_model::{
    DateTime, FactoryId,
    messages::{FactoryMessage, Lease, LeaseRequest, PlatformMessage},
};
use messaging::{Envelope, LogicalAddress};

use super::{
    decode::{Content, Incoming},
    heartbeats::Heartbeats,
    quota_arbiter::ANSWERS,
    unit::IngestUnit,
};
use crate::{
    leases::{FactoryLease, LeaseDecision},
    store::{AuditFact, AuditFactKind, Holder, NewOutgoing, StoreError},
};

/// Time to live of an answer.
const ANSWER_LIFE: Duration = Duration::from_secs(60);

/// Leases within one unit of ingest; each is read once.
pub(super) struct LeaseArbiter<'w> {
    heartbeats: &'w Heartbeats,
    leases: HashMap<FactoryId, Option<FactoryLease>>,
}

impl<'w> LeaseArbiter<'w> {
    pub(super) fn new(heartbeats: &'w Heartbeats) -> Self {
        Self { heartbeats, leases: HashMap::new() }
    }

    /// Answers a lease request; returns true for any other message that may take effect.
    pub(super) async fn admit(
        &mut self,
        unit: &mut IngestUnit<'_>,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<bool, StoreError> {
        let LogicalAddress::FactoryIngress(factory) = address else { return Ok(true) };
        if let Content::Factory(message) = &incoming.content
            && let FactoryMessage::LeaseRequest(request) = &**message
        {
            self.decide(unit, factory, request, incoming.received_at).await?;
            return Ok(false);
        }
        // A message without a lease number is accepted: not every sender knows of leases.
        let Some(number) = incoming.envelope.lease else { return Ok(true) };
        let reason = match self.lease(unit, factory).await? {
            Some(lease) if lease.number != number => lease.why_not(factory, number),
            _ => return Ok(true),
        };
        // Neither stored as seen nor receipted, so that its sender keeps it.
        unit.reject(address, incoming, "NOT_LEASED", reason).await?;
        Ok(false)
    }

    async fn decide(
        &mut self,
        unit: &mut IngestUnit<'_>,
        factory: &FactoryId,
        request: &LeaseRequest,
        received_at: DateTime,
    ) -> Result<(), StoreError> {
        let before = self.lease(unit, factory).await?.cloned();
        let former = before.as_ref().map(|lease| lease.holder.host.clone());
        let is_silent = self.heartbeats.is_silent(factory);
        let (lease, decision) = FactoryLease::ask(before, request, is_silent, unit.now);
        log(factory, request, &lease, decision, former.as_deref());
        let is_refused = matches!(decision, LeaseDecision::Refused { .. });
        // Only the holder is a sign of life: a second connector that asks must not keep the lease
        // of a silent one alive.
        if !is_refused {
            self.heartbeats.record(factory);
            unit.record_sign(factory, received_at);
        }
        if decision == LeaseDecision::Passed && lease.number > 1 {
            // The new holder may lack what the former one had received.
            unit.work.parts().send_again(factory, unit.now).await?;
            let (former, present) = (former.as_ref(), Some(&lease.holder.host));
            let facts = AuditFact::changed(AuditFactKind::Host, former, present);
            let path = format!("factories/{factory}/lease");
            unit.record_change(factory, "takeLease", path, facts.as_slice()).await?;
        }
        let result = if is_refused { "refused" } else { "granted" };
        metrics::counter!("verbund_lease_requests_total", "result" => result).increment(1);
        unit.work.leases().put(factory, &lease).await?;
        unit.effects.has_outgoing = true;
        if unit
            .work
            .outgoing()
            .takes_answers(&LogicalAddress::FactoryLeases(factory.clone()))
            .await?
        {
            self.answer(unit, request, decision, &lease).await?;
        } else {
            unit.effects.refused(ANSWERS, Holder::Factory(factory.clone()));
        }
        self.leases.insert(factory.clone(), Some(lease));
        Ok(())
    }

    async fn answer(
        &self,
        unit: &mut IngestUnit<'_>,
        request: &LeaseRequest,
        decision: LeaseDecision,
        lease: &FactoryLease,
    ) -> Result<(), StoreError> {
        // A broker may serve two consumers of one address in turns, so that each would get the
        // other's answers for ever: of two equal answers each gets one.
        let copies = if lease.contenders.is_empty() { 1 } else { 2 };
        for _ in 0..copies {
            let answer = lease.answer(request, decision, self.heartbeats.silence(), unit.now);
            unit.work.outgoing().add(&outgoing(answer, unit.now)).await?;
        }
        Ok(())
    }

    async fn lease(
        &mut self,
        unit: &mut IngestUnit<'_>,
        factory: &FactoryId,
    ) -> Result<Option<&FactoryLease>, StoreError> {
        if !self.leases.contains_key(factory) {
            let lease = unit.work.leases().lookup(factory).await?;
            self.leases.insert(factory.clone(), lease);
        }
        Ok(self.leases.get(factory).and_then(Option::as_ref))
    }
}

fn log(
    factory: &FactoryId,
    request: &LeaseRequest,
    lease: &FactoryLease,
    decision: LeaseDecision,
    former: Option<&str>,
) {
    match decision {
        LeaseDecision::Passed => tracing::info!(
            factory.id = %factory, host = %request.host, former,
            "The lease of a factory has passed."
        ),
        LeaseDecision::Refused { is_new: true } => tracing::warn!(
            factory.id = %factory, host = %request.host, holder = &lease.holder.host,
            "A second connector with the credential of a factory was refused. Stop it, or hand \
             the lease over."
        ),
        LeaseDecision::Renewed | LeaseDecision::Refused { is_new: false } => {}
    }
}

fn outgoing(answer: Lease, now: DateTime) -> NewOutgoing {
    let address = LogicalAddress::FactoryLeases(answer.factory_id.clone());
    let (message_id, correlation_id) = (answer.message_id.clone(), answer.correlation_id.clone());
    let message = PlatformMessage::Lease(answer);
    let body = serde_json::to_vec(&message).expect("messages have text keys only");
    let envelope = Envelope::new(message_id.clone(), message.message_type(), body);
    NewOutgoing {
        address,
        message_id,
        subject: envelope.subject,
        correlation_id: Some(correlation_id),
        created_at: now,
        time_to_live: Some(ANSWER_LIFE),
        content_encoding: None,
        body: envelope.body,
    }
}
