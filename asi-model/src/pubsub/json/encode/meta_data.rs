//! Encoding of `ua-metadata` (OPC 10000-14 §7.2.5.5.2).

use std::sync::Arc;

use super::{
    super::Encoding,
    header::{message_header, version},
};
use crate::{
    json::write,
    opcua_json::{Encoder, encode::write_name},
    pubsub::{DataSetMetaData, FieldMetaData, MetaDataMessage},
    values::{
        BuiltInType, EnumType, NodeId, QualifiedName, SimpleType, StructureKind, StructureType,
    },
};

/// Encodes a metadata message: in 1.04 reversible for `digicor`, else in 1.05 Compact.
#[must_use]
pub fn encode_meta_data(message: &MetaDataMessage, encoding: Encoding) -> Vec<u8> {
    let meta_data = &message.meta_data;
    let encoder = Encoder::described(
        encoding.meta_data_encoding(),
        &meta_data.namespaces,
        &meta_data.structure_types,
    );
    let mut out = Vec::with_capacity(512 + 256 * meta_data.fields.len());
    out.push(b'{');
    message_header(
        &mut out,
        message.message_id.as_ref(),
        "ua-metadata",
        message.publisher_id.as_deref(),
    );
    write_name(&mut out, "DataSetWriterId");
    write::unsigned(&mut out, u64::from(message.data_set_writer_id));
    let names = [
        ("WriterGroupName", &message.writer_group_name),
        ("DataSetWriterName", &message.data_set_writer_name),
    ];
    for (name, text) in names {
        if let Some(text) = text.as_deref() {
            write_name(&mut out, name);
            write::string(&mut out, text);
        }
    }
    if let Some(time) = message.timestamp {
        write_name(&mut out, "Timestamp");
        write::date_time(&mut out, time);
    }
    write_name(&mut out, "MetaData");
    data_set(&mut out, meta_data, encoder);
    out.push(b'}');
    out
}

fn data_set(out: &mut Vec<u8>, meta_data: &DataSetMetaData, encoder: Encoder<'_>) {
    out.push(b'{');
    if !meta_data.namespaces.is_empty() {
        write_name(out, "Namespaces");
        list(out, &meta_data.namespaces, |out, uri| write::string(out, uri));
    }
    if !meta_data.structure_types.is_empty() {
        write_name(out, "StructureDataTypes");
        list(out, &meta_data.structure_types, |out, known| structure(out, known, encoder));
    }
    if !meta_data.enum_types.is_empty() {
        write_name(out, "EnumDataTypes");
        list(out, &meta_data.enum_types, |out, known| enumeration(out, known, encoder));
    }
    if !meta_data.simple_types.is_empty() {
        write_name(out, "SimpleDataTypes");
        list(out, &meta_data.simple_types, |out, known| simple(out, known, encoder));
    }
    write_name(out, "Name");
    write::string(out, &meta_data.name);
    if let Some(description) = &meta_data.description {
        write_name(out, "Description");
        encoder.localized_text(out, description);
    }
    write_name(out, "Fields");
    list(out, &meta_data.fields, |out, known| field(out, known, encoder));
    if let Some(class) = &meta_data.data_set_class_id {
        write_name(out, "DataSetClassId");
        write::string(out, class.hyphenated().encode_lower(&mut uuid::Uuid::encode_buffer()));
    }
    write_name(out, "ConfigurationVersion");
    version(out, meta_data.configuration_version);
    out.push(b'}');
}

fn list<T>(out: &mut Vec<u8>, items: &[T], write: impl Fn(&mut Vec<u8>, &T)) {
    out.push(b'[');
    for (index, item) in items.iter().enumerate() {
        if index > 0 {
            out.push(b',');
        }
        write(out, item);
    }
    out.push(b']');
}

fn field(out: &mut Vec<u8>, field: &FieldMetaData, encoder: Encoder<'_>) {
    out.push(b'{');
    write_name(out, "Name");
    write::string(out, &field.name);
    if let Some(description) = &field.description {
        write_name(out, "Description");
        encoder.localized_text(out, description);
    }
    if field.is_promoted {
        write_name(out, "FieldFlags");
        write::unsigned(out, 1);
    }
    write_name(out, "BuiltInType");
    write::unsigned(out, u64::from(field.built_in_type.id()));
    write_name(out, "DataType");
    encoder.node_id(out, &field.data_type);
    shape(out, field.value_rank, &field.array_dimensions, field.max_string_length);
    write_name(out, "DataSetFieldId");
    write::string(
        out,
        field.data_set_field_id.hyphenated().encode_lower(&mut uuid::Uuid::encode_buffer()),
    );
    if !field.properties.is_empty() {
        write_name(out, "Properties");
        list(out, &field.properties, |out, (key, value)| {
            out.extend_from_slice(b"{\"Key\":");
            encoder.qualified_name(out, key);
            out.extend_from_slice(b",\"Value\":");
            encoder.variant(out, value);
            out.push(b'}');
        });
    }
    out.push(b'}');
}

