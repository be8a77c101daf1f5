//! Application of received messages to the store, within one unit of work.

mod checkpoints;
mod from_factories;
mod from_tools;
mod past_releases;
mod reports;
#[cfg(test)]
mod tests;

use std::time::Duration;

use asi_model::{DateTime, messages::FactoryMessage};
use messaging::LogicalAddress;

use self::{past_releases::PastReleaseCollector, reports::ReportCollector};
use super::{
    access_arbiter::AccessArbiter,
    decode::{Content, Incoming, describes_recipients},
    heartbeats::Heartbeats,
    lease_arbiter::LeaseArbiter,
    quota_arbiter::QuotaArbiter,
    signature_arbiter::SignatureArbiter,
    unit::{Effects, IngestUnit},
};
use crate::{
    store::{DecisionEffect, NewInboxMessage, StoreError, Work},
    witness::WitnessKey,
};

/// Applies batches of messages to one unit of ingest.
pub(super) struct Applier<'w> {
    unit: IngestUnit<'w>,
    access: AccessArbiter,
    signatures: SignatureArbiter,
    leases: LeaseArbiter<'w>,
    quotas: QuotaArbiter,
    reports: ReportCollector,
    past_releases: PastReleaseCollector,
    resend_after: Duration,
    witness: &'w WitnessKey,
}

impl<'w> Applier<'w> {
    pub(super) fn new(
        work: &'w mut Work,
        now: DateTime,
        resend_after: Duration,
        heartbeats: &'w Heartbeats,
        witness: &'w WitnessKey,
    ) -> Self {
        Self {
            unit: IngestUnit::new(work, now),
            access: AccessArbiter::default(),
            signatures: SignatureArbiter::default(),
            leases: LeaseArbiter::new(heartbeats),
            quotas: QuotaArbiter::default(),
            reports: ReportCollector::default(),
            past_releases: PastReleaseCollector::default(),
            resend_after,
            witness,
        }
    }

    /// Applies a batch of one address, in its order.
    pub(super) async fn batch(
        &mut self,
        address: &LogicalAddress,
        batch: &[Incoming],
    ) -> Result<(), StoreError> {
        let mut admitted = Vec::with_capacity(batch.len());
        for message in batch {
            // First: what is not the factory's own says nothing about its lease.
            if self.access.admit(&mut self.unit, address, message).await?
                && self.signatures.admit(&mut self.unit, address, message).await?
                && self.leases.admit(&mut self.unit, address, message).await?
                && self.quotas.admit(&mut self.unit, address, message).await?
            {
                admitted.push(message);
            }
        }
        let rows: Vec<NewInboxMessage> = admitted
            .iter()
            .filter(|message| is_deduplicated(&message.content))
            .map(|message| inbox_row(message))
            .collect();
        let mut new = self.unit.work.inbox().store(&address.to_string(), &rows).await?;
        for message in admitted {
            if let Some(factory) = address.factory_id() {
                self.unit.record_arrival(factory, message.received_at);
            }
            // The first of several messages with one id removes it, so that repeats within the
            // batch are discarded, too.
            if is_deduplicated(&message.content) && !new.remove(&message.message_id) {
                self.repeat(address, message).await?;
                continue;
            }
            self.message(address, message).await?;
        }
        Ok(())
    }

    /// Writes the collected rows and returns the effects.
    pub(super) async fn finish(mut self) -> Result<Effects, StoreError> {
        self.reports.write(&mut self.unit).await?;
        // After the reports: some of the past may have arrived in this unit.
        self.past_releases.widen(&mut self.unit).await?;
        self.unit.finish().await
    }

    /// Discards a repeat. Its reports are receipted again, for the receipt may have been lost.
    async fn repeat(
        &mut self,
        address: &LogicalAddress,
        message: &Incoming,
    ) -> Result<(), StoreError> {
        self.unit.effects.duplicates += 1;
        if let (Some(factory), Content::Reports { reports, .. }) =
            (address.factory_id(), &message.content)
        {
            for report in reports {
                let writer =
                    self.unit.writer(factory, report.data_set_writer_id, report.epoch).await?;
                writer.duplicates += 1;
                writer.needs_receipt = true;
            }
        }
        Ok(())
    }

    async fn message(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
    ) -> Result<(), StoreError> {
        let unit = &mut self.unit;
        match (&incoming.content, address.factory_id()) {
            (Content::Reports { reports, keep_alives, message }, Some(factory)) => {
                for (writer, epoch) in keep_alives {
                    unit.writer(factory, *writer, *epoch).await?.last_keep_alive_at =
                        Some(incoming.received_at);
                }
                self.reports.collect(unit, factory, incoming, reports, message).await
            }
            (Content::MetaData(writer, meta_data), Some(factory)) => {
                let (received_at, body) = (incoming.received_at, &incoming.body);
                unit.work.meta_data().put(factory, *writer, received_at, body).await?;
                if describes_recipients(meta_data) {
                    unit.record_naming(factory).await?;
                }
                let key = (factory.clone(), *writer);
                unit.effects.meta_data.push((key, (**meta_data).clone()));
                Ok(())
            }
            (Content::Status(state), Some(factory)) => {
                unit.heard(factory).publisher_state = Some(state.name());
                unit.record_sign(factory, incoming.received_at);
                Ok(())
            }
            (Content::Factory(message), Some(_)) => {
                if let FactoryMessage::LedgerCheckpoint(checkpoint) = &**message {
                    let witness = self.witness;
                    return checkpoints::receive(unit, witness, address, incoming, checkpoint)
                        .await;
                }
                let effect = from_factories::apply(unit, address, incoming, message).await?;
                match &**message {
                    FactoryMessage::Decision(decision) => {
                        self.reports.decided(decision, effect.unwrap_or(DecisionEffect::Ignored));
                    }
                    FactoryMessage::Acknowledgement(_) => self.reports.forget_requests(),
                    FactoryMessage::PastRelease(release) => {
                        self.past_releases.collect(unit, address, incoming, release).await?;
                        // Reports of it that come later in this unit are for the recipient, too.
                        self.reports.forget_requests();
                    }
                    _ => {}
                }
                Ok(())
            }
            (Content::DataRequest(request), _) => {
                if from_tools::add_request(unit, request, self.resend_after).await? {
                    self.reports.forget_requests();
                }
                Ok(())
            }
            (Content::Dead(letter), _) => unit.add_dead_letter(letter).await,
            _ => Ok(()),
        }
    }
}

/// Returns true for messages with a lasting effect: their repeats are discarded by message id.
const fn is_deduplicated(content: &Content) -> bool {
    match content {
        Content::Reports { reports, .. } => !reports.is_empty(),
        Content::MetaData(..) | Content::Factory(_) | Content::DataRequest(_) => true,
        Content::Status(_) | Content::Unknown | Content::Dead(_) => false,
    }
}

fn inbox_row(message: &Incoming) -> NewInboxMessage {
    NewInboxMessage {
        message_id: message.message_id.clone(),
        message_type: message.message_type.clone(),
        received_at: message.received_at,
        body: message.body.clone(),
    }
}
