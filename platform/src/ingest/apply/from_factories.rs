//! What a factory says beside its reports: acknowledgements, decisions, gaps, comments.

use asi_model::{
    RequestKey,
    messages::{
        Acknowledgement, AcknowledgementResult, Decision, DecisionTarget, FactoryMessage, Gap,
    },
};
use messaging::LogicalAddress;

use super::Applier;
use crate::{
    ingest::decode::Incoming,
    live::LiveEvent,
    store::{NewComment, PartState, Scope, StoreError},
};

impl Applier<'_> {
    pub(super) async fn factory_message(
        &mut self,
        address: &LogicalAddress,
        incoming: &Incoming,
        message: &FactoryMessage,
    ) -> Result<(), StoreError> {
        match message {
            FactoryMessage::Acknowledgement(acknowledgement) => {
                self.acknowledgement(acknowledgement).await
            }
            FactoryMessage::Decision(decision) => self.decision(decision).await,
            FactoryMessage::Gap(gap) => self.gap(gap).await,
            FactoryMessage::Comment(comment) => {
                let network = self
                    .work
                    .networks()
                    .lookup(&Scope::Platform, &comment.operation_network_id)
                    .await?;
                let parts = self.work.parts().of_network(&comment.operation_network_id).await?;
                let has_part = parts.iter().any(|part| part.factory_id == comment.factory_id);
                let Some(network) = network.filter(|_| has_part) else {
                    let reason = format!(
                        "{} has no part in {}.",
                        comment.factory_id, comment.operation_network_id
                    );
                    return self.refuse_from(address, incoming, "UNKNOWN_NETWORK", reason).await;
                };
                let new = NewComment {
                    operation_network_id: comment.operation_network_id.clone(),
                    factory_id: comment.factory_id.clone(),
                    dynamic_data_request_id: comment.dynamic_data_request_id.clone(),
                    field_name: comment.field_name.clone(),
                    author_id: comment.author_id.chars().take(200).collect(),
                    is_from_factory: true,
                    text: comment.text.chars().take(10_000).collect(),
                    created_at: incoming.received_at,
                };
                let comment_id = self.work.comments().add(&new).await?;
                let members = self.members(&network.collaboration_id).await?;
                let operation_network_id = comment.operation_network_id.clone();
                self.effects
                    .news
                    .push(LiveEvent::Comment { operation_network_id, comment_id }.to(members));
                Ok(())
            }
            FactoryMessage::AssetOffer(offer) => {
                self.work.meta_data().put_offer(offer, incoming.received_at).await
            }
            // Answered before anything else of its batch.
            FactoryMessage::LeaseRequest(_) => Ok(()),
        }
    }

    async fn acknowledgement(&mut self, answer: &Acknowledgement) -> Result<(), StoreError> {
        let network = answer.operation_network_id.as_ref();
        let part = self
            .work
            .parts()
            .of_answer(&answer.factory_id, &answer.correlation_id, network)
            .await?;
        let Some(mut part) = part else { return Ok(()) };
        let is_for_this =
            part.message_id == answer.correlation_id || answer.revision == Some(part.revision);
        // An answer to an older revision says nothing of the one in effect; one that repeats says
        // nothing new.
        if !is_for_this
            || (part.state != PartState::Sent && answer.result == AcknowledgementResult::Unchanged)
        {
            return Ok(());
        }
        part.state = match answer.result {
            AcknowledgementResult::Accepted => PartState::Accepted,
            AcknowledgementResult::Unchanged => PartState::Unchanged,
            AcknowledgementResult::Rejected => PartState::Rejected,
        };
        part.fault_list.clone_from(&answer.fault_list);
        part.acknowledged_at = Some(self.now);
        self.work.parts().put(&part).await?;
        let row = self.work.networks().lookup(&Scope::Platform, &part.operation_network_id).await?;
        let Some(row) = row else { return Ok(()) };
        let members = self.members(&row.collaboration_id).await?;
        let event = LiveEvent::Part {
            operation_network_id: part.operation_network_id,
            factory_id: part.factory_id,
            revision: part.revision,
            state: part.state,
            fault_list: part.fault_list,
        };
        self.effects.news.push(event.to(members));
        Ok(())
    }

    async fn decision(&mut self, decision: &Decision) -> Result<(), StoreError> {
        let DecisionTarget::Field {
            operation_network_id,
            operation_id,
            dynamic_data_request_id,
            field_name,
        } = &decision.target
        else {
            return Ok(());
        };
        let request = RequestKey {
            operation_network_id: operation_network_id.clone(),
            operation_id: operation_id.clone(),
            dynamic_data_request_id: dynamic_data_request_id.clone(),
        };
        let key = request.field(field_name.clone());
        if !self.work.fields().decide(&key, decision).await? {
            return Ok(());
        }
        let concerned = self
            .work
            .fields()
            .concerned(operation_network_id, dynamic_data_request_id.as_str())
            .await?;
        let event = LiveEvent::Decision {
            key,
            mapping_state: decision.mapping_state,
            reason: decision.reason.clone(),
            decided_at: decision.decided_at,
        };
        self.effects.news.push(event.to(concerned));
        Ok(())
    }

    async fn gap(&mut self, gap: &Gap) -> Result<(), StoreError> {
        let writer = self.writer(&gap.factory_id, gap.data_set_writer_id, gap.epoch).await?;
        writer.sequences.add_range(gap.first_sequence, gap.last_sequence);
        writer.needs_receipt = true;
        self.work.writers().add_gap(gap, self.now).await
    }
}
