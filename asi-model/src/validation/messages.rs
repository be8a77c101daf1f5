//! Reading the messages of both directions.

use super::{FaultCode, LIST_MAX, REVISION_MAX, network, reader::Reader};
use crate::{
    ids::{FactoryId, OrganisationId},
    json::{Kind, Node},
    messages::{
        Acknowledgement, AcknowledgementResult, AggregateStatement, AssetKind, AssetOffer,
        AssetRequest, Comment, Decision, DecisionTarget, DisclosureStatement, FactoryMessage,
        Fault, Gap, GapCause, HoursStatement, Lease, LeaseParty, LeaseRequest, LeaseResult,
        MappingState, OperationNetworkMessage, PlatformMessage, RateStatement, Receipt, Withdraw,
        WriterReceipt,
    },
};

/// Most writers in one receipt and most missing numbers of one writer.
const RECEIPTS_MAX: usize = 10_000;
/// Most limits of the rate that one disclosure states.
const RATE_LIMITS_MAX: usize = 16;
/// Most ranges of hours of one disclosure.
const HOURS_MAX: usize = 32;
/// Most bands of one disclosure.
const BANDS_MAX: usize = 1_000;
const DAYS: [(&str, &str); 7] = [
    ("MONDAY", "MONDAY"),
    ("TUESDAY", "TUESDAY"),
    ("WEDNESDAY", "WEDNESDAY"),
    ("THURSDAY", "THURSDAY"),
    ("FRIDAY", "FRIDAY"),
    ("SATURDAY", "SATURDAY"),
    ("SUNDAY", "SUNDAY"),
];
const ASSET_KINDS: [(&str, AssetKind); 4] = [
    ("POSE", AssetKind::Pose),
    ("POWER", AssetKind::Power),
    ("CONDITION", AssetKind::Condition),
    ("SAFETY", AssetKind::Safety),
];

