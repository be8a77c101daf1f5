//! Reading values: variants, data values, arrays and bare values.

use std::sync::Arc;

use super::{
    decode_names::NamespaceTable,
    decode_scalar::{
        boolean, bytes, default_scalar, diagnostic_info, float, foreign_status, guid, integer,
        integer_64, localized_text, named_status, named_value, noted_time, status_code, text,
    },
    decoded_value::DecodedValue,
    diagnostics::{Diagnostics, Leniency},
    mismatch::Mismatch,
    shape::Shape,
};
use crate::{
    json::{JsonNode, Kind},
    values::{
        BuiltInType, DataValue, DateTime, NodeId, STRUCTURE, Scalar, StatusCode, StructureField,
        StructureType, Variant,
    },
};

/// Most structure fields of one input, defaults of absent ones included: `[{},{},…]` under a
/// foreign description is short to write and long to fill in.
const STRUCTURE_FIELDS_MAX: usize = 500_000;

/// Type of a value according to metadata.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TypeHint<'h> {
    pub(crate) built_in_type: BuiltInType,
    pub(crate) data_type: &'h NodeId,
    pub(crate) value_rank: i32,
}

impl<'h> From<&'h StructureField> for TypeHint<'h> {
    fn from(field: &'h StructureField) -> Self {
        Self {
            built_in_type: field.built_in_type,
            data_type: &field.data_type,
            value_rank: field.value_rank,
        }
    }
}

impl TypeHint<'_> {
    /// The structure type that a value of it must have, unless any may stand there.
    pub(super) fn structure(&self) -> Option<&NodeId> {
        (self.built_in_type == BuiltInType::ExtensionObject && *self.data_type != STRUCTURE)
            .then_some(self.data_type)
    }
}

/// Reads values in all forms.
#[derive(Debug)]
pub struct Decoder<'d> {
    pub(crate) diagnostics: Diagnostics,
    pub(super) types: &'d [StructureType],
    pub(crate) namespaces: NamespaceTable<'d>,
    structure_fields_left: usize,
}

impl<'d> Decoder<'d> {
    /// A decoder that knows structures beside those of namespace 0, and the namespaces behind
    /// indexes (the first is index 1).
    #[must_use]
    pub const fn new(
        leniency: Leniency,
        types: &'d [StructureType],
        namespaces: &'d [Arc<str>],
    ) -> Self {
        Self {
            diagnostics: Diagnostics::new(leniency),
            types,
            namespaces: NamespaceTable(namespaces),
            structure_fields_left: STRUCTURE_FIELDS_MAX,
        }
    }

    /// Replaces what is known from metadata.
    pub(crate) fn set_described(&mut self, types: &'d [StructureType], namespaces: &'d [Arc<str>]) {
        self.types = types;
        self.namespaces = NamespaceTable(namespaces);
    }

