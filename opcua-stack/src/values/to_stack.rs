//! Conversion of our values to the stack's.

use std::{io::Cursor, sync::Arc};

use asi_model::values as model;
use model::{ExtensionBody, StructureValue};
use opcua::types as stack;
use stack::{
    StructureType,
    custom::{DynamicStructure, StructTypeInfo},
};

use super::{
    ConversionError, DEPTH_MAX,
    ids::{
        expanded_node_id_to_stack, localized_text_to_stack, node_id_to_stack,
        qualified_name_to_stack, status_to_stack, string_to_stack, time_to_stack,
    },
};
use crate::NamespaceTable;

/// Range (OPC 10000-8 §5.6.2), a structure of every analog variable, known without reading the
/// server's types.
const RANGE: u32 = 884;
/// EUInformation (OPC 10000-8 §5.6.4), known for the same reason.
const EU_INFORMATION: u32 = 887;

/// Converts a data value for the peer.
///
/// # Errors
/// [`ConversionError`] when the peer lacks a namespace or data type, or the value contradicts
/// itself.
pub fn to_stack(
    value: &model::DataValue,
    namespaces: &NamespaceTable,
) -> Result<stack::DataValue, ConversionError> {
    StackEncoder { namespaces, depth: 0 }.data_value(value)
}

/// Converts a value for the peer.
///
/// # Errors
/// [`ConversionError`] when the peer lacks a namespace or data type, or the value contradicts
/// itself.
pub fn variant_to_stack(
    value: &model::Variant,
    namespaces: &NamespaceTable,
) -> Result<stack::Variant, ConversionError> {
    StackEncoder { namespaces, depth: 0 }.variant(value)
}

/// Converter at some depth of a value that may nest.
#[derive(Clone, Copy)]
struct StackEncoder<'a> {
    namespaces: &'a NamespaceTable,
    depth: usize,
}

impl StackEncoder<'_> {
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

fn extension_object_to_stack(
    object: &model::ExtensionObject,
    encoder: StackEncoder<'_>,
) -> Result<stack::ExtensionObject, ConversionError> {
    let type_name = || object.type_id.node_id.to_string();
    match &object.body {
        ExtensionBody::None => Ok(stack::ExtensionObject::null()),
        ExtensionBody::Json(_) => {
            // A type of a foreign namespace is the first thing to say, whatever its body.
            node_id_to_stack(&object.type_id.node_id, encoder.namespaces)?;
            Err(ConversionError::JsonBody { type_id: type_name() })
        }
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
    encoder: StackEncoder<'_>,
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
    encoder: StackEncoder<'_>,
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
    encoder: StackEncoder<'_>,
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
