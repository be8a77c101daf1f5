//! Reading `ua-metadata`, in 1.04 and 1.05 form.

use std::{collections::HashMap, sync::Arc};

use uuid::Uuid;

use super::decode_members::{
    message_id, meta_data_version, optional_text, publisher_id, writer_id,
};
use crate::{
    json::{JsonNode, Kind},
    opcua_json::{
        Decoder, Mismatch,
        decode_scalar::{date_time, guid, integer, integer_64, localized_text, named_value, text},
    },
    pubsub::{DataSetMetaData, FieldMetaData, MetaDataMessage, PubSubMessage},
    values::{
        BuiltInType, EnumType, EnumValue, LocalizedText, Namespace, NodeId, SimpleType,
        StructureField, StructureKind, StructureType,
    },
};

/// Most structures, enumerations and aliases described in one message, each.
const TYPES_MAX: usize = 256;
/// Most fields of one structure, or values of one enumeration.
const TYPE_FIELDS_MAX: usize = 512;
/// Most fields of one data set, and properties of one field.
const FIELDS_MAX: usize = 4096;

pub(super) fn message<'t, 'a>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<PubSubMessage, Mismatch<'t, 'a>> {
    let writer = root
        .get("DataSetWriterId")
        .ok_or_else(|| Mismatch::new(root, "DataSetWriterId is missing"))?;
    let meta_data =
        root.get("MetaData").ok_or_else(|| Mismatch::new(root, "MetaData is missing"))?;
    Ok(PubSubMessage::MetaData(Box::new(MetaDataMessage {
        message_id: message_id(root, decoder)?,
        publisher_id: publisher_id(root)?,
        data_set_writer_id: writer_id(writer)?,
        writer_group_name: optional_text(root, "WriterGroupName")?,
        data_set_writer_name: optional_text(root, "DataSetWriterName")?,
        timestamp: root.get("Timestamp").map(date_time).transpose()?,
        meta_data: data_set(meta_data, decoder)?,
    })))
}

/// The elements of a list member, at most so many.
fn list<'t, 'a>(
    node: JsonNode<'t, 'a>,
    name: &str,
    count_max: usize,
) -> Result<impl Iterator<Item = JsonNode<'t, 'a>> + use<'t, 'a>, Mismatch<'t, 'a>> {
    let found = node.get(name).filter(|list| !list.is_null());
    if let Some(list) = found {
        if list.kind() != Kind::Array {
            return Err(Mismatch::new(list, "expected an array"));
        }
        if list.elements().count() > count_max {
            return Err(Mismatch::out_of_range(
                list,
                format!("at most {count_max} elements are accepted"),
            ));
        }
    }
    Ok(found.into_iter().flat_map(JsonNode::elements))
}

fn data_set<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<DataSetMetaData, Mismatch<'t, 'a>> {
    if node.kind() != Kind::Object {
        return Err(Mismatch::new(node, "MetaData must be an object"));
    }
    let namespaces = namespaces(node, decoder)?;
    // Ids in the metadata use its own namespaces.
    let mut known = DataSetMetaData {
        name: optional_text(node, "Name")?.unwrap_or_default(),
        description: description(node)?,
        data_set_class_id: node
            .get("DataSetClassId")
            .filter(|id| !id.is_null())
            .map(guid)
            .transpose()?,
        configuration_version: node
            .get("ConfigurationVersion")
            .map(meta_data_version)
            .transpose()?
            .unwrap_or_default(),
        ..DataSetMetaData::default()
    };
    let mut local = Decoder::new(decoder.diagnostics.leniency(), &[], &namespaces);
    for entry in list(node, "EnumDataTypes", TYPES_MAX)? {
        known.enum_types.extend(enum_type(entry, &mut local)?);
    }
    for entry in list(node, "SimpleDataTypes", TYPES_MAX)? {
        known.simple_types.extend(simple_type(entry, &local)?);
    }
    let aliases: HashMap<&NodeId, BuiltInType> = (known.simple_types.iter())
        .map(|known| (&known.type_id, known.built_in_type))
        .chain(known.enum_types.iter().map(|known| (&known.type_id, known.built_in_type)))
        .collect();
    let mut structure_types = Vec::new();
    for structure in list(node, "StructureDataTypes", TYPES_MAX)? {
        structure_types.push(structure_type(structure, &local, &aliases)?);
    }
    known.structure_types = structure_types;
    decoder.diagnostics.append(local.diagnostics);
    local = Decoder::new(decoder.diagnostics.leniency(), &known.structure_types, &namespaces);
    for entry in list(node, "Fields", FIELDS_MAX)? {
        let read = field(entry, &mut local)?;
        known.fields.push(read);
    }
    decoder.diagnostics.append(local.diagnostics);
    known.namespaces = namespaces;
    Ok(known)
}