    /// Takes structure fields from the budget of this input.
    pub(super) fn spend_fields<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        count: usize,
    ) -> Result<(), Mismatch<'t, 'a>> {
        if self.can_spend_fields(count) {
            Ok(())
        } else {
            Err(Mismatch::out_of_range(node, "the message has too many structure fields"))
        }
    }

    pub(super) fn can_spend_fields(&mut self, count: usize) -> bool {
        let left = self.structure_fields_left.checked_sub(count);
        self.structure_fields_left = left.unwrap_or(0);
        left.is_some()
    }

    /// A value in any form. Bare values have the type that metadata gives them.
    pub(crate) fn value<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        hint: Option<TypeHint<'_>>,
    ) -> Result<DecodedValue, Mismatch<'t, 'a>> {
        if node.kind() != Kind::Object || self.is_own_structure(node, hint) {
            return self.bare_or_guess(node, hint).map(DecodedValue::Bare);
        }
        let shape = Shape::of(node);
        if shape.is_variant_104() || shape.is_variant_105() {
            return self.typed(node, &shape).map(DecodedValue::Variant);
        }
        if shape.is_data_value_105() || shape.is_data_value() {
            return self.data_value_of(node, &shape, hint).map(DecodedValue::DataValue);
        }
        let node = self.without_envelope(node, &shape)?;
        self.bare_or_guess(node, hint).map(DecodedValue::Bare)
    }

    /// The body of a variant that does not name its type, else the node itself.
    fn without_envelope<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        shape: &Shape<'t, 'a>,
    ) -> Result<JsonNode<'t, 'a>, Mismatch<'t, 'a>> {
        let Some(body) = shape.untyped_body() else { return Ok(node) };
        self.diagnostics.tolerate(node, "a Variant must name its Type beside its Body")?;
        Ok(body)
    }

    /// A described structure may have fields of its own that are called as an envelope's members;
    /// then metadata wins.
    fn is_own_structure(&self, node: JsonNode<'_, '_>, hint: Option<TypeHint<'_>>) -> bool {
        let Some(hint) = hint else { return false };
        let Some(description) = hint.structure().and_then(|id| StructureType::find(self.types, id))
        else {
            return false;
        };
        let is_own = |name: &str| description.fields.iter().any(|field| &*field.name == name);
        ["Type", "Body", "UaType", "Value", "Status", "StatusCode"].into_iter().any(is_own)
            && node.members().all(|(name, _)| name.text().is_some_and(|name| is_own(&name)))
    }

    /// A variant: with type, or bare where the type is unknown.
    pub(crate) fn variant<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        Ok(match self.value(node, None)? {
            DecodedValue::Variant(value) | DecodedValue::Bare(value) => value,
            DecodedValue::DataValue(value) => Variant::Scalar(Scalar::DataValue(Box::new(value))),
        })
    }

    /// A data value in either form.
    pub(super) fn data_value<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
    ) -> Result<DataValue, Mismatch<'t, 'a>> {
        if node.kind() != Kind::Object {
            return Err(Mismatch::new(node, "a DataValue must be an object"));
        }
        let shape = Shape::of(node);
        if shape.is_variant_104() {
            return Ok(DataValue { value: self.typed(node, &shape)?, ..DataValue::default() });
        }
        if shape.is_empty() {
            return Ok(DataValue::default());
        }
        self.data_value_of(node, &shape, None)
    }

    fn data_value_of<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        shape: &Shape<'t, 'a>,
        hint: Option<TypeHint<'_>>,
    ) -> Result<DataValue, Mismatch<'t, 'a>> {
        let value = match (shape.ua_type, shape.value) {
            (Some(_), _) => self.typed(node, shape)?,
            (None, None) => Variant::Null,
            (None, Some(inner)) => self.inner_value(inner, shape, hint)?,
        };
        Ok(DataValue {
            value,
            status: match (shape.status, shape.status_code) {
                (Some(status), _) => named_status(status, &mut self.diagnostics)?,
                (None, Some(status)) => foreign_status(status, &mut self.diagnostics)?,
                (None, None) => StatusCode::GOOD,
            },
            source_timestamp: self.time(shape.source_timestamp)?,
            source_picoseconds: self.picoseconds(shape.source_picoseconds)?,
            server_timestamp: self.time(shape.server_timestamp)?,
            server_picoseconds: self.picoseconds(shape.server_picoseconds)?,
        })
    }

    /// The `Value` of a data value that does not name its type beside it: a 1.04 variant, or bare.
    fn inner_value<'t, 'a>(
        &mut self,
        mut inner: JsonNode<'t, 'a>,
        outer: &Shape<'t, 'a>,
        hint: Option<TypeHint<'_>>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        if inner.kind() == Kind::Object && !self.is_own_structure(inner, hint) {
            let shape = Shape::of(inner);
            if shape.is_variant_104() || shape.is_variant_105() {
                return self.typed(inner, &shape);
            }
            inner = self.without_envelope(inner, &shape)?;
        }
        let bare = self.bare_or_guess(inner, hint)?;
        match (bare, outer.dimensions) {
            (Variant::Array(array), Some(dimensions)) => {
                let array = Arc::unwrap_or_clone(array);
                self.array(inner, array.element_type, array.elements, Some(dimensions))
            }
            (bare, _) => Ok(bare),
        }
    }

    fn time<'t, 'a>(
        &mut self,
        node: Option<JsonNode<'t, 'a>>,
    ) -> Result<Option<DateTime>, Mismatch<'t, 'a>> {
        node.map(|node| noted_time(node, &mut self.diagnostics)).transpose()
    }

    fn picoseconds<'t, 'a>(&self, node: Option<JsonNode<'t, 'a>>) -> Result<u16, Mismatch<'t, 'a>> {
        let Some(node) = node else { return Ok(0) };
        node.integer()
            .ok_or_else(|| Mismatch::new(node, "picoseconds must be a number from 0 to 65535"))
    }

    /// The value of an object that names its type.
    fn typed<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        shape: &Shape<'t, 'a>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        let (type_node, body) = match shape.ua_type {
            Some(ua_type) => (ua_type, shape.value),
            None => (shape.type_id.unwrap_or(node), shape.body),
        };
        const EXPECTED: &str = "the type must be the id of a built-in type, 0 to 25";
        let named = type_node.text().and_then(|name| name.parse::<BuiltInType>().ok());
        if named.is_some() {
            self.diagnostics.tolerate(type_node, EXPECTED)?;
        }
        let id = named.map(|known| u64::from(known.id())).or_else(|| type_node.integer());
        if id == Some(0) {
            return Ok(Variant::Null);
        }
        let built_in_type =
            id.and_then(BuiltInType::from_id).ok_or_else(|| Mismatch::new(type_node, EXPECTED))?;
        match body {
            None => Ok(Variant::Scalar(default_scalar(built_in_type))),
            Some(body) if body.kind() == Kind::Array => {
                if body.elements().next().is_some_and(|first| first.kind() == Kind::Array) {
                    return self.matrix(body, built_in_type, None);
                }
                let elements = self.elements(body, built_in_type, None)?;
                self.array(body, built_in_type, elements, shape.dimensions)
            }
            Some(body) => self.scalar(body, built_in_type, None).map(Variant::Scalar),
        }
    }

    /// A single value of a type; `structure` is the DataType that a structure must have, where one
    /// is declared.
    pub(super) fn scalar<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        built_in_type: BuiltInType,
        structure: Option<&NodeId>,
    ) -> Result<Scalar, Mismatch<'t, 'a>> {
        use BuiltInType as T;
        if node.is_null() {
            return Ok(default_scalar(built_in_type));
        }
        Ok(match built_in_type {
            T::Boolean => Scalar::Boolean(boolean(node, &mut self.diagnostics)?),
            T::SByte => Scalar::SByte(integer(node, "a number from -128 to 127")?),
            T::Byte => Scalar::Byte(integer(node, "a number from 0 to 255")?),
            T::Int16 => Scalar::Int16(integer(node, "a number from -32768 to 32767")?),
            T::UInt16 => Scalar::UInt16(integer(node, "a number from 0 to 65535")?),
            T::Int32 => Scalar::Int32(match named_value(node) {
                Some(value) => value,
                None => integer(node, "a number from -2147483648 to 2147483647")?,
            }),
            T::UInt32 => Scalar::UInt32(integer(node, "a number from 0 to 4294967295")?),
            T::Int64 => Scalar::Int64(integer_64(
                node,
                "an Int64 as a string of digits",
                &mut self.diagnostics,
            )?),
            T::UInt64 => Scalar::UInt64(integer_64(
                node,
                "a UInt64 as a string of digits",
                &mut self.diagnostics,
            )?),
            T::Float => Scalar::Float(float(
                node,
                f32::INFINITY,
                |value: &f32| value.is_finite(),
                f32::NAN,
            )?),
            T::Double => Scalar::Double(float(
                node,
                f64::INFINITY,
                |value: &f64| value.is_finite(),
                f64::NAN,
            )?),
            T::String => Scalar::String(Some(text(node)?.into())),
            T::XmlElement => Scalar::XmlElement(Some(text(node)?.into())),
            T::DateTime => Scalar::DateTime(noted_time(node, &mut self.diagnostics)?),
            T::Guid => Scalar::Guid(guid(node)?),
            T::ByteString => Scalar::ByteString(Some(bytes(node)?)),
            T::NodeId => Scalar::NodeId(Box::new(self.namespaces.node_id(node)?)),
            T::ExpandedNodeId => {
                Scalar::ExpandedNodeId(Box::new(self.namespaces.expanded_node_id(node)?))
            }
            T::StatusCode => Scalar::StatusCode(status_code(node)?),
            T::QualifiedName => {
                Scalar::QualifiedName(Box::new(self.namespaces.qualified_name(node)?))
            }
            T::LocalizedText => Scalar::LocalizedText(Box::new(localized_text(node)?)),
            T::ExtensionObject => {
                Scalar::ExtensionObject(Box::new(self.extension_object(node, structure)?))
            }
            T::DataValue => Scalar::DataValue(Box::new(self.data_value(node)?)),
            T::Variant => Scalar::Variant(Box::new(self.variant(node)?)),
            T::DiagnosticInfo => Scalar::DiagnosticInfo(Box::new(diagnostic_info(node)?)),
        })
    }
}
