//! Reading arrays, matrices and bare values.

use std::{borrow::Cow, sync::Arc};

use super::{
    decode::{Decoder, TypeHint},
    diagnostics::GUESSED,
    mismatch::Mismatch,
};
use crate::{
    json::{JsonNode, Kind},
    values::{Array, BuiltInType, ExtensionBody, ExtensionObject, NodeId, Scalar, Variant},
};

impl Decoder<'_> {
    pub(super) fn elements<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        element_type: BuiltInType,
        structure: Option<&NodeId>,
    ) -> Result<Vec<Scalar>, Mismatch<'t, 'a>> {
        node.elements().map(|element| self.scalar(element, element_type, structure)).collect()
    }

    pub(super) fn array<'t, 'a>(
        &self,
        node: JsonNode<'t, 'a>,
        element_type: BuiltInType,
        elements: Vec<Scalar>,
        dimensions: Option<JsonNode<'t, 'a>>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        let lengths = match dimensions {
            None => Vec::new(),
            Some(list) if list.kind() == Kind::Array => list
                .elements()
                .map(|length| length.integer::<u32>())
                .collect::<Option<Vec<u32>>>()
                .ok_or_else(|| {
                    Mismatch::new(list, "dimensions must be numbers from 0 to 4294967295")
                })?,
            Some(other) => return Err(Mismatch::new(other, "dimensions must be an array")),
        };
        let product = lengths
            .iter()
            .try_fold(1_u64, |product, length| product.checked_mul(u64::from(*length)));
        if !lengths.is_empty() && product != Some(elements.len() as u64) {
            let message = Cow::from("the dimensions do not multiply to the number of elements");
            return Err(Mismatch::new(dimensions.unwrap_or(node), message));
        }
        let dimensions = (lengths.len() > 1).then_some(lengths);
        Ok(Variant::Array(Arc::new(Array { element_type, elements, dimensions })))
    }

    /// A matrix as arrays of arrays.
    pub(super) fn matrix<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        element_type: BuiltInType,
        structure: Option<&NodeId>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        let mut dimensions = Vec::new();
        let mut level = Some(node);
        while let Some(array) = level.filter(|node| node.kind() == Kind::Array) {
            dimensions.push(u32::try_from(array.elements().count()).unwrap_or(u32::MAX));
            level = array.elements().next();
        }
        let mut elements = Vec::new();
        self.flatten(node, &dimensions, element_type, structure, &mut elements)?;
        Ok(Variant::Array(Arc::new(Array { element_type, elements, dimensions: Some(dimensions) })))
    }

    fn flatten<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        dimensions: &[u32],
        element_type: BuiltInType,
        structure: Option<&NodeId>,
        elements: &mut Vec<Scalar>,
    ) -> Result<(), Mismatch<'t, 'a>> {
        let [length, inner @ ..] = dimensions else {
            elements.push(self.scalar(node, element_type, structure)?);
            return Ok(());
        };
        if node.kind() != Kind::Array || node.elements().count() != *length as usize {
            return Err(Mismatch::new(node, "the rows of a matrix must all have the same length"));
        }
        node.elements()
            .try_for_each(|element| self.flatten(element, inner, element_type, structure, elements))
    }

    pub(super) fn bare_or_guess<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        hint: Option<TypeHint<'_>>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        match hint {
            Some(hint) => self.bare(node, hint),
            None if node.is_null() => Ok(Variant::Null),
            None => {
                let guessed = self.guess(node)?;
                self.diagnostics.note(node, GUESSED);
                Ok(guessed)
            }
        }
    }

    /// A value whose type is known from metadata.
    pub(super) fn bare<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        hint: TypeHint<'_>,
    ) -> Result<Variant, Mismatch<'t, 'a>> {
        let structure = hint.structure();
        match node.kind() {
            Kind::Null => Ok(Variant::Null),
            _ if hint.built_in_type == BuiltInType::Variant && hint.value_rank < 0 => {
                self.variant(node).map(|value| Variant::Scalar(Scalar::Variant(Box::new(value))))
            }
            Kind::Array if hint.value_rank == -1 => {
                Err(Mismatch::new(node, "expected a single value, not an array"))
            }
            Kind::Array
                if node.elements().next().is_some_and(|first| first.kind() == Kind::Array) =>
            {
                self.matrix(node, hint.built_in_type, structure)
            }
            Kind::Array => {
                let elements = self.elements(node, hint.built_in_type, structure)?;
                self.array(node, hint.built_in_type, elements, None)
            }
            Kind::Object if hint.value_rank >= 0 => {
                match (node.get("Array"), node.get("Dimensions")) {
                    (Some(array), Some(dimensions)) if array.kind() == Kind::Array => {
                        let elements = self.elements(array, hint.built_in_type, structure)?;
                        self.array(array, hint.built_in_type, elements, Some(dimensions))
                    }
                    _ => Err(Mismatch::new(
                        node,
                        "expected an array, or an object with Array and Dimensions",
                    )),
                }
            }
            _ if hint.value_rank >= 0 => Err(Mismatch::new(node, "expected an array")),
            _ => self.scalar(node, hint.built_in_type, structure).map(Variant::Scalar),
        }
    }

    /// The likeliest value of a JSON value that nothing describes.
    fn guess<'t, 'a>(&self, node: JsonNode<'t, 'a>) -> Result<Variant, Mismatch<'t, 'a>> {
        Ok(match node.kind() {
            Kind::Null => Variant::Null,
            Kind::Array => {
                let guessed = node.elements().map(|element| self.guess(element));
                let elements = guessed.collect::<Result<Vec<Variant>, _>>()?;
                let first = elements.first().and_then(Variant::built_in_type);
                let is_uniform =
                    elements.iter().all(|e| e.as_scalar().is_some() && e.built_in_type() == first);
                let element_type =
                    if is_uniform { first } else { None }.unwrap_or(BuiltInType::Variant);
                let elements = elements
                    .into_iter()
                    .map(|element| match element {
                        Variant::Scalar(scalar) if element_type != BuiltInType::Variant => scalar,
                        other => Scalar::Variant(Box::new(other)),
                    })
                    .collect();
                Variant::Array(Arc::new(Array { element_type, elements, dimensions: None }))
            }
            Kind::Object => Variant::Scalar(Scalar::ExtensionObject(Box::new(ExtensionObject {
                type_id: NodeId::null().into(),
                body: ExtensionBody::Json(Arc::from(node.raw())),
            }))),
            Kind::False | Kind::True => node.boolean().unwrap_or_default().into(),
            Kind::String => Variant::Scalar(Scalar::String(node.text().map(Arc::from))),
            Kind::Number => match node.integer::<i64>() {
                Some(integer) => integer.into(),
                None => {
                    let value = node.raw().parse::<f64>().ok().filter(|value| value.is_finite());
                    value.map(Variant::from).ok_or_else(|| {
                        Mismatch::out_of_range(node, "the number is too large for the type")
                    })?
                }
            },
        })
    }
}
