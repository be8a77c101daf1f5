//! DataSetMessages as JSON objects (OPC 10000-14 §7.2.5.4).

use std::sync::Arc;

use super::{super::Encoding, header::version};
use crate::{
    json::write,
    opcua_json::{Encoder, encode::write_name},
    pubsub::{
        DataSetMessage, DataSetMessageKind, DataSetMetaData, FieldMetaData, FieldRepresentation,
    },
    values::{BuiltInType, DataValue, StatusCode, Variant},
};

/// Encoder of the DataSetMessages of one writer.
pub(super) struct DataSetMessageEncoder<'e> {
    values: Encoder<'e>,
    encoding: Encoding,
    /// Fields in payload order; empty where the metadata is not known.
    fields: &'e [FieldMetaData],
}

impl<'e> DataSetMessageEncoder<'e> {
    /// Takes the writer's metadata, where it is known.
    pub(super) fn new(encoding: Encoding, meta_data: Option<&'e DataSetMetaData>) -> Self {
        let values = match meta_data {
            Some(known) => Encoder::described(
                encoding.data_encoding(),
                &known.namespaces,
                &known.structure_types,
            )
            .with_enum_types(&known.enum_types),
            None => Encoder::new(encoding.data_encoding()),
        };
        let fields = meta_data.map_or(&[][..], |known| &known.fields);
        Self { values, encoding, fields }
    }

    /// Appends the message as one JSON object.
    pub(super) fn write(&self, out: &mut Vec<u8>, message: &DataSetMessage) {
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
            self.values.status_code(out, message.status);
        }
        // The figures of the DIGICOR paper have no MessageType; its absence means a key frame.
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
        // Verbose leaves out only types that metadata has; an abstract one is not enough.
        let is_type_known =
            is_verbose && meta_data.is_none_or(|field| field.built_in_type != BuiltInType::Variant);
        if representation == FieldRepresentation::DataValue {
            return if is_type_known {
                self.values.data_value_without_type(out, value);
            } else {
                self.values.data_value(out, value);
            };
        }
        if value.status.is_good() {
            return if is_type_known {
                self.values.bare(out, &value.value);
            } else {
                self.values.variant(out, &value.value);
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
        self.values.variant(out, &substitute);
    }
}
