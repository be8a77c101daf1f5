//! Reading NetworkMessages and DataSetMessages.

use std::sync::Arc;

use super::decode_members::{
    message_id, meta_data_version, optional_text, publisher_id, writer_id,
};
use crate::{
    json::{JsonNode, Kind},
    opcua_json::{
        DecodedValue, Decoder, Mismatch,
        decode::TypeHint,
        decode_scalar::{date_time, guid, integer, status_code, text},
    },
    pubsub::{
        DataSetMessage, DataSetMessageKind, DataSetMetaData, FieldMetaData, FieldRepresentation,
        MetaDataLookup, NetworkMessage, PayloadField,
    },
    values::{BuiltInType, DataValue, Scalar, Variant},
};

pub(super) fn network_message<'t, 'a, 'd>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'d>,
    lookup: &'d dyn MetaDataLookup,
) -> Result<NetworkMessage, Mismatch<'t, 'a>> {
    let mut message = NetworkMessage {
        message_id: message_id(root, decoder)?,
        publisher_id: publisher_id(root)?,
        writer_group_name: optional_text(root, "WriterGroupName")?,
        data_set_class_id: root.get("DataSetClassId").map(guid).transpose()?,
        messages: Vec::new(),
    };
    if let Some(messages) = root.get("Messages") {
        message.messages =
            data_set_messages(messages, decoder, lookup, message.publisher_id.as_deref())?;
    }
    Ok(message)
}

/// One DataSetMessage or an array of them.
pub(super) fn data_set_messages<'t, 'a, 'd>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'d>,
    lookup: &'d dyn MetaDataLookup,
    publisher_id: Option<&str>,
) -> Result<Vec<DataSetMessage>, Mismatch<'t, 'a>> {
    let single = (node.kind() != Kind::Array).then_some(node);
    let mut messages = Vec::new();
    for element in node.elements().chain(single) {
        if let Some(kind) = unknown_kind(element) {
            // Receivers ignore what they do not know (OPC 10000-14 §7.2.5.1).
            let message = "the MessageType is none of a DataSetMessage; \
                           the DataSetMessage is left out";
            decoder.diagnostics.note(kind, message);
        } else {
            messages.push(data_set_message(element, decoder, lookup, publisher_id)?);
        }
    }
    Ok(messages)
}

/// True for an object with a DataSetMessage header; without one, the object itself is the payload.
pub(super) fn is_data_set_message(node: JsonNode<'_, '_>) -> bool {
    let kind = node.get("MessageType").and_then(JsonNode::text);
    kind.is_some_and(|kind| DataSetMessageKind::from_name(&kind).is_some())
        || node.get("Payload").is_some_and(|payload| {
            matches!(payload.kind(), Kind::Object | Kind::Null) && payload.get("UaType").is_none()
        })
}

/// True for a header without payload and type. What has no payload is a keep-alive (OPC 10000-14 §7.2.5.4.1); Milo reads
/// it so, too.
fn is_header_alone(node: JsonNode<'_, '_>) -> bool {
    const MEMBERS: [&str; 9] = [
        "DataSetWriterId",
        "DataSetWriterName",
        "PublisherId",
        "WriterGroupName",
        "SequenceNumber",
        "MetaDataVersion",
        "MinorVersion",
        "Timestamp",
        "Status",
    ];
    let is_of_header = |name: JsonNode<'_, '_>| MEMBERS.iter().any(|known| name.is_text(known));
    node.get("DataSetWriterId").is_some() && node.members().all(|(name, _)| is_of_header(name))
}

/// The MessageType of an object with a DataSetMessage header, where it is none that is known.
fn unknown_kind<'t, 'a>(node: JsonNode<'t, 'a>) -> Option<JsonNode<'t, 'a>> {
    let member = node.get("MessageType")?;
    let name = member.text()?;
    let is_header = name.starts_with("ua-") || is_data_set_message(node);
    (is_header && DataSetMessageKind::from_name(&name).is_none()).then_some(member)
}

pub(super) fn data_set_message<'t, 'a, 'd>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'d>,
    lookup: &'d dyn MetaDataLookup,
    publisher_id: Option<&str>,
) -> Result<DataSetMessage, Mismatch<'t, 'a>> {
    if node.kind() != Kind::Object {
        return Err(Mismatch::new(node, "a DataSetMessage must be an object"));
    }
    let mut message = DataSetMessage::default();
    let mut payload = Some(node);
    if is_data_set_message(node) {
        payload = header(node, &mut message)?;
    } else if is_header_alone(node) {
        message.kind = DataSetMessageKind::KeepAlive;
        payload = header(node, &mut message)?;
    }
    let publisher_id = message.publisher_id.as_deref().or(publisher_id);
    let meta_data = lookup.meta_data(publisher_id, message.data_set_writer_id);
    match meta_data {
        Some(known) => decoder.set_described(&known.structure_types, &known.namespaces),
        None => decoder.set_described(&[], &[]),
    }
    if let Some(payload) = payload.filter(|_| message.kind != DataSetMessageKind::KeepAlive) {
        fields(payload, decoder, meta_data, &mut message)?;
    }
    Ok(message)
}

