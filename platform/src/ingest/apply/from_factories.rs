//! Messages of factories other than reports: acknowledgements, decisions, gaps, comments, offers.

use asi_model::{
    FactoryId, FieldKey, RequestKey,
    messages::{
        Acknowledgement, AcknowledgementResult, Comment, Decision, DecisionTarget, FactoryMessage,
        Gap, MappingState, ReceiptRequest, SignedRevocation,
    },
};
use messaging::LogicalAddress;

use crate::{
    clock::new_opaque_id,
    ingest::{decode::Incoming, quota_arbiter::GAPS, unit::IngestUnit},
    live::LiveEvent,
    networks,
    store::{
        AuditFact, AuditFactKind, DecisionEffect, Holder, NewComment, PartState, Scope, StoreError,
        state_name,
    },
};

/// Longest stored author of a comment.
const AUTHOR_CHARS_MAX: usize = 200;
/// Longest stored text of a comment.
const TEXT_CHARS_MAX: usize = 10_000;

/// Applies one message of a factory. Returns the effect of a decision.
pub(super) async fn apply(
    unit: &mut IngestUnit<'_>,
    address: &LogicalAddress,
    incoming: &Incoming,
    message: &FactoryMessage,
) -> Result<Option<DecisionEffect>, StoreError> {
    match message {
        FactoryMessage::Acknowledgement(answer) => acknowledgement(unit, answer).await?,
        FactoryMessage::Decision(message) => {
            return decision(unit, address, incoming, message).await.map(Some);
        }
        FactoryMessage::Gap(message) => gap(unit, message).await?,
        FactoryMessage::ReceiptRequest(request) => receipt_request(unit, request).await?,
        FactoryMessage::Comment(message) => comment(unit, address, incoming, message).await?,
        FactoryMessage::AssetOffer(offer) => {
            unit.work.meta_data().put_offer(offer, incoming.received_at).await?;
        }
        FactoryMessage::Revocation(message) => {
            revocation(unit, address, incoming, message).await?;
        }
        // Answered by the lease arbiter, before the rest of the batch, and by the witness.
        FactoryMessage::LeaseRequest(_) | FactoryMessage::LedgerCheckpoint(_) => {}
        // Applied with the reports, some of which may be in the same batch.
        FactoryMessage::PastRelease(_) => {}
    }
    Ok(None)
}

async fn comment(
    unit: &mut IngestUnit<'_>,
    address: &LogicalAddress,
    incoming: &Incoming,
    comment: &Comment,
) -> Result<(), StoreError> {
    let id = &comment.operation_network_id;
    let network = unit.work.networks().lookup(&Scope::Platform, id).await?;
    let parts = unit.work.parts().of_network(id).await?;
    let has_part = parts.iter().any(|part| part.factory_id == comment.factory_id);
    if network.is_none() || !has_part {
        let reason = format!("{} has no part in {id}.", comment.factory_id);
        return unit.reject(address, incoming, "UNKNOWN_NETWORK", reason).await;
    }
    if let Some(request) = &comment.dynamic_data_request_id
        && !unit.work.asked_requests().is_asked(id, request, &comment.factory_id).await?
    {
        let about = format!("{id}/{request}");
        return unit.reject_foreign(address, incoming, &comment.factory_id, about).await;
    }
    let new = NewComment {
        comment_id: new_opaque_id(),
        operation_network_id: id.clone(),
        factory_id: comment.factory_id.clone(),
        dynamic_data_request_id: comment.dynamic_data_request_id.clone(),
        field_name: comment.field_name.clone(),
        author_id: stated_author(&comment.author_id, &comment.factory_id),
        is_from_factory: true,
        text: comment.text.chars().take(TEXT_CHARS_MAX).collect(),
        created_at: incoming.received_at,
    };
    unit.work.comments().add(&new).await?;
    let mut facts = vec![AuditFact::new(AuditFactKind::Person, &new.author_id)];
    let request = new.dynamic_data_request_id.as_ref();
    facts.extend(request.map(|id| AuditFact::new(AuditFactKind::Request, id)));
    let path = format!("operation-networks/{id}/comments/{}", new.comment_id);
    unit.record_change(&new.factory_id, "addComment", path, &facts).await?;
    let event = networks::comment_added(unit.work, id, &new.comment_id).await?;
    unit.effects.notifications.push(event);
    Ok(())
}

