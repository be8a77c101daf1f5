//! Structures: fields by name where a definition is known, bytes where it is not.

use std::{io::Cursor, sync::Arc};

use asi_model::values as model;
use model::{ExtensionBody, StructureValue};
use opcua::types as stack;
use stack::{
    DynEncodable, StructureType,
    custom::{DynamicStructure, StructTypeInfo},
};

use super::{
    ConversionError,
    ids::{
        expanded_node_id_from_stack, localized_text_from_stack, localized_text_to_stack,
        node_id_from_stack, node_id_to_stack, string_from_stack, string_to_stack,
    },
    to_stack::Encoder,
    variant_from_stack,
};
use crate::NamespaceTable;

/// Range (OPC 10000-8 §5.6.2), a structure of every analog variable, known without reading the
/// server's types.
const RANGE: u32 = 884;
/// EUInformation (OPC 10000-8 §5.6.4), likewise.
const EU_INFORMATION: u32 = 887;

pub(super) fn extension_object_from_stack(
    object: stack::ExtensionObject,
    namespaces: &NamespaceTable,
) -> Result<model::ExtensionObject, ConversionError> {
    let Some(body) = object.body else {
        return Ok(model::ExtensionObject {
            type_id: local(model::NodeId::null()),
            body: ExtensionBody::None,
        });
    };
    let any = body.as_dyn_any_ref();
    if let Some(structure) = any.downcast_ref::<DynamicStructure>() {
        return dynamic_from_stack(structure, namespaces);
    }
    if let Some(raw) = any.downcast_ref::<stack::ByteStringBody>() {
        return Ok(model::ExtensionObject {
            type_id: local(data_type_of(raw.encoding_id(), namespaces)),
            body: ExtensionBody::Binary(Arc::from(raw.raw_body().as_ref())),
        });
    }
    if let Some(raw) = any.downcast_ref::<stack::XmlBody>() {
        return Ok(model::ExtensionObject {
            type_id: local(data_type_of(raw.encoding_id(), namespaces)),
            body: ExtensionBody::Xml(Arc::from(String::from_utf8_lossy(raw.raw_body()))),
        });
    }
    let type_id = expanded_node_id_from_stack(&body.data_type_id(), namespaces);
    let body = if let Some(range) = any.downcast_ref::<stack::Range>() {
        structure([("Low", range.low.into()), ("High", range.high.into())])
    } else if let Some(unit) = any.downcast_ref::<stack::EUInformation>() {
        unit_from_stack(unit)
    } else {
        ExtensionBody::Binary(encode(body.as_ref(), namespaces)?.into())
    };
    Ok(model::ExtensionObject { type_id, body })
}

pub(super) fn extension_object_to_stack(
    object: &model::ExtensionObject,
    encoder: Encoder<'_>,
) -> Result<stack::ExtensionObject, ConversionError> {
    let type_name = || object.type_id.node_id.to_string();
    match &object.body {
        ExtensionBody::None => Ok(stack::ExtensionObject::null()),
        ExtensionBody::Json(_) => Err(ConversionError::JsonBody { type_id: type_name() }),
        ExtensionBody::Xml(text) => {
            let id = node_id_to_stack(&object.type_id.node_id, encoder.namespaces)?;
            Ok(stack::ExtensionObject::new(stack::XmlBody::new(
                text.as_bytes().to_vec(),
                id,
                String::new(),
            )))
        }
        ExtensionBody::Binary(bytes) => {
            let id = node_id_to_stack(&object.type_id.node_id, encoder.namespaces)?;
            Ok(binary_to_stack(&id, bytes, encoder.namespaces))
        }
        ExtensionBody::Structure(value) => structure_to_stack(object, value, encoder),
    }
}

fn local(node_id: model::NodeId) -> model::ExpandedNodeId {
    model::ExpandedNodeId { node_id, server: model::Server::Local }
}

/// The data type behind an encoding's id, or that id where the type is not known.
fn data_type_of(encoding_id: &stack::NodeId, namespaces: &NamespaceTable) -> model::NodeId {
    let types =
        namespaces.data_types().and_then(|types| types.encoding_to_data_type().get(encoding_id));
    node_id_from_stack(types.unwrap_or(encoding_id), namespaces)
}

