//! Reading members that messages of both directions have.

use super::{FaultCode, REVISION_MAX, lists::not_empty, reader::Reader};
use crate::{
    ids::FactoryId,
    json::{JsonNode, Kind},
    messages::{AssetKind, Comment},
};

pub(super) const ASSET_KINDS: [(&str, AssetKind); 4] = [
    ("POSE", AssetKind::Pose),
    ("POWER", AssetKind::Power),
    ("CONDITION", AssetKind::Condition),
    ("SAFETY", AssetKind::Safety),
];

pub(super) fn message_type(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
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

pub(super) fn factory_id(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> FactoryId {
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

pub(super) fn revision(reader: &mut Reader, root: JsonNode<'_, '_>) -> u64 {
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

pub(super) fn comment(
    reader: &mut Reader,
    root: JsonNode<'_, '_>,
    expected: Option<&FactoryId>,
) -> Comment {
    Comment {
        message_id: reader.required_id(root, "messageId"),
        factory_id: factory_id(reader, root, expected),
        operation_network_id: reader.required_id(root, "operationNetworkId"),
        dynamic_data_request_id: reader.optional(root, "dynamicDataRequestId", Reader::id),
        field_name: reader.optional(root, "fieldName", Reader::id),
        author_id: reader.required(root, "authorId", Reader::name).unwrap_or_default(),
        text: reader.required(root, "text", Reader::non_empty_text).unwrap_or_default(),
    }
}

pub(super) fn kinds(reader: &mut Reader, root: JsonNode<'_, '_>) -> Vec<AssetKind> {
    let kinds = reader.list(root, "kindList", ASSET_KINDS.len(), |reader, node| {
        reader.choice(node, &ASSET_KINDS)
    });
    not_empty(reader, root, "kindList");
    kinds
}

pub(super) fn writer_id(reader: &mut Reader, object: JsonNode<'_, '_>) -> Option<u16> {
    reader.required(object, "dataSetWriterId", |reader, node| {
        reader.integer(node, "a number from 0 to 65535")
    })
}

pub(super) fn number(reader: &mut Reader, object: JsonNode<'_, '_>, name: &str) -> Option<u32> {
    reader.required(object, name, |reader, node| {
        reader.integer(node, "a number from 0 to 4294967295")
    })
}

pub(super) fn milliseconds(reader: &mut Reader, node: JsonNode<'_, '_>) -> Option<u64> {
    reader.integer(node, "milliseconds as a number from 0")
}

/// Reads the number of a log among those that replaced each other, from 1.
pub(super) fn epoch(reader: &mut Reader, object: JsonNode<'_, '_>) -> u32 {
    let epoch = reader.required(object, "epoch", |reader, node| {
        let epoch = reader.integer(node, "a number from 1 to 4294967295")?;
        if epoch == 0 {
            reader.fault(node, FaultCode::InvalidValue, "Logs are numbered from 1.");
        }
        Some(epoch)
    });
    epoch.unwrap_or_default()
}