/// Returns an author as a factory states it, with the factory: the platform vouches for that alone. What is
/// not shown or turns the direction of a text is left out, or one name could look like another.
fn stated_author(name: &str, factory: &FactoryId) -> String {
    let is_shown = |sign: &char| {
        let is_invisible = matches!(sign, '\u{200B}'..='\u{200F}' | '\u{202A}'..='\u{202E}'
            | '\u{2060}'..='\u{2069}' | '\u{FEFF}');
        !sign.is_control() && !is_invisible
    };
    let name: String = name.chars().filter(is_shown).take(AUTHOR_CHARS_MAX).collect();
    format!("{name}@{factory}")
}

/// Stores the signed receipt of a revocation for those who received the values. Its text is not
/// checked here: its readers do, with the factory's key. Nobody reads it who was no recipient of the
/// request, or a factory could place documents before any organisation.
async fn revocation(
    unit: &mut IngestUnit<'_>,
    address: &LogicalAddress,
    incoming: &Incoming,
    receipt: &SignedRevocation,
) -> Result<(), StoreError> {
    let (network, request) = (&receipt.operation_network_id, &receipt.dynamic_data_request_id);
    if !unit.work.asked_requests().is_asked(network, request, &receipt.factory_id).await? {
        let about = format!("{network}/{request}");
        return unit.reject_foreign(address, incoming, &receipt.factory_id, about).await;
    }
    if !unit.work.revocations().add(&new_opaque_id(), receipt, incoming.received_at).await? {
        return Ok(());
    }
    let recipient = |id| AuditFact::new(AuditFactKind::Recipient, id);
    let facts: Vec<AuditFact> = receipt.recipient_list.iter().map(recipient).collect();
    let path = request_path(&RequestKey {
        operation_network_id: network.clone(),
        operation_id: receipt.operation_id.clone(),
        dynamic_data_request_id: request.clone(),
    });
    unit.record_change(&receipt.factory_id, "revokeConsent", path, &facts).await
}

/// Records the answer to a part of a network.
async fn acknowledgement(
    unit: &mut IngestUnit<'_>,
    answer: &Acknowledgement,
) -> Result<(), StoreError> {
    let network = answer.operation_network_id.as_ref();
    let part =
        unit.work.parts().of_answer(&answer.factory_id, &answer.correlation_id, network).await?;
    let Some(mut part) = part else { return Ok(()) };
    let is_for_this =
        part.message_id == answer.correlation_id || answer.revision == Some(part.revision);
    // An answer to an older revision says nothing about the one in effect, and a repeated answer
    // nothing new.
    if !is_for_this
        || (part.state != PartState::Sent && answer.result == AcknowledgementResult::Unchanged)
    {
        return Ok(());
    }
    let before = (part.state, part.fault_list.clone());
    part.state = match answer.result {
        AcknowledgementResult::Accepted => PartState::Accepted,
        AcknowledgementResult::Unchanged => PartState::Unchanged,
        AcknowledgementResult::Rejected => PartState::Rejected,
    };
    part.fault_list.clone_from(&answer.fault_list);
    part.acknowledged_at = Some(unit.now);
    unit.work.parts().put(&part).await?;
    if before.0 != part.state || before.1 != part.fault_list {
        let path = format!("operation-networks/{}", part.operation_network_id);
        let facts = [
            AuditFact::new(AuditFactKind::Revision, part.revision),
            AuditFact::new(AuditFactKind::State, part.state.as_str()),
        ];
        unit.record_change(&part.factory_id, "answerOperationNetwork", path, &facts).await?;
    }
    if part.state != PartState::Rejected {
        let (network, factory) = (&part.operation_network_id, &part.factory_id);
        unit.work.recipients().consent_where_open(network, factory).await?;
    }
    let events = networks::part_changed(unit.work, &part).await?;
    unit.effects.notifications.extend(events);
    Ok(())
}