fn structure<const N: usize>(fields: [(&str, model::Variant); N]) -> ExtensionBody {
    let fields = fields.into_iter().map(|(name, value)| (Arc::from(name), value)).collect();
    ExtensionBody::Structure(StructureValue { fields, ..StructureValue::default() })
}

fn unit_from_stack(unit: &stack::EUInformation) -> ExtensionBody {
    let text = |text| {
        model::Variant::Scalar(model::Scalar::LocalizedText(Box::new(localized_text_from_stack(
            text,
        ))))
    };
    let uri = model::Variant::Scalar(model::Scalar::String(string_from_stack(&unit.namespace_uri)));
    structure([
        ("NamespaceUri", uri),
        ("UnitId", unit.unit_id.into()),
        ("DisplayName", text(&unit.display_name)),
        ("Description", text(&unit.description)),
    ])
}

fn encode(
    body: &dyn DynEncodable,
    namespaces: &NamespaceTable,
) -> Result<Vec<u8>, ConversionError> {
    let mut bytes = Vec::new();
    body.encode_binary(&mut bytes, &namespaces.context().context()).map_err(|error| {
        ConversionError::Encoding {
            type_id: body.data_type_id().to_string(),
            reason: error.to_string(),
        }
    })?;
    Ok(bytes)
}

fn dynamic_from_stack(
    value: &DynamicStructure,
    namespaces: &NamespaceTable,
) -> Result<model::ExtensionObject, ConversionError> {
    let id = value.data_type_id().node_id;
    let type_id = local(node_id_from_stack(&id, namespaces));
    // A value from an older table of the same server may be of a type that this table does not
    // know.
    let Some(definition) = namespaces.data_types().and_then(|types| types.get_struct_type(&id))
    else {
        let bytes = encode(value, namespaces)?;
        return Ok(model::ExtensionObject { type_id, body: ExtensionBody::Binary(bytes.into()) });
    };
    let mut fields = StructureValue::default();
    if definition.structure_type == StructureType::Union {
        // The stack keeps the selector to itself; it leads the encoding as UInt32 (OPC 10000-6
        // §5.2.8).
        let bytes = encode(value, namespaces)?;
        let selector = bytes.first_chunk().copied().map_or(0, u32::from_le_bytes);
        fields.switch_field = Some(selector);
        if let (Some(field), Some(content)) =
            (definition.fields.get((selector as usize).wrapping_sub(1)), value.values().first())
        {
            fields.fields.insert(
                Arc::from(field.name.as_str()),
                variant_from_stack(content.clone(), namespaces)?,
            );
        }
    } else {
        let mut mask = 0_u32;
        let mut optional_bit = 1_u32;
        for (field, content) in definition.fields.iter().zip(value.values()) {
            let is_absent = field.is_optional && matches!(content, stack::Variant::Empty);
            if field.is_optional {
                mask |= if is_absent { 0 } else { optional_bit };
                optional_bit = optional_bit.wrapping_shl(1);
            }
            if !is_absent {
                fields.fields.insert(
                    Arc::from(field.name.as_str()),
                    variant_from_stack(content.clone(), namespaces)?,
                );
            }
        }
        if definition.structure_type == StructureType::StructureWithOptionalFields {
            fields.encoding_mask = Some(mask);
        }
    }
    Ok(model::ExtensionObject { type_id, body: ExtensionBody::Structure(fields) })
}

/// Bytes under a data type's or an encoding's id: decoded where the stack knows the type, so that
/// it travels under its right encoding; kept as they are where it does not.
fn binary_to_stack(
    id: &stack::NodeId,
    bytes: &[u8],
    namespaces: &NamespaceTable,
) -> stack::ExtensionObject {
    let raw = |id: &stack::NodeId| {
        stack::ExtensionObject::new(stack::ByteStringBody::new(bytes.to_vec().into(), id.clone()))
    };
    if let Some(definition) = namespaces.data_types().and_then(|types| types.get_struct_type(id)) {
        return raw(&definition.encoding_ids.binary_id);
    }
    let context = namespaces.context().context();
    let mut stream = Cursor::new(bytes);
    match context.load_from_binary(id, &mut stream, Some(bytes.len())) {
        Ok(object) if usize::try_from(stream.position()) == Ok(bytes.len()) => object,
        _ => raw(id),
    }
}