pub(super) fn platform_message(
    reader: &mut Reader,
    root: Node<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<PlatformMessage> {
    if !reader.is_object(root, "A message") {
        return None;
    }
    const TYPES: [&str; 6] =
        ["operation-network", "withdraw", "comment", "asset-request", "receipt", "lease"];
    let message = match message_type(reader, root, &TYPES)? {
        "operation-network" => {
            PlatformMessage::OperationNetwork(operation_network(reader, root, expected)?)
        }
        "withdraw" => PlatformMessage::Withdraw(Withdraw {
            message_id: reader.required_id(root, "messageId"),
            factory_id: factory_id(reader, root, expected),
            operation_network_id: reader.required_id(root, "operationNetworkId"),
            revision: revision(reader, root),
        }),
        "comment" => PlatformMessage::Comment(comment(reader, root, expected)),
        "asset-request" => PlatformMessage::AssetRequest(asset_request(reader, root, expected)),
        "lease" => PlatformMessage::Lease(lease(reader, root, expected)?),
        _ => PlatformMessage::Receipt(Receipt {
            message_id: reader.required_id(root, "messageId"),
            factory_id: factory_id(reader, root, expected),
            receipt_list: reader.list(root, "receiptList", RECEIPTS_MAX, writer_receipt),
        }),
    };
    Some(message)
}

pub(super) fn factory_message(reader: &mut Reader, root: Node<'_, '_>) -> Option<FactoryMessage> {
    if !reader.is_object(root, "A message") {
        return None;
    }
    const TYPES: [&str; 6] =
        ["acknowledgement", "decision", "gap", "comment", "asset-offer", "lease-request"];
    Some(match message_type(reader, root, &TYPES)? {
        "acknowledgement" => FactoryMessage::Acknowledgement(acknowledgement(reader, root)),
        "decision" => FactoryMessage::Decision(decision(reader, root)?),
        "gap" => FactoryMessage::Gap(gap(reader, root)),
        "comment" => FactoryMessage::Comment(comment(reader, root, None)),
        "lease-request" => FactoryMessage::LeaseRequest(lease_request(reader, root)?),
        _ => FactoryMessage::AssetOffer(AssetOffer {
            message_id: reader.required_id(root, "messageId"),
            factory_id: factory_id(reader, root, None),
            asset_id: reader.required_id(root, "assetId"),
            kind_list: kinds(reader, root),
            description: reader.required(root, "description", Reader::text).unwrap_or_default(),
        }),
    })
}

fn message_type(
    reader: &mut Reader,
    root: Node<'_, '_>,
    known: &[&'static str],
) -> Option<&'static str> {
    reader.required(root, "messageType", |reader, node| {
        let found = known.iter().find(|name| node.is_text(name)).copied();
        if found.is_none() {
            let message = format!("The message type must be one of {}.", known.join(", "));
            reader.fault(node, FaultCode::UnknownMessageType, message);
        }
        found
    })
}

fn factory_id(reader: &mut Reader, root: Node<'_, '_>, expected: Option<&FactoryId>) -> FactoryId {
    let found: FactoryId = reader.required_id(root, "factoryId");
    if let (Some(expected), Some(node)) = (expected, root.get("factoryId"))
        && node.kind() == Kind::String
        && found != *expected
    {
        reader.fault(
            node,
            FaultCode::WrongFactory,
            format!("The message has reached {expected}, but is for another factory."),
        );
    }
    found
}

fn revision(reader: &mut Reader, root: Node<'_, '_>) -> u64 {
    let revision = reader.required(root, "revision", |reader, node| {
        let revision = reader.integer(node, "a revision as a number from 0")?;
        if revision > REVISION_MAX {
            reader.fault(
                node,
                FaultCode::InvalidValue,
                format!("A revision may be at most {REVISION_MAX}."),
            );
        }
        Some(revision)
    });
    revision.unwrap_or_default()
}

fn operation_network(
    reader: &mut Reader,
    root: Node<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<OperationNetworkMessage> {
    let message_id = reader.required_id(root, "messageId");
    let factory_id = factory_id(reader, root, expected);
    let collaboration_id = reader.required_id(root, "collaborationId");
    let revision = revision(reader, root);
    let unreadable_before = reader.unreadable_ids;
    let operation_network = reader.required(root, "operationNetwork", network::read)?;
    // Only unreadable ids of the network spoil the check of its references.
    reader.unreadable_ids -= unreadable_before;
    network::check(&operation_network, "/operationNetwork", Some(&factory_id), reader);
    Some(OperationNetworkMessage {
        message_id,
        factory_id,
        collaboration_id,
        revision,
        operation_network,
    })
}

fn comment(reader: &mut Reader, root: Node<'_, '_>, expected: Option<&FactoryId>) -> Comment {
    Comment {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        operation_network_id: reader.required_id(root, "operationNetworkId"),
        dynamic_data_request_id: reader.optional(root, "dynamicDataRequestId", Reader::id),
        field_name: reader.optional(root, "fieldName", Reader::id),
        author_id: reader.required(root, "authorId", Reader::name).unwrap_or_default(),
        text: reader.required(root, "text", Reader::said).unwrap_or_default(),
    }
}

fn kinds(reader: &mut Reader, root: Node<'_, '_>) -> Vec<AssetKind> {
    let kinds = reader.list(root, "kindList", ASSET_KINDS.len(), |reader, node| {
        reader.choice(node, &ASSET_KINDS)
    });
    not_empty(reader, root, "kindList");
    kinds
}

/// Notes a list that is there and empty.
pub(super) fn not_empty(reader: &mut Reader, object: Node<'_, '_>, name: &str) {
    if let Some(list) = object.get(name)
        && list.kind() == Kind::Array
        && list.elements().next().is_none()
    {
        reader.fault(list, FaultCode::EmptyList, "The list must have at least one element.");
    }
}

pub(super) fn recipients(reader: &mut Reader, object: Node<'_, '_>) -> Vec<OrganisationId> {
    let mut seen = std::collections::HashSet::new();
    let recipients = reader.list(object, "recipientList", LIST_MAX, |reader, node| {
        let id: OrganisationId = reader.id(node)?;
        if !seen.insert(id.clone()) {
            reader.fault(node, FaultCode::DuplicateId, "The recipient is listed twice.");
        }
        Some(id)
    });
    not_empty(reader, object, "recipientList");
    recipients
}

fn asset_request(
    reader: &mut Reader,
    root: Node<'_, '_>,
    expected: Option<&FactoryId>,
) -> AssetRequest {
    AssetRequest {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        asset_id: reader.required_id(root, "assetId"),
        kind_list: kinds(reader, root),
        requester_id: reader.required_id(root, "requesterId"),
        recipient_list: recipients(reader, root),
        purpose: reader.required(root, "purpose", Reader::said).unwrap_or_default(),
        valid_until: reader.optional(root, "validUntil", Reader::time),
    }
}

fn writer_receipt(reader: &mut Reader, node: Node<'_, '_>) -> Option<WriterReceipt> {
    if !reader.is_object(node, "A receipt") {
        return None;
    }
    Some(WriterReceipt {
        data_set_writer_id: writer_id(reader, node)?,
        epoch: number(reader, node, "epoch")?,
        through_sequence: number(reader, node, "throughSequence")?,
        missing_list: reader.optional_list(node, "missingList", RECEIPTS_MAX, |reader, node| {
            reader.integer(node, "a number from 0 to 4294967295")
        }),
    })
}

fn writer_id(reader: &mut Reader, object: Node<'_, '_>) -> Option<u16> {
    reader.required(object, "dataSetWriterId", |reader, node| {
        reader.integer(node, "a number from 0 to 65535")
    })
}

fn number(reader: &mut Reader, object: Node<'_, '_>, name: &str) -> Option<u32> {
    reader.required(object, name, |reader, node| {
        reader.integer(node, "a number from 0 to 4294967295")
    })
}

fn acknowledgement(reader: &mut Reader, root: Node<'_, '_>) -> Acknowledgement {
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
            Some(Fault {
                pointer: reader.required(node, "pointer", Reader::text)?,
                code: reader.required(node, "code", Reader::name)?,
                message: reader.required(node, "message", Reader::text)?,
            })
        }),
    }
}

