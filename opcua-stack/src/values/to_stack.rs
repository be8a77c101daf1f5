//! Our values to the stack's.

use asi_model::values as model;
use opcua::types as stack;

use super::{
    ConversionError, DEPTH_MAX,
    ids::{
        expanded_node_id_to_stack, localized_text_to_stack, node_id_to_stack,
        qualified_name_to_stack, status_to_stack, string_to_stack, time_to_stack,
    },
    structures::extension_object_to_stack,
};
use crate::NamespaceTable;

/// A data value for the peer.
///
/// # Errors
/// [`ConversionError`] when the peer lacks a namespace or data type, or the value contradicts
/// itself.
pub fn to_stack(
    value: &model::DataValue,
    namespaces: &NamespaceTable,
) -> Result<stack::DataValue, ConversionError> {
    Encoder { namespaces, depth: 0 }.data_value(value)
}

/// A value for the peer.
///
/// # Errors
/// [`ConversionError`] when the peer lacks a namespace or data type, or the value contradicts
/// itself.
pub fn variant_to_stack(
    value: &model::Variant,
    namespaces: &NamespaceTable,
) -> Result<stack::Variant, ConversionError> {
    Encoder { namespaces, depth: 0 }.variant(value)
}

/// Where we are in a value that may nest.
#[derive(Clone, Copy)]
pub(super) struct Encoder<'a> {
    pub(super) namespaces: &'a NamespaceTable,
    depth: usize,
}

