//! Writing structures: with their type in its place, or bare where the receiver knows it.

use super::{
    DataEncoding,
    encode::{Encoder, write_name},
};
use crate::{
    json::{Limits, Tape, write},
    values::{
        BuiltInType, EnumType, ExpandedNodeId, ExtensionBody, ExtensionObject, NodeId, STRUCTURE,
        Scalar, Server, StructureField, StructureKind, StructureType, StructureValue, Variant,
    },
};

impl Encoder<'_> {
    /// Appends an extension object; a null one is `{}` in version 1.05 and `null` in 1.04.
    pub fn extension_object(&self, out: &mut Vec<u8>, object: &ExtensionObject) {
        if matches!(object.body, ExtensionBody::None) && object.type_id.node_id == NodeId::null() {
            return out.extend_from_slice(if self.encoding.is_105() { b"{}" } else { b"null" });
        }
        match self.encoding {
            DataEncoding::Reversible104 => self.extension_object_104(out, object),
            DataEncoding::NonReversible104 => self.body(out, object),
            DataEncoding::Compact105 | DataEncoding::Verbose105 => {
                self.extension_object_105(out, object)
            }
        }
    }

    fn extension_object_104(&self, out: &mut Vec<u8>, object: &ExtensionObject) {
        out.extend_from_slice(b"{\"TypeId\":");
        self.scalar(out, &Scalar::ExpandedNodeId(Box::new(object.type_id.clone())));
        match &object.body {
            ExtensionBody::None => {}
            ExtensionBody::Binary(_) => out.extend_from_slice(b",\"Encoding\":1,\"Body\":"),
            ExtensionBody::Xml(_) => out.extend_from_slice(b",\"Encoding\":2,\"Body\":"),
            ExtensionBody::Structure(_) | ExtensionBody::Json(_) => {
                out.extend_from_slice(b",\"Body\":")
            }
        }
        if !matches!(object.body, ExtensionBody::None) {
            self.body(out, object);
        }
        out.push(b'}');
    }

    fn extension_object_105(&self, out: &mut Vec<u8>, object: &ExtensionObject) {
        out.extend_from_slice(b"{\"UaTypeId\":");
        write::string(out, &object.type_id.to_string());
        match &object.body {
            ExtensionBody::None => {}
            ExtensionBody::Structure(structure) => {
                self.members(out, structure, self.described_by(object))
            }
            ExtensionBody::Json(text) => {
                match text.trim().strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) {
                    Some(members) if can_be_inlined(text) => {
                        if !members.trim().is_empty() {
                            out.push(b',');
                            out.extend_from_slice(members.as_bytes());
                        }
                    }
                    _ => {
                        out.extend_from_slice(b",\"UaBody\":");
                        out.extend_from_slice(text.as_bytes());
                    }
                }
            }
            ExtensionBody::Binary(_) => {
                out.extend_from_slice(b",\"UaEncoding\":1,\"UaBody\":");
                self.body(out, object);
            }
            ExtensionBody::Xml(_) => {
                out.extend_from_slice(b",\"UaEncoding\":2,\"UaBody\":");
                self.body(out, object);
            }
        }
        out.push(b'}');
    }

    fn described_by(&self, object: &ExtensionObject) -> Option<&StructureType> {
        StructureType::find(self.types, &object.type_id.node_id)
    }

    /// Appends the content without type id and encoding, as non-reversible JSON has it.
    fn body(&self, out: &mut Vec<u8>, object: &ExtensionObject) {
        match &object.body {
            ExtensionBody::None => out.extend_from_slice(b"null"),
            ExtensionBody::Json(text) => out.extend_from_slice(text.as_bytes()),
            ExtensionBody::Binary(bytes) => write::base64(out, bytes),
            ExtensionBody::Xml(text) => write::string(out, text),
            ExtensionBody::Structure(structure) => {
                self.structure(out, structure, self.described_by(object))
            }
        }
    }

    /// A structure without its type.
    fn structure(
        &self,
        out: &mut Vec<u8>,
        structure: &StructureValue,
        description: Option<&StructureType>,
    ) {
        let is_union = description.is_some_and(|found| found.kind == StructureKind::Union);
        if is_union && self.encoding == DataEncoding::NonReversible104 {
            return match structure.fields.first() {
                Some((name, value)) => self.field(out, value, field_of(description, name)),
                None => out.extend_from_slice(b"null"),
            };
        }
        out.push(b'{');
        self.members(out, structure, description);
        out.push(b'}');
    }

    fn members(
        &self,
        out: &mut Vec<u8>,
        structure: &StructureValue,
        description: Option<&StructureType>,
    ) {
        let kind = description.map_or(StructureKind::Plain, |found| found.kind);
        let says_presence =
            matches!(self.encoding, DataEncoding::Reversible104 | DataEncoding::Compact105);
        match kind {
            StructureKind::Union if says_presence => {
                write_name(out, "SwitchField");
                write::unsigned(out, u64::from(structure.switch_field.unwrap_or(0)));
                if self.encoding == DataEncoding::Reversible104
                    && let Some((name, value)) = structure.fields.first()
                {
                    write_name(out, "Value");
                    self.field(out, value, field_of(description, name));
                    return;
                }
            }
            StructureKind::WithOptionalFields if says_presence => {
                write_name(out, "EncodingMask");
                write::unsigned(out, u64::from(structure.encoding_mask.unwrap_or(0)));
            }
            _ => {}
        }
        for (name, value) in &structure.fields {
            if !self.writes_nulls() && is_null(value) {
                continue;
            }
            if out.last() != Some(&b'{') {
                out.push(b',');
            }
            write::string(out, name);
            out.push(b':');
            self.field(out, value, field_of(description, name));
        }
    }

    /// A field: bare, and a structure of a declared concrete type without naming it.
    fn field(&self, out: &mut Vec<u8>, value: &Variant, field: Option<&StructureField>) {
        let is_concrete = field.is_some_and(|field| {
            field.built_in_type == BuiltInType::ExtensionObject && field.data_type != STRUCTURE
        });
        if !is_concrete {
            return match field.and_then(|field| self.enum_type(field)) {
                Some(known) => self.enumeration(out, value, known),
                None => self.bare(out, value),
            };
        }
        match value {
            Variant::Scalar(Scalar::ExtensionObject(object)) => self.body(out, object),
            Variant::Array(array) => {
                out.push(b'[');
                for (index, element) in array.elements.iter().enumerate() {
                    if index > 0 {
                        out.push(b',');
                    }
                    match element {
                        Scalar::ExtensionObject(object) => self.body(out, object),
                        other => self.scalar(out, other),
                    }
                }
                out.push(b']');
            }
            other => self.bare(out, other),
        }
    }
}

