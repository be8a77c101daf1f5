//! Writing `ua-data` and `ua-status`, straight into one buffer.

use std::sync::Arc;

use super::{Encoding, encode_meta_data};
use crate::{
    json::write,
    opcua_json::{Encoder, encode::write_name},
    pubsub::{
        DataSetMessage, DataSetMessageKind, FieldMetaData, FieldRepresentation, MetaDataLookup,
        MetaDataVersion, NetworkMessage, PubSubMessage, StatusMessage,
    },
    values::{BuiltInType, DataValue, StatusCode, Variant},
};

/// Writes a data message. Types that are not self-evident must be known to the receiver from
/// metadata in [`Encoding::Verbose105`].
#[must_use]
pub fn encode(message: &NetworkMessage, encoding: Encoding) -> Vec<u8> {
    encode_described(message, encoding, &())
}

/// As [`encode`], with the metadata at hand: namespaces that it lists are written as indexes in
/// 1.04, structures as it describes them, and fields of abstract types keep their type in Verbose.
#[must_use]
pub fn encode_described(
    message: &NetworkMessage,
    encoding: Encoding,
    lookup: &dyn MetaDataLookup,
) -> Vec<u8> {
    let fields: usize = message.messages.iter().map(|part| part.fields.len()).sum();
    let mut out = Vec::with_capacity(256 + 160 * message.messages.len() + 64 * fields);
    out.push(b'{');
    header(
        &mut out,
        message.message_id.as_ref().map(AsRef::as_ref),
        "ua-data",
        message.publisher_id.as_deref(),
    );
    if let Some(group) = &message.writer_group_name {
        write_name(&mut out, "WriterGroupName");
        write::string(&mut out, group);
    }
    if let Some(class) = &message.data_set_class_id {
        write_name(&mut out, "DataSetClassId");
        write::string(&mut out, class.hyphenated().encode_lower(&mut uuid::Uuid::encode_buffer()));
    }
    out.extend_from_slice(b",\"Messages\":[");
    for (index, part) in message.messages.iter().enumerate() {
        if index > 0 {
            out.push(b',');
        }
        let publisher_id = part.publisher_id.as_deref().or(message.publisher_id.as_deref());
        let meta_data = lookup.meta_data(publisher_id, part.data_set_writer_id);
        let encoder = match meta_data {
            Some(known) => Encoder::described(
                encoding.data_encoding(),
                &known.namespaces,
                &known.structure_types,
            )
            .with_enum_types(&known.enum_types),
            None => Encoder::new(encoding.data_encoding()),
        };
        let fields = meta_data.map_or(&[][..], |known| &known.fields);
        DataSetWriter { encoder, encoding, fields }.write(&mut out, part);
    }
    out.extend_from_slice(b"]}");
    out
}

/// Writes any message; one of unknown type yields its header alone.
#[must_use]
pub fn encode_message(message: &PubSubMessage, encoding: Encoding) -> Vec<u8> {
    match message {
        PubSubMessage::Data(data) => encode(data, encoding),
        PubSubMessage::MetaData(meta_data) => encode_meta_data(meta_data, encoding),
        PubSubMessage::Status(status) => encode_status(status),
        PubSubMessage::Other { message_type, message_id } => {
            let mut out = vec![b'{'];
            header(&mut out, message_id.as_ref().map(AsRef::as_ref), message_type, None);
            out.push(b'}');
            out
        }
    }
}

/// Writes a status message; alike in all encodings.
#[must_use]
pub fn encode_status(message: &StatusMessage) -> Vec<u8> {
    let mut out = Vec::with_capacity(256);
    out.push(b'{');
    header(
        &mut out,
        message.message_id.as_ref().map(AsRef::as_ref),
        "ua-status",
        message.publisher_id.as_deref(),
    );
    for (name, time) in
        [("Timestamp", message.timestamp), ("NextReportTime", message.next_report_time)]
    {
        if let Some(time) = time {
            write_name(&mut out, name);
            write::date_time(&mut out, time);
        }
    }
    write_name(&mut out, "IsCyclic");
    out.extend_from_slice(if message.is_cyclic { b"true" } else { b"false" });
    write_name(&mut out, "Status");
    write::unsigned(&mut out, message.status as u64);
    out.push(b'}');
    out
}