/// The namespaces from index 1 on (OPC 10000-5 §12.31: that of OPC UA, index 0, is not listed).
/// Some publishers list all namespaces of their server; then the first is index 0.
fn namespaces<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<Vec<Arc<str>>, Mismatch<'t, 'a>> {
    let mut namespaces = Vec::new();
    for (position, uri) in list(node, "Namespaces", FIELDS_MAX)?.enumerate() {
        let text = text(uri)?;
        if position == 0 && Namespace::uri(&text) == Namespace::Ua {
            decoder.diagnostics.tolerate(
                uri,
                "the namespace of OPC UA is not listed; what follows begins with index 1",
            )?;
        } else {
            namespaces.push(text.into());
        }
    }
    Ok(namespaces)
}

fn description<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<Option<LocalizedText>, Mismatch<'t, 'a>> {
    let text = node.get("Description").map(localized_text).transpose()?;
    Ok(text.filter(|text| text.text.is_some() || text.locale.is_some()))
}

fn array_dimensions<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<Vec<u32>, Mismatch<'t, 'a>> {
    list(node, "ArrayDimensions", FIELDS_MAX)?.map(|length| integer(length, "a length")).collect()
}

fn max_string_length<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<u32, Mismatch<'t, 'a>> {
    node.get("MaxStringLength").map_or(Ok(0), |length| integer(length, "a length"))
}

fn field<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<FieldMetaData, Mismatch<'t, 'a>> {
    let name = node.get("Name").ok_or_else(|| Mismatch::new(node, "Name is missing"))?;
    let built_in =
        node.get("BuiltInType").ok_or_else(|| Mismatch::new(node, "BuiltInType is missing"))?;
    let built_in_type = match integer::<u64>(built_in, "the id of a built-in type")? {
        // 26 to 29 are the abstract Number, Integer, UInteger and Enumeration of other editions.
        26..=28 => BuiltInType::Variant,
        29 => BuiltInType::Int32,
        id => BuiltInType::from_id(id).ok_or_else(|| {
            Mismatch::out_of_range(built_in, "expected the id of a built-in type, 1 to 25")
        })?,
    };
    let field_id = match node.get("DataSetFieldId") {
        Some(id) if !id.is_null() => guid(id)?,
        _ => Uuid::nil(),
    };
    let mut field = FieldMetaData::new(text(name)?, built_in_type, field_id);
    field.description = description(node)?;
    if let Some(flags) = node.get("FieldFlags") {
        field.is_promoted = integer::<u32>(flags, "field flags as a number")? & 1 == 1;
    }
    if let Some(data_type) = node.get("DataType").filter(|id| !id.is_null()) {
        field.data_type = decoder.namespaces.node_id(data_type)?;
    }
    if let Some(rank) = node.get("ValueRank") {
        field.value_rank = integer(rank, "a ValueRank")?;
    }
    field.array_dimensions = array_dimensions(node)?;
    field.max_string_length = max_string_length(node)?;
    for property in list(node, "Properties", FIELDS_MAX)? {
        let key = property.get("Key").ok_or_else(|| Mismatch::new(property, "Key is missing"))?;
        let value = property.get("Value").map(|value| decoder.variant(value)).transpose()?;
        field.properties.push((decoder.namespaces.qualified_name(key)?, value.unwrap_or_default()));
    }
    Ok(field)
}

/// An enumeration; one without id describes nothing.
fn enum_type<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<Option<EnumType>, Mismatch<'t, 'a>> {
    let Some(id) = node.get("DataTypeId") else { return Ok(None) };
    let mut values = Vec::new();
    if let Some(definition) = node.get("EnumDefinition").filter(|definition| !definition.is_null())
    {
        for value in list(definition, "Fields", TYPE_FIELDS_MAX)? {
            let part = |name: &str| {
                value.get(name).map(localized_text).transpose().map(Option::unwrap_or_default)
            };
            let display_name = part("DisplayName")?;
            let number = value.get("Value").map(|number| {
                integer_64(number, "an Int64 as a string of digits", &mut decoder.diagnostics)
            });
            let name = match value.get("Name").filter(|name| !name.is_null()) {
                Some(name) => text(name)?.into(),
                None => display_name.text.clone().unwrap_or_default(),
            };
            values.push(EnumValue {
                value: number.transpose()?.unwrap_or_default(),
                name,
                display_name,
                description: part("Description")?,
            });
        }
    }
    Ok(Some(EnumType {
        type_id: decoder.namespaces.node_id(id)?,
        name: type_name(node, decoder)?,
        built_in_type: stated_type(node).unwrap_or(BuiltInType::Int32),
        values,
    }))
}