impl Encoder<'_> {
    /// The enumeration of a field, where its values are written with their names.
    fn enum_type(&self, field: &StructureField) -> Option<&EnumType> {
        let is_for_people =
            matches!(self.encoding, DataEncoding::NonReversible104 | DataEncoding::Verbose105);
        let is_enumeration = is_for_people && field.built_in_type == BuiltInType::Int32;
        is_enumeration.then(|| EnumType::find(self.enum_types, &field.data_type)).flatten()
    }

    /// `"AUTOMATIC_3"` (OPC 10000-6 §5.4.4); the number alone where it has no name.
    fn enumeration(&self, out: &mut Vec<u8>, value: &Variant, known: &EnumType) {
        let element = |out: &mut Vec<u8>, scalar: &Scalar| match scalar {
            Scalar::Int32(number) => match known.name_of(i64::from(*number)) {
                Some(name) => write::string(out, &format!("{name}_{number}")),
                None => write::signed(out, i64::from(*number)),
            },
            other => self.scalar(out, other),
        };
        match value {
            Variant::Scalar(scalar) => element(out, scalar),
            Variant::Array(array) if array.dimensions.is_none() => {
                out.push(b'[');
                for (index, scalar) in array.elements.iter().enumerate() {
                    if index > 0 {
                        out.push(b',');
                    }
                    element(out, scalar);
                }
                out.push(b']');
            }
            other => self.bare(out, other),
        }
    }
}

fn field_of<'s>(description: Option<&'s StructureType>, name: &str) -> Option<&'s StructureField> {
    description?.fields.iter().find(|field| &*field.name == name)
}

fn is_null(value: &Variant) -> bool {
    match value {
        Variant::Null
        | Variant::Scalar(
            Scalar::String(None) | Scalar::ByteString(None) | Scalar::XmlElement(None),
        ) => true,
        Variant::Scalar(Scalar::Variant(inner)) => inner.is_null(),
        Variant::Scalar(Scalar::LocalizedText(text)) => {
            text.locale.is_none() && text.text.is_none()
        }
        Variant::Scalar(Scalar::QualifiedName(name)) => name.name.is_none(),
        Variant::Scalar(Scalar::ExtensionObject(object)) => {
            matches!(object.body, ExtensionBody::None)
                && object.type_id
                    == ExpandedNodeId { node_id: NodeId::null(), server: Server::Local }
        }
        _ => false,
    }
}

/// False for an object whose own members would be taken for ours.
fn can_be_inlined(text: &str) -> bool {
    let limits = Limits { bytes_max: usize::MAX, depth_max: 100, tokens_max: usize::MAX };
    Tape::read(text.as_bytes(), limits).is_ok_and(|tape| {
        !tape.root().members().any(|(name, _)| {
            ["UaTypeId", "UaEncoding", "UaBody"].iter().any(|own| name.is_text(own))
        })
    })
}