/// The members that every message begins with.
pub(super) fn header(
    out: &mut Vec<u8>,
    message_id: Option<&str>,
    message_type: &str,
    publisher_id: Option<&str>,
) {
    if let Some(message_id) = message_id {
        write_name(out, "MessageId");
        write::string(out, message_id);
    }
    write_name(out, "MessageType");
    write::string(out, message_type);
    if let Some(publisher_id) = publisher_id {
        write_name(out, "PublisherId");
        write::string(out, publisher_id);
    }
}

/// `{"MajorVersion":…,"MinorVersion":…}`.
pub(super) fn version(out: &mut Vec<u8>, version: MetaDataVersion) {
    out.extend_from_slice(b"{\"MajorVersion\":");
    write::unsigned(out, u64::from(version.major));
    out.extend_from_slice(b",\"MinorVersion\":");
    write::unsigned(out, u64::from(version.minor));
    out.push(b'}');
}

struct DataSetWriter<'e> {
    encoder: Encoder<'e>,
    encoding: Encoding,
    fields: &'e [FieldMetaData],
}

impl DataSetWriter<'_> {
    fn write(&self, out: &mut Vec<u8>, message: &DataSetMessage) {
        out.push(b'{');
        self.header(out, message);
        if message.kind != DataSetMessageKind::KeepAlive {
            write_name(out, "Payload");
            out.push(b'{');
            for (index, field) in message.fields.iter().enumerate() {
                if index > 0 {
                    out.push(b',');
                }
                write::string(out, &field.name);
                out.push(b':');
                self.field(
                    out,
                    &field.value,
                    message.representation,
                    self.meta_data(index, &field.name),
                );
            }
            out.push(b'}');
        }
        out.push(b'}');
    }

    fn header(&self, out: &mut Vec<u8>, message: &DataSetMessage) {
        if let Some(id) = message.data_set_writer_id {
            write_name(out, "DataSetWriterId");
            write::unsigned(out, u64::from(id));
        }
        let texts = [
            ("DataSetWriterName", &message.data_set_writer_name),
            ("PublisherId", &message.publisher_id),
            ("WriterGroupName", &message.writer_group_name),
        ];
        for (name, text) in texts {
            if let Some(text) = text.as_deref() {
                write_name(out, name);
                write::string(out, text);
            }
        }
        if let Some(number) = message.sequence_number {
            write_name(out, "SequenceNumber");
            write::unsigned(out, u64::from(number));
        }
        if let Some(known) = message.meta_data_version {
            write_name(out, "MetaDataVersion");
            version(out, known);
        } else if let Some(minor) = message.minor_version {
            write_name(out, "MinorVersion");
            write::unsigned(out, u64::from(minor));
        }
        if let Some(time) = message.timestamp {
            write_name(out, "Timestamp");
            write::date_time(out, time);
        }
        if message.status != StatusCode::GOOD {
            write_name(out, "Status");
            self.encoder.status_code(out, message.status);
        }
        // The paper's figures have no MessageType; where it is absent, a key frame is meant.
        if self.encoding != Encoding::Digicor || message.kind != DataSetMessageKind::KeyFrame {
            write_name(out, "MessageType");
            write::string(out, message.kind.name());
        }
    }

    fn meta_data(&self, index: usize, name: &Arc<str>) -> Option<&FieldMetaData> {
        self.fields.get(index).filter(|field| field.name == *name)
    }

    fn field(
        &self,
        out: &mut Vec<u8>,
        value: &DataValue,
        representation: FieldRepresentation,
        meta_data: Option<&FieldMetaData>,
    ) {
        let is_verbose = self.encoding == Encoding::Verbose105;
        // Verbose leaves out only types that metadata tells; an abstract one it cannot tell.
        let is_type_known =
            is_verbose && meta_data.is_none_or(|field| field.built_in_type != BuiltInType::Variant);
        if representation == FieldRepresentation::DataValue {
            return if is_type_known {
                self.encoder.data_value_without_type(out, value);
            } else {
                self.encoder.data_value(out, value);
            };
        }
        if value.status.is_good() {
            return if is_type_known {
                self.encoder.bare(out, &value.value);
            } else {
                self.encoder.variant(out, &value.value);
            };
        }
        // OPC 10000-14 §6.2.4.2: as a Variant, Bad is the status alone and Uncertain a DataValue in
        // the Variant.
        let substitute = if value.status.is_bad() {
            Variant::from(value.status)
        } else {
            let known = DataValue {
                value: value.value.clone(),
                status: value.status,
                ..DataValue::default()
            };
            Variant::Scalar(crate::values::Scalar::DataValue(Box::new(known)))
        };
        self.encoder.variant(out, &substitute);
    }
}
