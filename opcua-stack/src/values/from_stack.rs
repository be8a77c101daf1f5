//! The stack's values to ours.

use std::sync::Arc;

use asi_model::values as model;
use opcua::types as stack;
use stack::UaNullable;

use super::{
    ConversionError,
    ids::{
        expanded_node_id_from_stack, localized_text_from_stack, node_id_from_stack,
        qualified_name_from_stack, status_from_stack, string_from_stack, time_from_stack,
    },
    structures::extension_object_from_stack,
};
use crate::NamespaceTable;

/// A data value of the peer. What cannot be understood becomes `BadDecodingError` with the times
/// kept.
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

/// A value of the peer. A variant directly inside a variant is the inner one.
///
/// # Errors
/// [`ConversionError`] when an array contradicts itself or a structure cannot be kept.
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