/// Rank, dimensions and longest string, which fields of data sets and of structures have alike.
fn shape(out: &mut Vec<u8>, value_rank: i32, array_dimensions: &[u32], max_string_length: u32) {
    write_name(out, "ValueRank");
    write::signed(out, i64::from(value_rank));
    if !array_dimensions.is_empty() {
        write_name(out, "ArrayDimensions");
        list(out, array_dimensions, |out, length| write::unsigned(out, u64::from(*length)));
    }
    if max_string_length != 0 {
        write_name(out, "MaxStringLength");
        write::unsigned(out, u64::from(max_string_length));
    }
}

fn structure(out: &mut Vec<u8>, known: &StructureType, encoder: Encoder<'_>) {
    type_name(out, &known.type_id, &known.name, encoder);
    out.extend_from_slice(b",\"StructureDefinition\":{\"DefaultEncodingId\":");
    encoder.node_id(out, known.encoding_ids.first().unwrap_or(&NodeId::null()));
    out.extend_from_slice(b",\"BaseDataType\":");
    encoder.node_id(out, &NodeId::ua(if known.kind == StructureKind::Union { 12756 } else { 22 }));
    out.extend_from_slice(b",\"StructureType\":");
    write::unsigned(
        out,
        match known.kind {
            StructureKind::Plain => 0,
            StructureKind::WithOptionalFields => 1,
            StructureKind::Union => 2,
        },
    );
    out.extend_from_slice(b",\"Fields\":");
    list(out, &known.fields, |out, field| {
        out.extend_from_slice(b"{\"Name\":");
        write::string(out, &field.name);
        if let Some(description) = &field.description {
            write_name(out, "Description");
            encoder.localized_text(out, description);
        }
        out.extend_from_slice(b",\"DataType\":");
        encoder.node_id(out, &field.data_type);
        shape(out, field.value_rank, &field.array_dimensions, field.max_string_length);
        if field.is_optional {
            out.extend_from_slice(b",\"IsOptional\":true");
        }
        out.push(b'}');
    });
    out.extend_from_slice(b"}}");
}

/// The members that every description of a data type begins with. The name is of the type's own
/// namespace.
fn type_name(out: &mut Vec<u8>, type_id: &NodeId, name: &Arc<str>, encoder: Encoder<'_>) {
    out.extend_from_slice(b"{\"DataTypeId\":");
    encoder.node_id(out, type_id);
    out.extend_from_slice(b",\"Name\":");
    let name = QualifiedName { namespace: type_id.namespace.clone(), name: Some(Arc::clone(name)) };
    encoder.qualified_name(out, &name);
}

fn enumeration(out: &mut Vec<u8>, known: &EnumType, encoder: Encoder<'_>) {
    type_name(out, &known.type_id, &known.name, encoder);
    out.extend_from_slice(b",\"EnumDefinition\":{\"Fields\":");
    list(out, &known.values, |out, value| {
        out.extend_from_slice(b"{\"Value\":");
        write::string(out, &value.value.to_string());
        for (name, text) in
            [("DisplayName", &value.display_name), ("Description", &value.description)]
        {
            if text.locale.is_some() || text.text.is_some() {
                write_name(out, name);
                encoder.localized_text(out, text);
            }
        }
        write_name(out, "Name");
        write::string(out, &value.name);
        out.push(b'}');
    });
    out.push(b'}');
    built_in_type(out, known.built_in_type);
}

fn simple(out: &mut Vec<u8>, known: &SimpleType, encoder: Encoder<'_>) {
    type_name(out, &known.type_id, &known.name, encoder);
    out.extend_from_slice(b",\"BaseDataType\":");
    encoder.node_id(out, &known.base_type);
    built_in_type(out, known.built_in_type);
}

/// The last member of a description.
fn built_in_type(out: &mut Vec<u8>, built_in_type: BuiltInType) {
    write_name(out, "BuiltInType");
    write::unsigned(out, u64::from(built_in_type.id()));
    out.push(b'}');
}