/// Another name for a simple type; one without id describes nothing.
fn simple_type<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &Decoder<'_>,
) -> Result<Option<SimpleType>, Mismatch<'t, 'a>> {
    let Some(id) = node.get("DataTypeId") else { return Ok(None) };
    let base_type = node
        .get("BaseDataType")
        .filter(|id| !id.is_null())
        .map(|id| decoder.namespaces.node_id(id))
        .transpose()?;
    let inherited = base_type
        .as_ref()
        .map(built_in_type_of)
        .filter(|found| *found != BuiltInType::ExtensionObject);
    let built_in_type = stated_type(node).or(inherited).unwrap_or(BuiltInType::Variant);
    Ok(Some(SimpleType {
        type_id: decoder.namespaces.node_id(id)?,
        name: type_name(node, decoder)?,
        base_type: base_type.unwrap_or_else(|| NodeId::ua(u32::from(built_in_type.id()))),
        built_in_type,
    }))
}

fn stated_type(node: JsonNode<'_, '_>) -> Option<BuiltInType> {
    node.get("BuiltInType").and_then(JsonNode::integer).and_then(BuiltInType::from_id)
}

fn type_name<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &Decoder<'_>,
) -> Result<Arc<str>, Mismatch<'t, 'a>> {
    let name = node.get("Name").map(|name| decoder.namespaces.qualified_name(name)).transpose()?;
    Ok(name.and_then(|name| name.name).unwrap_or_default())
}

fn structure_type<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &Decoder<'_>,
    aliases: &HashMap<&NodeId, BuiltInType>,
) -> Result<StructureType, Mismatch<'t, 'a>> {
    let missing = |name: &str| Mismatch::new(node, format!("{name} is missing"));
    let id = node.get("DataTypeId").ok_or_else(|| missing("DataTypeId"))?;
    let definition =
        node.get("StructureDefinition").ok_or_else(|| missing("StructureDefinition"))?;
    let kind = match definition
        .get("StructureType")
        .map(|kind| match named_value(kind) {
            Some(number) => Ok(u8::try_from(number).unwrap_or(u8::MAX)),
            None => integer::<u8>(kind, "0 to 4"),
        })
        .transpose()?
    {
        None | Some(0 | 3) => StructureKind::Plain,
        Some(1) => StructureKind::WithOptionalFields,
        Some(2 | 4) => StructureKind::Union,
        Some(_) => return Err(Mismatch::new(definition, "StructureType must be 0 to 4")),
    };
    let encoding_ids = match definition.get("DefaultEncodingId").filter(|id| !id.is_null()) {
        Some(id) => Some(decoder.namespaces.node_id(id)?).filter(|id| *id != NodeId::null()),
        None => None,
    };
    let mut fields = Vec::new();
    for field in list(definition, "Fields", TYPE_FIELDS_MAX)? {
        fields.push(structure_field(field, decoder, aliases)?);
    }
    Ok(StructureType {
        type_id: decoder.namespaces.node_id(id)?,
        encoding_ids: encoding_ids.into_iter().collect(),
        name: type_name(node, decoder)?,
        kind,
        fields,
    })
}

fn structure_field<'t, 'a>(
    node: JsonNode<'t, 'a>,
    decoder: &Decoder<'_>,
    aliases: &HashMap<&NodeId, BuiltInType>,
) -> Result<StructureField, Mismatch<'t, 'a>> {
    let name = node.get("Name").ok_or_else(|| Mismatch::new(node, "Name is missing"))?;
    let data_type = match node.get("DataType").filter(|id| !id.is_null()) {
        Some(id) => decoder.namespaces.node_id(id)?,
        None => NodeId::ua(24),
    };
    let built_in_type =
        aliases.get(&data_type).copied().unwrap_or_else(|| built_in_type_of(&data_type));
    Ok(StructureField {
        name: text(name)?.into(),
        built_in_type,
        data_type,
        description: description(node)?,
        value_rank: node.get("ValueRank").map_or(Ok(-1), |rank| integer(rank, "a ValueRank"))?,
        array_dimensions: array_dimensions(node)?,
        max_string_length: max_string_length(node)?,
        is_optional: node.get("IsOptional").and_then(JsonNode::boolean).unwrap_or(false),
    })
}

/// The built-in type behind a data type of namespace 0; a type of another namespace that is not
/// listed as alias or enumeration is a structure.
fn built_in_type_of(data_type: &NodeId) -> BuiltInType {
    use crate::values::{Identifier, Namespace};
    let (Namespace::Ua, Identifier::Numeric(id)) = (&data_type.namespace, &data_type.identifier)
    else {
        return BuiltInType::ExtensionObject;
    };
    match id {
        1..=25 => BuiltInType::from_id(u64::from(*id)).unwrap_or(BuiltInType::Variant),
        26..=28 => BuiltInType::Variant,
        29 => BuiltInType::Int32,
        // Duration.
        290 => BuiltInType::Double,
        // UtcTime and Date.
        293 | 294 => BuiltInType::DateTime,
        // LocaleId, NumericRange and the kinds of texts.
        291 | 295 | 12_877..=12_881 => BuiltInType::String,
        // IntegerId, Counter and VersionTime.
        288 | 289 | 20_998 => BuiltInType::UInt32,
        // Image.
        30 => BuiltInType::ByteString,
        _ => BuiltInType::ExtensionObject,
    }
}
