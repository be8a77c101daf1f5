//! Reading values: variants, data values, arrays and bare values.

use std::sync::Arc;

use super::{Diagnostic, Leniency, Mismatch, shape::Shape};
use crate::{
    json::{Kind, Node},
    pubsub::FieldMetaData,
    values::{
        BuiltInType, DataValue, NodeId, STRUCTURE, Scalar, StatusCode, StructureField,
        StructureType, Variant,
    },
};

/// How many diagnostics one input yields at most.
const DIAGNOSTICS_MAX: usize = 64;
/// How many structure fields one input yields at most, defaults of absent ones included:
/// `[{},{},…]` under a foreign description is short to write and long to fill in.
const STRUCTURE_FIELDS_MAX: usize = 500_000;

/// A value and the form in which it came.
#[derive(Debug, Clone, PartialEq)]
pub enum DecodedValue {
    /// With its type, without times.
    Variant(Variant),
    /// With its quality and times.
    DataValue(DataValue),
    /// Without its type.
    Bare(Variant),
}

impl DecodedValue {
    /// The value with its quality. A Bad status code that stands in a value's place, and a data
    /// value inside a variant, are what OPC 10000-14 §6.2.4.2 makes of values that are not Good;
    /// they become a value's quality again.
    #[must_use]
    pub fn into_data_value(self) -> DataValue {
        match self {
            Self::DataValue(value) => value,
            Self::Variant(Variant::Scalar(Scalar::DataValue(value))) => *value,
            Self::Variant(Variant::Scalar(Scalar::StatusCode(status))) if status.is_bad() => {
                DataValue::status_only(status, None)
            }
            Self::Variant(value) | Self::Bare(value) => DataValue { value, ..DataValue::default() },
        }
    }
}

/// What is known of a value's type beforehand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TypeHint<'h> {
    pub(crate) built_in_type: BuiltInType,
    pub(crate) data_type: &'h NodeId,
    pub(crate) value_rank: i32,
}

impl<'h> From<&'h FieldMetaData> for TypeHint<'h> {
    fn from(field: &'h FieldMetaData) -> Self {
        Self {
            built_in_type: field.built_in_type,
            data_type: &field.data_type,
            value_rank: field.value_rank,
        }
    }
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
    leniency: Leniency,
    pub(super) types: &'d [StructureType],
    pub(super) namespaces: &'d [Arc<str>],
    diagnostics: Vec<Diagnostic>,
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
            leniency,
            types,
            namespaces,
            diagnostics: Vec::new(),
            structure_fields_left: STRUCTURE_FIELDS_MAX,
        }
    }

    /// What was noteworthy so far.
    #[must_use]
    pub fn into_diagnostics(self) -> Vec<Diagnostic> {
        self.diagnostics
    }

    /// How deviations are met.
    pub(crate) const fn leniency(&self) -> Leniency {
        self.leniency
    }

    /// Takes over what another decoder noted.
    pub(crate) fn adopt(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < DIAGNOSTICS_MAX {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Replaces what is known from metadata.
    pub(crate) fn set_described(&mut self, types: &'d [StructureType], namespaces: &'d [Arc<str>]) {
        self.types = types;
        self.namespaces = namespaces;
    }

    /// Takes structure fields from the budget of this input.
    pub(super) fn spend_fields<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
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

    /// Notes something about a node.
    pub(crate) fn note(&mut self, node: Node<'_, '_>, message: impl Into<String>) {
        if self.diagnostics.len() < DIAGNOSTICS_MAX {
            self.diagnostics.push(Diagnostic { pointer: node.pointer(), message: message.into() });
        }
    }

    /// Takes a deviation with a note, or refuses it where strictness is asked for.
    pub(crate) fn tolerate<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
        message: &'static str,
    ) -> Result<(), Mismatch<'t, 'a>> {
        if self.leniency == Leniency::Strict {
            return Err(Mismatch::new(node, message));
        }
        self.note(node, message);
        Ok(())
    }

    /// A value in whichever form it is. Where metadata says what to expect, bare values follow it.
    pub(crate) fn value<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
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
        self.bare_or_guess(node, hint).map(DecodedValue::Bare)
    }

    /// A described structure may have fields of its own that are called as an envelope's members;
    /// then metadata wins.
    fn is_own_structure(&self, node: Node<'_, '_>, hint: Option<TypeHint<'_>>) -> bool {
        let Some(hint) = hint else { return false };
        let Some(description) = hint.structure().and_then(|id| StructureType::find(self.types, id))
        else {
            return false;
        };
        let is_own = |name: &str| description.fields.iter().any(|field| &*field.name == name);
        ["Type", "Body", "UaType", "Value", "Status"].into_iter().any(is_own)
            && node.members().all(|(name, _)| name.text().is_some_and(|name| is_own(&name)))
    }

    /// A variant: with type, or bare where the type cannot be told.
    pub(crate) fn variant<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        Ok(match self.value(node, None)? {
            DecodedValue::Variant(value) | DecodedValue::Bare(value) => value,
            DecodedValue::DataValue(value) => Variant::Scalar(Scalar::DataValue(Box::new(value))),
        })
    }

    /// A data value in either form.
    pub(super) fn data_value<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
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
        node: Node<'t, 'a>,
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
            status: shape.status.map_or(Ok(StatusCode::GOOD), |status| self.status_code(status))?,
            source_timestamp: shape
                .source_timestamp
                .map(|time| self.date_time(time))
                .transpose()?,
            source_picoseconds: self.picoseconds(shape.source_picoseconds)?,
            server_timestamp: shape
                .server_timestamp
                .map(|time| self.date_time(time))
                .transpose()?,
            server_picoseconds: self.picoseconds(shape.server_picoseconds)?,
        })
    }

    /// The `Value` of a data value that does not name its type beside it: a 1.04 variant, or bare.
    fn inner_value<'t, 'a>(
        &mut self,
        inner: Node<'t, 'a>,
        outer: &Shape<'t, 'a>,
        hint: Option<TypeHint<'_>>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        if inner.kind() == Kind::Object && !self.is_own_structure(inner, hint) {
            let shape = Shape::of(inner);
            if shape.is_variant_104() || shape.is_variant_105() {
                return self.typed(inner, &shape);
            }
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

    fn picoseconds<'t, 'a>(&self, node: Option<Node<'t, 'a>>) -> Result<u16, Mismatch<'t, 'a>> {
        let Some(node) = node else { return Ok(0) };
        node.integer()
            .ok_or_else(|| Mismatch::new(node, "picoseconds must be a number from 0 to 65535"))
    }

    /// The value of an object that names its type.
    fn typed<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
        shape: &Shape<'t, 'a>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        let (type_node, body) = match shape.ua_type {
            Some(ua_type) => (ua_type, shape.value),
            None => (shape.type_id.unwrap_or(node), shape.body),
        };
        let id: u64 = type_node.integer().ok_or_else(|| {
            Mismatch::new(type_node, "the type must be the id of a built-in type, 0 to 25")
        })?;
        if id == 0 {
            return Ok(Variant::Null);
        }
        let built_in_type = BuiltInType::from_id(id).ok_or_else(|| {
            Mismatch::new(type_node, "the type must be the id of a built-in type, 0 to 25")
        })?;
        match body {
            None => Ok(self.default_of(built_in_type)),
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
}
