//! Reading messages from a factory.

use super::{
    LIST_MAX,
    disclosure::disclosure,
    lists::{not_empty, recipients},
    message_members::{
        ASSET_KINDS, comment, epoch, factory_id, kinds, message_type, number, revision, writer_id,
    },
    past_release::past_release,
    reader::Reader,
};
use crate::{
    json::JsonNode,
    messages::{
        Acknowledgement, AcknowledgementResult, AssetKind, AssetOffer, Decision, DecisionTarget,
        FactoryMessage, Fault, Gap, GapCause, LeaseRequest, LedgerCheckpoint, MappingState,
        ReceiptRequest, SignedRevocation, WriterSequences,
    },
};

pub(super) fn factory_message(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
) -> Option<FactoryMessage> {
    if !reader.is_object(root, "A message") {
        return None;
    }
    const TYPES: [&str; 10] = [
        "acknowledgement",
        "decision",
        "gap",
        "comment",
        "asset-offer",
        "lease-request",
        "revocation",
        "ledger-checkpoint",
        "past-release",
        "receipt-request",
    ];
    Some(match message_type(reader, root, &TYPES)? {
        "acknowledgement" => FactoryMessage::Acknowledgement(acknowledgement(reader, root)),
        "decision" => FactoryMessage::Decision(decision(reader, root)?),
        "gap" => FactoryMessage::Gap(gap(reader, root)),
        "comment" => FactoryMessage::Comment(comment(reader, root, None)),
        "lease-request" => FactoryMessage::LeaseRequest(lease_request(reader, root)?),
        "revocation" => FactoryMessage::Revocation(revocation(reader, root)),
        "ledger-checkpoint" => FactoryMessage::LedgerCheckpoint(ledger_checkpoint(reader, root)),
        "past-release" => FactoryMessage::PastRelease(past_release(reader, root)?),
        "receipt-request" => FactoryMessage::ReceiptRequest(receipt_request(reader, root)),
        _ => FactoryMessage::AssetOffer(AssetOffer {
            message_id: reader.required_id(root, "messageId"),
            factory_id: factory_id(reader, root, None),
            asset_id: reader.required_id(root, "assetId"),
            kind_list: kinds(reader, root),
            description: reader.required(root, "description", Reader::text).unwrap_or_default(),
        }),
    })
}

fn acknowledgement(reader: &mut Reader, root: JsonNode<'_, '_>) -> Acknowledgement {
    const RESULTS: [(&str, AcknowledgementResult); 3] = [
        ("ACCEPTED", AcknowledgementResult::Accepted),
        ("UNCHANGED", AcknowledgementResult::Unchanged),
        ("REJECTED", AcknowledgementResult::Rejected),
    ];
    Acknowledgement {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        correlation_id: reader.required_id(root, "correlationId"),
        operation_network_id: reader.optional(root, "operationNetworkId", Reader::id),
        revision: root
            .get("revision")
            .filter(|node| !node.is_null())
            .map(|_| revision(reader, root)),
        result: reader
            .required(root, "result", |reader, node| reader.choice(node, &RESULTS))
            .unwrap_or(AcknowledgementResult::Rejected),
        fault_list: reader.optional_list(root, "faultList", LIST_MAX, |reader, node| {
            if !reader.is_object(node, "A fault") {
                return None;
            }
            let pointer = reader.required(node, "pointer", Reader::text);
            let code = reader.required(node, "code", Reader::name);
            let message = reader.required(node, "message", Reader::text);
            Some(Fault { pointer: pointer?, code: code?, message: message? })
        }),
    }
}