fn structure_to_stack(
    object: &model::ExtensionObject,
    value: &StructureValue,
    encoder: Encoder<'_>,
) -> Result<stack::ExtensionObject, ConversionError> {
    let id = &object.type_id.node_id;
    if *id == model::NodeId::ua(RANGE) {
        return range_to_stack(value);
    }
    if *id == model::NodeId::ua(EU_INFORMATION) {
        return unit_to_stack(value);
    }
    let stack_id = node_id_to_stack(id, encoder.namespaces)?;
    let (Some(types), Some(definition)) = (
        encoder.namespaces.data_types(),
        encoder.namespaces.data_types().and_then(|types| types.get_struct_type(&stack_id)),
    ) else {
        return Err(ConversionError::UnknownStructure { type_id: id.to_string() });
    };
    let mismatch =
        |reason: String| ConversionError::StructureMismatch { type_id: id.to_string(), reason };
    if let Some(name) =
        value.fields.keys().find(|name| definition.get_field_by_name(name).is_none())
    {
        return Err(mismatch(format!("there is no field {name:?}")));
    }
    let (definition, types) = (Arc::clone(definition), Arc::clone(types));
    let structure = if definition.structure_type == StructureType::Union {
        match value.switch_field.unwrap_or(0) {
            0 => Ok(DynamicStructure::new_null_union(definition, types)),
            selector => {
                let field = definition.fields.get(selector as usize - 1);
                let content =
                    field.and_then(|field| Some((field, value.fields.get(field.name.as_str())?)));
                let (field, content) = content
                    .ok_or_else(|| mismatch(format!("the selected field {selector} is missing")))?;
                let content = field_to_stack(field.scalar_type, content, encoder)?;
                DynamicStructure::new_union(Arc::clone(&definition), types, content, selector)
            }
        }
    } else {
        let fields = fields_to_stack(&definition, value, encoder)?;
        DynamicStructure::new_struct(definition, types, fields)
    };
    structure.map(stack::ExtensionObject::new).map_err(|error| mismatch(error.to_string()))
}

fn fields_to_stack(
    definition: &StructTypeInfo,
    value: &StructureValue,
    encoder: Encoder<'_>,
) -> Result<Vec<stack::Variant>, ConversionError> {
    definition
        .fields
        .iter()
        .map(|field| match value.fields.get(field.name.as_str()) {
            Some(content) => field_to_stack(field.scalar_type, content, encoder),
            None => Ok(stack::Variant::Empty),
        })
        .collect()
}

/// A field of an abstract type is stored as a variant inside a variant.
fn field_to_stack(
    wanted: stack::VariantScalarTypeId,
    content: &model::Variant,
    encoder: Encoder<'_>,
) -> Result<stack::Variant, ConversionError> {
    let content = encoder.variant(content)?;
    let is_plain = wanted == stack::VariantScalarTypeId::Variant
        && !matches!(content, stack::Variant::Array(_));
    Ok(if is_plain { stack::Variant::Variant(Box::new(content)) } else { content })
}

fn range_to_stack(value: &StructureValue) -> Result<stack::ExtensionObject, ConversionError> {
    let bound = |name: &str| {
        value.fields.get(name).and_then(model::Variant::as_f64).ok_or_else(|| {
            ConversionError::StructureMismatch {
                type_id: model::NodeId::ua(RANGE).to_string(),
                reason: format!("{name} must be a Double"),
            }
        })
    };
    Ok(stack::ExtensionObject::new(stack::Range { low: bound("Low")?, high: bound("High")? }))
}

fn unit_to_stack(value: &StructureValue) -> Result<stack::ExtensionObject, ConversionError> {
    let scalar = |name: &str| value.fields.get(name).and_then(model::Variant::as_scalar);
    let text = |name: &str| match scalar(name) {
        Some(model::Scalar::LocalizedText(text)) => localized_text_to_stack(text),
        _ => stack::LocalizedText::null(),
    };
    let Some(model::Scalar::Int32(unit_id)) = scalar("UnitId") else {
        return Err(ConversionError::StructureMismatch {
            type_id: model::NodeId::ua(EU_INFORMATION).to_string(),
            reason: "UnitId must be an Int32".into(),
        });
    };
    Ok(stack::ExtensionObject::new(stack::EUInformation {
        namespace_uri: string_to_stack(scalar("NamespaceUri").and_then(model::Scalar::as_str)),
        unit_id: *unit_id,
        display_name: text("DisplayName"),
        description: text("Description"),
    }))
}
