//! Reading messages to a factory.

use super::{
    lists::recipients,
    message_members::{
        comment, epoch, factory_id, kinds, message_type, milliseconds, number, revision, writer_id,
    },
    network,
    reader::Reader,
};
use crate::{
    ids::FactoryId,
    json::JsonNode,
    messages::{
        AssetRequest, Lease, LeaseParty, LeaseResult, LedgerCheckpointResult, LedgerCosignature,
        OperationNetworkMessage, PlatformMessage, Receipt, Withdraw, WriterReceipt,
    },
};

/// Most writers in one receipt and most missing numbers of one writer.
const RECEIPTS_MAX: usize = 10_000;

pub(super) fn platform_message(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<PlatformMessage> {
    if !reader.is_object(root, "A message") {
        return None;
    }
    const TYPES: [&str; 7] = [
        "operation-network",
        "withdraw",
        "comment",
        "asset-request",
        "receipt",
        "lease",
        "ledger-cosignature",
    ];
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
        "ledger-cosignature" => {
            PlatformMessage::LedgerCosignature(ledger_cosignature(reader, root, expected)?)
        }
        _ => PlatformMessage::Receipt(Receipt {
            message_id: reader.required_id(root, "messageId"),
            factory_id: factory_id(reader, root, expected),
            receipt_list: reader.list(root, "receiptList", RECEIPTS_MAX, writer_receipt),
        }),
    };
    Some(message)
}

fn operation_network(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<OperationNetworkMessage> {
    let message_id = reader.required_id(root, "messageId");
    let factory_id = factory_id(reader, root, expected);
    let collaboration_id = reader.required_id(root, "collaborationId");
    let revision = revision(reader, root);
    let operation_network = reader.required(root, "operationNetwork", network::read)?;
    network::check(&operation_network, "/operationNetwork", Some(&factory_id), reader);
    Some(OperationNetworkMessage {
        message_id,
        factory_id,
        collaboration_id,
        revision,
        operation_network,
    })
}

fn asset_request(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> AssetRequest {
    AssetRequest {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        asset_id: reader.required_id(root, "assetId"),
        kind_list: kinds(reader, root),
        requester_id: reader.required_id(root, "requesterId"),
        recipient_list: recipients(reader, root),
        purpose: reader.required(root, "purpose", Reader::non_empty_text).unwrap_or_default(),
        valid_until: reader.optional(root, "validUntil", Reader::time),
    }
}

fn writer_receipt(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<WriterReceipt> {
    if !reader.is_object(node, "A receipt") {
        return None;
    }
    let data_set_writer_id = writer_id(reader, node);
    let epoch = number(reader, node, "epoch");
    let through_sequence = number(reader, node, "throughSequence");
    let missing_list = reader.optional_list(node, "missingList", RECEIPTS_MAX, |reader, node| {
        reader.integer(node, "a number from 0 to 4294967295")
    });
    Some(WriterReceipt {
        data_set_writer_id: data_set_writer_id?,
        epoch: epoch?,
        through_sequence: through_sequence?,
        missing_list,
    })
}

fn lease(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<Lease> {
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

fn lease_party(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<LeaseParty> {
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

fn ledger_cosignature(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> Option<LedgerCosignature> {
    const RESULTS: [(&str, LedgerCheckpointResult); 4] = [
        ("COSIGNED", LedgerCheckpointResult::Cosigned),
        ("STALE", LedgerCheckpointResult::Stale),
        ("INCONSISTENT", LedgerCheckpointResult::Inconsistent),
        ("OTHER_KEY", LedgerCheckpointResult::OtherKey),
    ];
    let result = reader.required(root, "result", |reader, node| reader.choice(node, &RESULTS));
    Some(LedgerCosignature {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        correlation_id: reader.required_id(root, "correlationId"),
        recipient_id: reader.required_id(root, "recipientId"),
        epoch: epoch(reader, root),
        checkpoint: reader.optional(root, "checkpoint", Reader::non_empty_text),
        witness_key: reader
            .required(root, "witnessKey", Reader::non_empty_text)
            .unwrap_or_default(),
        result: result?,
    })
}
