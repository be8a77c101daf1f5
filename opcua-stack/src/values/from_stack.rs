//! Conversion of the stack's values to ours. Structures have fields by name where their definition is
//! known, bytes where it is not.

use std::sync::Arc;

use asi_model::values as model;
use model::{ExtensionBody, StructureValue};
use opcua::types as stack;
use stack::{DynEncodable, StructureType, UaNullable, custom::DynamicStructure};

use super::{
    ConversionError,
    ids::{
        expanded_node_id_from_stack, localized_text_from_stack, node_id_from_stack,
        qualified_name_from_stack, status_from_stack, string_from_stack, time_from_stack,
    },
};
use crate::NamespaceTable;

/// Converts a data value of the peer. One that cannot be decoded becomes `BadDecodingError` with its
/// times.
#[must_use]
pub fn from_stack(value: stack::DataValue, namespaces: &NamespaceTable) -> model::DataValue {
    let (content, status) = match value
        .value
        .map_or(Ok(model::Variant::Null), |v| variant_from_stack(v, namespaces))
    {
        Ok(content) => (content, value.status.map_or(model::StatusCode::GOOD, status_from_stack)),
        Err(_) => (model::Variant::Null, model::StatusCode::BAD_DECODING_ERROR),
    };
    model::DataValue {
        value: content,
        status,
        source_timestamp: value.source_timestamp.map(time_from_stack),
        source_picoseconds: value.source_picoseconds.unwrap_or(0),
        server_timestamp: value.server_timestamp.map(time_from_stack),
        server_picoseconds: value.server_picoseconds.unwrap_or(0),
    }
}

/// Converts a value of the peer. A variant directly inside a variant is replaced by the inner one.
///
/// # Errors
/// [`ConversionError`] when an array contradicts itself or a structure cannot be converted.
pub fn variant_from_stack(
    value: stack::Variant,
    namespaces: &NamespaceTable,
) -> Result<model::Variant, ConversionError> {
    match value {
        stack::Variant::Empty => Ok(model::Variant::Null),
        stack::Variant::Variant(inner) => variant_from_stack(*inner, namespaces),
        stack::Variant::Array(array) => array_from_stack(*array, namespaces),
        scalar => scalar_from_stack(scalar, namespaces).map(model::Variant::Scalar),
    }
}

fn array_from_stack(
    array: stack::Array,
    namespaces: &NamespaceTable,
) -> Result<model::Variant, ConversionError> {
    let element_type = model::BuiltInType::from_id(array.value_type as u64)
        .ok_or(ConversionError::InvalidArray)?;
    let elements = array
        .values
        .into_iter()
        .map(|element| match element {
            // In an array of variants an element may be anything, a variant of an array included.
            element if element_type == model::BuiltInType::Variant => {
                let inner = variant_from_stack(element, namespaces)?;
                Ok(model::Scalar::Variant(Box::new(inner)))
            }
            element => scalar_from_stack(element, namespaces),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let dimensions = array.dimensions.filter(|dimensions| dimensions.len() > 1);
    Ok(model::Variant::Array(Arc::new(model::Array { element_type, elements, dimensions })))
}

fn scalar_from_stack(
    value: stack::Variant,
    namespaces: &NamespaceTable,
) -> Result<model::Scalar, ConversionError> {
    use model::Scalar as M;
    use stack::Variant as S;
    Ok(match value {
        S::Boolean(v) => M::Boolean(v),
        S::SByte(v) => M::SByte(v),
        S::Byte(v) => M::Byte(v),
        S::Int16(v) => M::Int16(v),
        S::UInt16(v) => M::UInt16(v),
        S::Int32(v) => M::Int32(v),
        S::UInt32(v) => M::UInt32(v),
        S::Int64(v) => M::Int64(v),
        S::UInt64(v) => M::UInt64(v),
        S::Float(v) => M::Float(v),
        S::Double(v) => M::Double(v),
        S::String(v) => M::String(string_from_stack(&v)),
        S::DateTime(v) => M::DateTime(time_from_stack(*v)),
        S::Guid(v) => M::Guid((*v).into()),
        S::StatusCode(v) => M::StatusCode(status_from_stack(v)),
        S::ByteString(v) => M::ByteString(v.value.map(Arc::from)),
        S::XmlElement(v) => M::XmlElement((!v.is_ua_null()).then(|| Arc::from(v.to_string()))),
        S::QualifiedName(v) => {
            M::QualifiedName(Box::new(qualified_name_from_stack(&v, namespaces)))
        }
        S::LocalizedText(v) => M::LocalizedText(Box::new(localized_text_from_stack(&v))),
        S::NodeId(v) => M::NodeId(Box::new(node_id_from_stack(&v, namespaces))),
        S::ExpandedNodeId(v) => {
            M::ExpandedNodeId(Box::new(expanded_node_id_from_stack(&v, namespaces)))
        }
        S::ExtensionObject(v) => {
            M::ExtensionObject(Box::new(extension_object_from_stack(v, namespaces)?))
        }
        S::DataValue(v) => M::DataValue(Box::new(from_stack(*v, namespaces))),
        S::DiagnosticInfo(v) => M::DiagnosticInfo(Box::new(diagnostics_from_stack(*v))),
        S::Variant(v) => M::Variant(Box::new(variant_from_stack(*v, namespaces)?)),
        S::Empty | S::Array(_) => return Err(ConversionError::InvalidArray),
    })
}

fn diagnostics_from_stack(diagnostics: stack::DiagnosticInfo) -> model::DiagnosticInfo {
    model::DiagnosticInfo {
        symbolic_id: diagnostics.symbolic_id,
        namespace_uri: diagnostics.namespace_uri,
        locale: diagnostics.locale,
        localized_text: diagnostics.localized_text,
        additional_info: diagnostics.additional_info.as_ref().and_then(string_from_stack),
        inner_status_code: diagnostics.inner_status_code.map(status_from_stack),
        inner_diagnostic_info: diagnostics
            .inner_diagnostic_info
            .map(|inner| Box::new(diagnostics_from_stack(*inner))),
    }
}

fn extension_object_from_stack(
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