fn decision(reader: &mut Reader, root: JsonNode<'_, '_>) -> Option<Decision> {
    const STATES: [(&str, MappingState); 3] = [
        ("PENDING", MappingState::Pending),
        ("MAPPED", MappingState::Mapped),
        ("REFUSED", MappingState::Refused),
    ];
    let message_id = reader.required_id(root, "messageId");
    let factory_id = factory_id(reader, root, None);
    let target = if root.get("assetId").is_some() {
        DecisionTarget::Asset {
            asset_id: reader.required_id(root, "assetId"),
            kind: reader
                .required(root, "kind", |reader, node| reader.choice(node, &ASSET_KINDS))
                .unwrap_or(AssetKind::Condition),
        }
    } else {
        DecisionTarget::Field {
            operation_network_id: reader.required_id(root, "operationNetworkId"),
            operation_id: reader.required_id(root, "operationId"),
            dynamic_data_request_id: reader.required_id(root, "dynamicDataRequestId"),
            field_name: reader.required_id(root, "fieldName"),
        }
    };
    let mapping_state =
        reader.required(root, "mappingState", |reader, node| reader.choice(node, &STATES));
    let reason = reader.optional(root, "reason", Reader::text);
    let decided_at = reader.required(root, "decidedAt", Reader::time);
    let disclosure = reader.optional(root, "disclosure", disclosure).map(Box::new);
    Some(Decision {
        message_id,
        factory_id,
        target,
        mapping_state: mapping_state?,
        reason,
        decided_at: decided_at?,
        disclosure,
    })
}

fn gap(reader: &mut Reader, root: JsonNode<'_, '_>) -> Gap {
    const CAUSES: [(&str, GapCause); 4] = [
        ("COALESCED", GapCause::Coalesced),
        ("EXPIRED", GapCause::Expired),
        ("WITHDRAWN", GapCause::Withdrawn),
        ("REVOKED", GapCause::Revoked),
    ];
    Gap {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        data_set_writer_id: writer_id(reader, root).unwrap_or_default(),
        epoch: number(reader, root, "epoch").unwrap_or_default(),
        first_sequence: number(reader, root, "firstSequence").unwrap_or_default(),
        last_sequence: number(reader, root, "lastSequence").unwrap_or_default(),
        cause: reader
            .required(root, "cause", |reader, node| reader.choice(node, &CAUSES))
            .unwrap_or(GapCause::Coalesced),
    }
}

fn receipt_request(reader: &mut Reader, root: JsonNode<'_, '_>) -> ReceiptRequest {
    let request = ReceiptRequest {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        writer_list: reader.list(root, "writerList", LIST_MAX, writer_sequences),
    };
    not_empty(reader, root, "writerList");
    request
}

fn writer_sequences(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<WriterSequences> {
    if !reader.is_object(node, "A writer") {
        return None;
    }
    let data_set_writer_id = writer_id(reader, node);
    let epoch = number(reader, node, "epoch");
    let through_sequence = number(reader, node, "throughSequence");
    Some(WriterSequences {
        data_set_writer_id: data_set_writer_id?,
        epoch: epoch?,
        through_sequence: through_sequence?,
    })
}

fn revocation(reader: &mut Reader, root: JsonNode<'_, '_>) -> SignedRevocation {
    SignedRevocation {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        operation_network_id: reader.required_id(root, "operationNetworkId"),
        operation_id: reader.required_id(root, "operationId"),
        dynamic_data_request_id: reader.required_id(root, "dynamicDataRequestId"),
        recipient_list: recipients(reader, root),
        signed_text: reader.required(root, "signedText", Reader::document).unwrap_or_default(),
        signature: reader.required(root, "signature", Reader::name).unwrap_or_default(),
        public_key: reader.required(root, "publicKey", Reader::name).unwrap_or_default(),
    }
}

fn lease_request(reader: &mut Reader, root: JsonNode<'_, '_>) -> Option<LeaseRequest> {
    let started_at = reader.required(root, "startedAt", Reader::time);
    Some(LeaseRequest {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        instance_id: reader.required_id(root, "instanceId"),
        place: reader.required_id(root, "place"),
        host: reader.required(root, "host", Reader::name).unwrap_or_default(),
        started_at: started_at?,
    })
}

fn ledger_checkpoint(reader: &mut Reader, root: JsonNode<'_, '_>) -> LedgerCheckpoint {
    LedgerCheckpoint {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, None),
        recipient_id: reader.required_id(root, "recipientId"),
        epoch: epoch(reader, root),
        verifier_key: reader
            .required(root, "verifierKey", Reader::non_empty_text)
            .unwrap_or_default(),
        add_checkpoint: reader
            .required(root, "addCheckpoint", Reader::non_empty_text)
            .unwrap_or_default(),
    }
}