/// Stores a decision about a field, unless a later one is stored.
async fn decision(
    unit: &mut IngestUnit<'_>,
    address: &LogicalAddress,
    incoming: &Incoming,
    decision: &Decision,
) -> Result<DecisionEffect, StoreError> {
    let Some(key) = decided_field(decision) else { return Ok(DecisionEffect::Ignored) };
    let (network, request) =
        (&key.request.operation_network_id, &key.request.dynamic_data_request_id);
    if !unit.work.asked_requests().is_asked(network, request, &decision.factory_id).await? {
        unit.reject_foreign(address, incoming, &decision.factory_id, &key.request).await?;
        return Ok(DecisionEffect::Ignored);
    }
    let effect = unit.work.fields().decide(&key, decision).await?;
    if effect == DecisionEffect::Ignored {
        return Ok(effect);
    }
    if effect != DecisionEffect::Repeated {
        let path = format!("{}/fields/{}", request_path(&key.request), key.field_name);
        let state = AuditFact::new(AuditFactKind::State, state_name(decision.mapping_state));
        unit.record_change(&decision.factory_id, "decideField", path, &[state]).await?;
    }
    if decision.mapping_state == MappingState::Mapped {
        let (factory, at) = (&decision.factory_id, decision.decided_at);
        unit.work.recipients().consent(network, request, factory, at).await?;
    }
    let audience = unit.work.fields().audience(network, request, &decision.factory_id).await?;
    let event = |reason: Option<String>| LiveEvent::Decision {
        key: key.clone(),
        mapping_state: decision.mapping_state,
        reason,
        decided_at: decision.decided_at,
    };
    unit.effects.notifications.extend([
        event(decision.reason.clone()).to(audience.whole),
        event(None).to(audience.others),
    ]);
    Ok(effect)
}

/// Returns the place of a request in the API.
pub(super) fn request_path(request: &RequestKey) -> String {
    let (network, operation) = (&request.operation_network_id, &request.operation_id);
    let id = &request.dynamic_data_request_id;
    format!("operation-networks/{network}/operations/{operation}/requests/{id}")
}

/// Returns the field that a decision is about; `None` for one about an asset.
pub(super) fn decided_field(decision: &Decision) -> Option<FieldKey> {
    let DecisionTarget::Field {
        operation_network_id,
        operation_id,
        dynamic_data_request_id,
        field_name,
    } = &decision.target
    else {
        return None;
    };
    let request = RequestKey {
        operation_network_id: operation_network_id.clone(),
        operation_id: operation_id.clone(),
        dynamic_data_request_id: dynamic_data_request_id.clone(),
    };
    Some(request.field(field_name.clone()))
}

/// Counts announced numbers as received, so that no receipt lists them as missing. A gap never
/// denies a report that is held: only the numbers that are absent are stored as given up.
async fn gap(unit: &mut IngestUnit<'_>, gap: &Gap) -> Result<(), StoreError> {
    let writer = unit.writer(&gap.factory_id, gap.data_set_writer_id, gap.epoch).await?;
    let absent = writer.sequences.absent(gap.first_sequence, gap.last_sequence);
    let coarse = writer.sequences.coarse_through();
    writer.sequences.add_range(gap.first_sequence, gap.last_sequence);
    writer.needs_receipt = true;
    let mut is_within = writer.sequences.coarse_through() == coarse;
    if !absent.is_empty() {
        is_within &= unit.work.writers().add_gaps(gap, &absent, unit.now).await?;
    }
    if !is_within {
        unit.effects.refused(GAPS, Holder::Factory(gap.factory_id.clone()));
    }
    Ok(())
}

/// Lets the next receipts name the writers that a connector asks about, with everything that is missing
/// of them.
async fn receipt_request(
    unit: &mut IngestUnit<'_>,
    request: &ReceiptRequest,
) -> Result<(), StoreError> {
    for asked in &request.writer_list {
        let writer =
            unit.writer(&request.factory_id, asked.data_set_writer_id, asked.epoch).await?;
        writer.sequences.expect_through(asked.through_sequence);
        writer.needs_receipt = true;
    }
    Ok(())
}