impl Encoder<'_> {
    fn deeper(self) -> Result<Self, ConversionError> {
        if self.depth < DEPTH_MAX {
            Ok(Self { depth: self.depth + 1, ..self })
        } else {
            Err(ConversionError::TooDeep)
        }
    }

    fn data_value(self, value: &model::DataValue) -> Result<stack::DataValue, ConversionError> {
        Ok(stack::DataValue {
            value: match &value.value {
                model::Variant::Null => None,
                content => Some(self.variant(content)?),
            },
            status: (value.status != model::StatusCode::GOOD)
                .then(|| status_to_stack(value.status)),
            source_timestamp: value.source_timestamp.map(time_to_stack),
            source_picoseconds: (value.source_picoseconds != 0).then_some(value.source_picoseconds),
            server_timestamp: value.server_timestamp.map(time_to_stack),
            server_picoseconds: (value.server_picoseconds != 0).then_some(value.server_picoseconds),
        })
    }

    pub(super) fn variant(self, value: &model::Variant) -> Result<stack::Variant, ConversionError> {
        match value {
            model::Variant::Null => Ok(stack::Variant::Empty),
            model::Variant::Scalar(scalar) => self.scalar(scalar),
            model::Variant::Array(array) => self.array(array),
        }
    }

    fn array(self, array: &model::Array) -> Result<stack::Variant, ConversionError> {
        let value_type = scalar_type(array.element_type);
        if array.elements.iter().any(|element| element.built_in_type() != array.element_type) {
            return Err(ConversionError::InvalidArray);
        }
        let values = array
            .elements
            .iter()
            .map(|element| self.scalar(element))
            .collect::<Result<Vec<_>, _>>()?;
        let array = match &array.dimensions {
            None => stack::Array::new(value_type, values),
            Some(dimensions) => {
                let product = dimensions
                    .iter()
                    .try_fold(1_usize, |product, &length| product.checked_mul(length as usize));
                if product != Some(values.len()) {
                    return Err(ConversionError::InvalidArray);
                }
                stack::Array::new_multi(value_type, values, dimensions.clone())
            }
        };
        array
            .map(|array| stack::Variant::Array(Box::new(array)))
            .map_err(|_| ConversionError::InvalidArray)
    }

    fn scalar(self, value: &model::Scalar) -> Result<stack::Variant, ConversionError> {
        use model::Scalar as M;
        use stack::Variant as S;
        let namespaces = self.namespaces;
        Ok(match value {
            M::Boolean(v) => S::Boolean(*v),
            M::SByte(v) => S::SByte(*v),
            M::Byte(v) => S::Byte(*v),
            M::Int16(v) => S::Int16(*v),
            M::UInt16(v) => S::UInt16(*v),
            M::Int32(v) => S::Int32(*v),
            M::UInt32(v) => S::UInt32(*v),
            M::Int64(v) => S::Int64(*v),
            M::UInt64(v) => S::UInt64(*v),
            M::Float(v) => S::Float(*v),
            M::Double(v) => S::Double(*v),
            M::String(v) => S::String(string_to_stack(v.as_deref())),
            M::DateTime(v) => S::DateTime(Box::new(time_to_stack(*v))),
            M::Guid(v) => S::Guid(Box::new((*v).into())),
            M::StatusCode(v) => S::StatusCode(status_to_stack(*v)),
            M::ByteString(v) => {
                S::ByteString(stack::ByteString { value: v.as_deref().map(<[u8]>::to_vec) })
            }
            M::XmlElement(v) => S::XmlElement(string_to_stack(v.as_deref()).into()),
            M::QualifiedName(v) => {
                S::QualifiedName(Box::new(qualified_name_to_stack(v, namespaces)?))
            }
            M::LocalizedText(v) => S::LocalizedText(Box::new(localized_text_to_stack(v))),
            M::NodeId(v) => S::NodeId(Box::new(node_id_to_stack(v, namespaces)?)),
            M::ExpandedNodeId(v) => {
                S::ExpandedNodeId(Box::new(expanded_node_id_to_stack(v, namespaces)?))
            }
            M::ExtensionObject(v) => {
                S::ExtensionObject(extension_object_to_stack(v, self.deeper()?)?)
            }
            M::DataValue(v) => S::DataValue(Box::new(self.deeper()?.data_value(v)?)),
            M::DiagnosticInfo(v) => S::DiagnosticInfo(Box::new(self.deeper()?.diagnostics(v)?)),
            M::Variant(v) => S::Variant(Box::new(self.deeper()?.variant(v)?)),
        })
    }

    fn diagnostics(
        self,
        diagnostics: &model::DiagnosticInfo,
    ) -> Result<stack::DiagnosticInfo, ConversionError> {
        Ok(stack::DiagnosticInfo {
            symbolic_id: diagnostics.symbolic_id,
            namespace_uri: diagnostics.namespace_uri,
            locale: diagnostics.locale,
            localized_text: diagnostics.localized_text,
            additional_info: diagnostics.additional_info.as_deref().map(stack::UAString::from),
            inner_status_code: diagnostics.inner_status_code.map(status_to_stack),
            inner_diagnostic_info: match &diagnostics.inner_diagnostic_info {
                Some(inner) => Some(Box::new(self.deeper()?.diagnostics(inner)?)),
                None => None,
            },
        })
    }
}

fn scalar_type(built_in: model::BuiltInType) -> stack::VariantScalarTypeId {
    use model::BuiltInType as M;
    use stack::VariantScalarTypeId as S;
    match built_in {
        M::Boolean => S::Boolean,
        M::SByte => S::SByte,
        M::Byte => S::Byte,
        M::Int16 => S::Int16,
        M::UInt16 => S::UInt16,
        M::Int32 => S::Int32,
        M::UInt32 => S::UInt32,
        M::Int64 => S::Int64,
        M::UInt64 => S::UInt64,
        M::Float => S::Float,
        M::Double => S::Double,
        M::String => S::String,
        M::DateTime => S::DateTime,
        M::Guid => S::Guid,
        M::ByteString => S::ByteString,
        M::XmlElement => S::XmlElement,
        M::NodeId => S::NodeId,
        M::ExpandedNodeId => S::ExpandedNodeId,
        M::StatusCode => S::StatusCode,
        M::QualifiedName => S::QualifiedName,
        M::LocalizedText => S::LocalizedText,
        M::ExtensionObject => S::ExtensionObject,
        M::DataValue => S::DataValue,
        M::Variant => S::Variant,
        M::DiagnosticInfo => S::DiagnosticInfo,
    }
}