/// Reads the header's members and finds the payload.
fn header<'t, 'a>(
    node: JsonNode<'t, 'a>,
    message: &mut DataSetMessage,
) -> Result<Option<JsonNode<'t, 'a>>, Mismatch<'t, 'a>> {
    let mut payload = None;
    for (key, value) in node.members() {
        let Some(name) = key.text() else { continue };
        match &*name {
            _ if value.is_null() => {}
            "DataSetWriterId" => message.data_set_writer_id = Some(writer_id(value)?),
            "DataSetWriterName" => message.data_set_writer_name = Some(text(value)?.into()),
            "PublisherId" => message.publisher_id = publisher_id(node)?,
            "WriterGroupName" => message.writer_group_name = Some(text(value)?.into()),
            "SequenceNumber" => {
                message.sequence_number = Some(integer(value, "a number from 0 to 4294967295")?);
            }
            "MetaDataVersion" => message.meta_data_version = Some(meta_data_version(value)?),
            "MinorVersion" => {
                message.minor_version = Some(integer(value, "a number from 0 to 4294967295")?)
            }
            "Timestamp" => message.timestamp = Some(date_time(value)?),
            "Status" => message.status = status_code(value)?,
            "MessageType" => {
                message.kind = DataSetMessageKind::from_name(&text(value)?).ok_or_else(|| {
                    Mismatch::new(value, "the MessageType is none of a DataSetMessage")
                })?;
            }
            "Payload" => payload = Some(value),
            _ => {}
        }
    }
    if payload.is_none() && message.kind != DataSetMessageKind::KeepAlive {
        return Err(match node.get("Payload") {
            Some(null) => Mismatch::new(null, "Payload is null; only a keep-alive has none"),
            None => Mismatch::new(node, "Payload is missing"),
        });
    }
    Ok(payload)
}

fn fields<'t, 'a>(
    payload: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
    meta_data: Option<&DataSetMetaData>,
    message: &mut DataSetMessage,
) -> Result<(), Mismatch<'t, 'a>> {
    if payload.kind() != Kind::Object {
        return Err(Mismatch::new(payload, "Payload must be an object"));
    }
    let (mut has_variant, mut has_data_value, mut has_bare) = (false, false, false);
    message.fields.reserve(payload.members().count());
    for (index, (key, node)) in payload.members().enumerate() {
        let name: Arc<str> = key.text().unwrap_or_default().into();
        let described = meta_data.and_then(|known| described_field(known, index, &name));
        // A described value of any type names its type; there is nothing to go by but its shape.
        let hint = described.filter(|field| field.built_in_type != BuiltInType::Variant).map(hint);
        let value = match decoder.value(node, hint) {
            Ok(value) => {
                match &value {
                    DecodedValue::Variant(_) => has_variant = true,
                    DecodedValue::DataValue(_) => has_data_value = true,
                    DecodedValue::Bare(value) => has_bare |= !value.is_null(),
                }
                let is_status =
                    described.is_some_and(|field| field.built_in_type == BuiltInType::StatusCode);
                match value {
                    // A status is the value there, and not the quality of one; with a quality it is in a DataValue.
                    DecodedValue::Variant(value)
                        if is_status && !matches!(value, Variant::Scalar(Scalar::DataValue(_))) =>
                    {
                        DataValue { value, ..DataValue::default() }
                    }
                    value => value.into_data_value(),
                }
            }
            Err(mismatch) => {
                decoder.diagnostics.note(mismatch.node, mismatch.message);
                DataValue { status: mismatch.status, ..DataValue::default() }
            }
        };
        message.fields.push(PayloadField { name, value });
    }
    message.representation = match (has_data_value, has_variant, has_bare) {
        (true, _, _) => FieldRepresentation::DataValue,
        (false, false, true) => FieldRepresentation::Raw,
        _ => FieldRepresentation::Variant,
    };
    Ok(())
}

fn hint(field: &FieldMetaData) -> TypeHint<'_> {
    TypeHint {
        built_in_type: field.built_in_type,
        data_type: &field.data_type,
        value_rank: field.value_rank,
    }
}

/// The metadata of a field: usually at the same place, else wherever its name is (among the first
/// few hundred, so that a foreign order stays cheap).
fn described_field<'m>(
    meta_data: &'m DataSetMetaData,
    index: usize,
    name: &str,
) -> Option<&'m FieldMetaData> {
    const SEARCHED_MAX: usize = 512;
    let at_place = meta_data.fields.get(index).filter(|field| &*field.name == name);
    at_place
        .or_else(|| meta_data.fields.iter().take(SEARCHED_MAX).find(|field| &*field.name == name))
}