fn decision(reader: &mut Reader, root: Node<'_, '_>) -> Option<Decision> {
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

fn disclosure(reader: &mut Reader, node: Node<'_, '_>) -> Option<DisclosureStatement> {
    if !reader.is_object(node, "A disclosure") {
        return None;
    }
    let millis = |reader: &mut Reader, name: &str| reader.optional(node, name, milliseconds);
    Some(DisclosureStatement {
        description: reader.required(node, "description", Reader::text).unwrap_or_default(),
        rounding_step: reader.optional(node, "roundingStep", Reader::quantity),
        significant_digits: reader.optional(node, "significantDigits", |reader, node| {
            reader.integer(node, "digits as a number from 0")
        }),
        aggregate: reader.optional(node, "aggregate", aggregate),
        minimum_interval_ms: millis(reader, "minimumIntervalMs"),
        rate_limit_list: reader.optional_list(node, "rateLimitList", RATE_LIMITS_MAX, rate),
        time_step_ms: millis(reader, "timeStepMs"),
        delay_ms: millis(reader, "delayMs"),
        band_list: reader.optional_list(node, "bandList", BANDS_MAX, Reader::number),
        hours_list: reader.optional_list(node, "hoursList", HOURS_MAX, hours),
        is_withheld_in_states: reader
            .optional(node, "isWithheldInStates", Reader::boolean)
            .unwrap_or_default(),
    })
}

fn hours(reader: &mut Reader, node: Node<'_, '_>) -> Option<HoursStatement> {
    if !reader.is_object(node, "Hours") {
        return None;
    }
    let day_list =
        reader.list(node, "dayList", DAYS.len(), |reader, node| reader.choice(node, &DAYS));
    let from = reader.required(node, "from", Reader::name);
    let until = reader.required(node, "until", Reader::name);
    let offset =
        |reader: &mut Reader, node: Node<'_, '_>| reader.integer(node, "minutes ahead of UTC");
    let utc_offset_minutes = reader.optional(node, "utcOffsetMinutes", offset).unwrap_or_default();
    let day_list = day_list.into_iter().map(str::to_owned).collect();
    Some(HoursStatement { day_list, from: from?, until: until?, utc_offset_minutes })
}

fn aggregate(reader: &mut Reader, node: Node<'_, '_>) -> Option<AggregateStatement> {
    if !reader.is_object(node, "An aggregate") {
        return None;
    }
    let function = reader.required(node, "function", Reader::text);
    let window_ms = reader.required(node, "windowMs", milliseconds);
    Some(AggregateStatement { function: function?, window_ms: window_ms? })
}

fn rate(reader: &mut Reader, node: Node<'_, '_>) -> Option<RateStatement> {
    if !reader.is_object(node, "A limit of the rate") {
        return None;
    }
    let values = number(reader, node, "values");
    let period_ms = reader.required(node, "periodMs", milliseconds);
    Some(RateStatement { values: values?, period_ms: period_ms? })
}

fn milliseconds(reader: &mut Reader, node: Node<'_, '_>) -> Option<u64> {
    reader.integer(node, "milliseconds as a number from 0")
}

fn gap(reader: &mut Reader, root: Node<'_, '_>) -> Gap {
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

fn lease_request(reader: &mut Reader, root: Node<'_, '_>) -> Option<LeaseRequest> {
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

fn lease(reader: &mut Reader, root: Node<'_, '_>, expected: Option<&FactoryId>) -> Option<Lease> {
    const RESULTS: [(&str, LeaseResult); 2] =
        [("GRANTED", LeaseResult::Granted), ("REFUSED", LeaseResult::Refused)];
    let result = reader.required(root, "result", |reader, node| reader.choice(node, &RESULTS));
    let lease_number = reader.required(root, "leaseNumber", |reader, node| {
        reader.integer(node, "a lease's number from 0")
    });
    Some(Lease {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        correlation_id: reader.required_id(root, "correlationId"),
        instance_id: reader.required_id(root, "instanceId"),
        place: reader.required_id(root, "place"),
        host: reader.required(root, "host", Reader::name).unwrap_or_default(),
        ask_again_ms: reader.required(root, "askAgainMs", milliseconds).unwrap_or_default(),
        holder: reader.optional(root, "holder", lease_party),
        contender: reader.optional(root, "contender", lease_party),
        result: result?,
        lease_number: lease_number?,
    })
}

fn lease_party(reader: &mut Reader, node: Node<'_, '_>) -> Option<LeaseParty> {
    if !reader.is_object(node, "A connector") {
        return None;
    }
    let since = reader.required(node, "since", Reader::time);
    let last_heard_at = reader.required(node, "lastHeardAt", Reader::time);
    Some(LeaseParty {
        instance_id: reader.required_id(node, "instanceId"),
        host: reader.required(node, "host", Reader::name).unwrap_or_default(),
        since: since?,
        last_heard_at: last_heard_at?,
    })
}
