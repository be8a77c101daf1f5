//! Reading structures: known, described and unknown ones.

use std::sync::Arc;

use super::{
    decode::Decoder,
    decode_scalar::{default_scalar, integer, text},
    mismatch::Mismatch,
};
use crate::{
    json::{JsonNode, Kind, push_separated},
    values::{
        BuiltInType, ExpandedNodeId, ExtensionBody, ExtensionObject, NodeId, Scalar, Server,
        StructureField, StructureKind, StructureType, StructureValue, Variant,
    },
};

/// Deepest level at which absent structures inside absent structures are filled with defaults.
const DEFAULT_DEPTH_MAX: usize = 4;

impl<'d> Decoder<'d> {
    /// An extension object in either form; without a type it has the declared one, if any.
    pub(super) fn extension_object<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        declared: Option<&NodeId>,
    ) -> Result<ExtensionObject, Mismatch<'t, 'a>> {
        if node.kind() == Kind::Object {
            if let Some(type_id) = node.get("UaTypeId") {
                return self.extension_object_105(node, type_id);
            }
            if let Some(type_id) =
                node.get("TypeId").filter(|_| self.is_envelope_104(node, declared))
            {
                return self.extension_object_104(node, type_id);
            }
            if declared.is_none() && node.members().next().is_none() {
                return Ok(ExtensionObject {
                    type_id: NodeId::null().into(),
                    body: ExtensionBody::None,
                });
            }
        }
        let type_id = declared.cloned().unwrap_or(NodeId::null());
        self.of_type(type_id.into(), Some(node))
    }

    /// A user's structure may have a field called TypeId; the envelope has nothing beside TypeId,
    /// Encoding and Body.
    fn is_envelope_104(&self, node: JsonNode<'_, '_>, declared: Option<&NodeId>) -> bool {
        let is_own_field = declared
            .and_then(|id| StructureType::find(self.types, id))
            .is_some_and(|known| known.fields.iter().any(|field| &*field.name == "TypeId"));
        !is_own_field
            && node
                .members()
                .all(|(name, _)| ["TypeId", "Encoding", "Body"].iter().any(|own| name.is_text(own)))
    }

    fn extension_object_104<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        type_node: JsonNode<'t, 'a>,
    ) -> Result<ExtensionObject, Mismatch<'t, 'a>> {
        let type_id = match type_node.kind() {
            Kind::Number => NodeId::ua(integer(type_node, "a NodeId")?).into(),
            _ => self.namespaces.expanded_node_id(type_node)?,
        };
        let encoding =
            node.get("Encoding").map(|encoding| integer(encoding, "0, 1 or 2")).transpose()?;
        self.encoded(node, type_id, encoding.unwrap_or(0), node.get("Body"))
    }

    fn extension_object_105<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        type_node: JsonNode<'t, 'a>,
    ) -> Result<ExtensionObject, Mismatch<'t, 'a>> {
        let type_id = self.namespaces.expanded_node_id(type_node)?;
        let encoding =
            node.get("UaEncoding").map(|encoding| integer(encoding, "0, 1 or 2")).transpose()?;
        if let Some(body) = node.get("UaBody") {
            return self.encoded(node, type_id, encoding.unwrap_or(0), Some(body));
        }
        if let Some(description) = StructureType::find(self.types, &type_id.node_id) {
            let structure = self.structure(node, description)?;
            let type_id =
                ExpandedNodeId { node_id: description.type_id.clone(), server: type_id.server };
            return Ok(ExtensionObject { type_id, body: ExtensionBody::Structure(structure) });
        }
        // The other members are the structure; they are stored as they came.
        let mut json = String::from("{");
        for (name, value) in node.members().filter(|(name, _)| !name.is_text("UaTypeId")) {
            push_separated(&mut json, name, value);
        }
        json.push('}');
        Ok(ExtensionObject { type_id, body: ExtensionBody::Json(json.into()) })
    }

    fn encoded<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        type_id: ExpandedNodeId,
        encoding: u8,
        body: Option<JsonNode<'t, 'a>>,
    ) -> Result<ExtensionObject, Mismatch<'t, 'a>> {
        let body = match (encoding, body) {
            (_, None) => ExtensionBody::None,
            (0, Some(body)) => return self.of_type(type_id, Some(body)),
            (1, Some(body)) => match self.scalar(body, BuiltInType::ByteString, None)? {
                Scalar::ByteString(Some(bytes)) => ExtensionBody::Binary(bytes),
                _ => ExtensionBody::None,
            },
            (2, Some(body)) => ExtensionBody::Xml(text(body)?.into()),
            _ => {
                return Err(Mismatch::new(
                    node,
                    "the encoding must be 0 (JSON), 1 (binary) or 2 (XML)",
                ));
            }
        };
        Ok(ExtensionObject { type_id, body })
    }

    /// A structure of a type: by its description, else opaque.
    fn of_type<'t, 'a>(
        &mut self,
        type_id: ExpandedNodeId,
        body: Option<JsonNode<'t, 'a>>,
    ) -> Result<ExtensionObject, Mismatch<'t, 'a>> {
        let Some(body) = body else {
            return Ok(ExtensionObject { type_id, body: ExtensionBody::None });
        };
        let body = match StructureType::find(self.types, &type_id.node_id) {
            None => ExtensionBody::Json(Arc::from(body.raw())),
            Some(description) => {
                let structure = self.structure(body, description)?;
                let type_id =
                    ExpandedNodeId { node_id: description.type_id.clone(), server: type_id.server };
                return Ok(ExtensionObject { type_id, body: ExtensionBody::Structure(structure) });
            }
        };
        Ok(ExtensionObject { type_id, body })
    }

    fn structure<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        description: &StructureType,
    ) -> Result<StructureValue, Mismatch<'t, 'a>> {
        if node.kind() != Kind::Object {
            return Err(Mismatch::new(node, format!("a {} must be an object", description.name)));
        }
        // Each field is looked up among the members.
        self.spend_fields(node, description.fields.len() * (1 + node.members().count() / 16))?;
        match description.kind {
            StructureKind::Union => self.union(node, description),
            kind => {
                let mut structure = StructureValue::default();
                let mut mask = 0_u32;
                let mut optional_bit = 0_u32;
                for field in &description.fields {
                    let value = self.member(node, description, &field.name)?;
                    if field.is_optional {
                        mask |= u32::from(value.is_some()) << optional_bit.min(31);
                        optional_bit += 1;
                    }
                    let value = match value {
                        Some(value) if !value.is_null() => self.bare(value, field.into())?,
                        _ if field.is_optional && value.is_none() => continue,
                        _ => self.default_field(field, 0),
                    };
                    structure.fields.insert(Arc::clone(&field.name), value);
                }
                structure.encoding_mask =
                    (kind == StructureKind::WithOptionalFields).then_some(mask);
                self.note_foreign_members(node, description)?;
                Ok(structure)
            }
        }
    }

    fn union<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        description: &StructureType,
    ) -> Result<StructureValue, Mismatch<'t, 'a>> {
        let switch = node
            .get("SwitchField")
            .map(|switch| integer::<u32>(switch, "the number of a field"))
            .transpose()?;
        let named = || {
            description.fields.iter().enumerate().find_map(|(index, field)| {
                node.get(&field.name).map(|value| (u32::try_from(index + 1).unwrap_or(0), value))
            })
        };
        let (switch, value) = match (switch, node.get("Value")) {
            (Some(switch), Some(value)) => (switch, Some(value)),
            (Some(switch), None) => (switch, named().map(|(_, value)| value)),
            (None, _) => named().map_or((0, None), |(switch, value)| (switch, Some(value))),
        };
        let mut structure =
            StructureValue { switch_field: Some(switch), ..StructureValue::default() };
        if switch == 0 {
            return Ok(structure);
        }
        let field = description.fields.get(switch as usize - 1).ok_or_else(|| {
            Mismatch::new(node, format!("{} has no field number {switch}", description.name))
        })?;
        let value = match value.filter(|value| !value.is_null()) {
            Some(value) => self.bare(value, field.into())?,
            None => self.default_field(field, 0),
        };
        structure.fields.insert(Arc::clone(&field.name), value);
        Ok(structure)
    }

    /// A member by its exact name; for structures of namespace 0 also in other letter case, which
    /// the figures of the DIGICOR paper show.
    fn member<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        description: &StructureType,
        name: &str,
    ) -> Result<Option<JsonNode<'t, 'a>>, Mismatch<'t, 'a>> {
        if let Some(value) = node.get(name) {
            return Ok(Some(value));
        }
        if description.type_id.namespace != crate::values::Namespace::Ua {
            return Ok(None);
        }
        let similar = node
            .members()
            .find(|(key, _)| key.text().is_some_and(|key| key.eq_ignore_ascii_case(name)));
        match similar {
            None => Ok(None),
            Some((key, value)) => {
                self.diagnostics.tolerate(
                    key,
                    "the field's name is written in other letter case than the standard's",
                )?;
                Ok(Some(value))
            }
        }
    }

    fn note_foreign_members<'t, 'a>(
        &mut self,
        node: JsonNode<'t, 'a>,
        description: &StructureType,
    ) -> Result<(), Mismatch<'t, 'a>> {
        for (key, _) in node.members() {
            let name = key.text().unwrap_or_default();
            let is_known =
                description.fields.iter().any(|field| field.name.eq_ignore_ascii_case(&name))
                    || matches!(&*name, "UaTypeId" | "EncodingMask");
            if !is_known {
                self.diagnostics.tolerate(key, "the structure has no such field; it is ignored")?;
            }
        }
        Ok(())
    }

    fn default_field(&mut self, field: &StructureField, depth: usize) -> Variant {
        if field.value_rank >= 0 {
            return Variant::Null;
        }
        let described = (field.built_in_type == BuiltInType::ExtensionObject
            && depth < DEFAULT_DEPTH_MAX)
            .then(|| StructureType::find(self.types, &field.data_type))
            .flatten();
        let Some(description) = described else {
            return Variant::Scalar(default_scalar(field.built_in_type));
        };
        // A default that the budget no longer allows stays null.
        if !self.can_spend_fields(description.fields.len()) {
            return Variant::Null;
        }
        let mut structure = StructureValue::default();
        match description.kind {
            StructureKind::Union => structure.switch_field = Some(0),
            StructureKind::WithOptionalFields => structure.encoding_mask = Some(0),
            StructureKind::Plain => {}
        }
        if description.kind != StructureKind::Union {
            for inner in description.fields.iter().filter(|inner| !inner.is_optional) {
                structure
                    .fields
                    .insert(Arc::clone(&inner.name), self.default_field(inner, depth + 1));
            }
        }
        Variant::Scalar(Scalar::ExtensionObject(Box::new(ExtensionObject {
            type_id: ExpandedNodeId { node_id: description.type_id.clone(), server: Server::Local },
            body: ExtensionBody::Structure(structure),
        })))
    }
}
