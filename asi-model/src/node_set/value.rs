//! Values in NodeSet2: the XML encoding (OPC 10000-6 §5.3) of what nodes of our models hold.

use std::sync::Arc;

use base64::Engine as _;

use super::{
    names::Names,
    namespaces::{Namespaces, scalars},
    xml::{Element, escape},
};
use crate::values::{
    Array, BuiltInType, ExtensionBody, ExtensionObject, LocalizedText, Namespace, QualifiedName,
    Scalar, StatusCode, StructureType, StructureValue, Variant,
};

/// True for what this form carries: no matrices, no values inside values, no structures but those
/// of namespace 0, and no null texts, which would come back as empty ones.
pub(super) fn is_writable(value: &Variant) -> bool {
    let is_matrix = matches!(value, Variant::Array(array) if array.dimensions.is_some());
    let can_be = |scalar: &Scalar| match scalar {
        Scalar::DataValue(_) | Scalar::Variant(_) | Scalar::DiagnosticInfo(_) => false,
        Scalar::String(None) | Scalar::XmlElement(None) | Scalar::ByteString(None) => false,
        Scalar::ExtensionObject(object) => match &object.body {
            ExtensionBody::Structure(structure) => {
                StructureType::find(&[], &object.type_id.node_id).is_some()
                    && structure.fields.values().all(|field| field.is_null() || is_writable(field))
            }
            _ => false,
        },
        _ => true,
    };
    !value.is_null() && !is_matrix && scalars(value).iter().all(can_be)
}

/// The content of `<Value>`.
pub(super) fn write(out: &mut String, value: &Variant, namespaces: &Namespaces) {
    match value {
        Variant::Null => {}
        Variant::Scalar(scalar) => {
            element(out, "uax:", scalar.built_in_type().name(), |out| {
                body(out, scalar, "uax:", namespaces)
            });
        }
        Variant::Array(array) => {
            let name = array.element_type.name();
            element(out, "uax:", &format!("ListOf{name}"), |out| {
                for scalar in &array.elements {
                    element(out, "uax:", name, |out| body(out, scalar, "uax:", namespaces));
                }
            });
        }
    }
}

fn element(out: &mut String, prefix: &str, name: &str, content: impl FnOnce(&mut String)) {
    out.push_str(&format!("<{prefix}{name}>"));
    content(out);
    out.push_str(&format!("</{prefix}{name}>"));
}

fn text(out: &mut String, prefix: &str, name: &str, text: &str) {
    element(out, prefix, name, |out| out.push_str(&escape(text)));
}

fn body(out: &mut String, scalar: &Scalar, prefix: &str, namespaces: &Namespaces) {
    match scalar {
        Scalar::String(value) | Scalar::XmlElement(value) => {
            out.push_str(&escape(value.as_deref().unwrap_or_default()))
        }
        Scalar::ByteString(value) => {
            out.push_str(
                &base64::engine::general_purpose::STANDARD
                    .encode(value.as_deref().unwrap_or_default()),
            );
        }
        Scalar::Float(value) => {
            out.push_str(&special(f64::from(*value)).unwrap_or_else(|| value.to_string()))
        }
        Scalar::Double(value) => {
            out.push_str(&special(*value).unwrap_or_else(|| value.to_string()))
        }
        Scalar::DateTime(value) => out.push_str(&value.to_string()),
        Scalar::Guid(value) => text(out, prefix, "String", &value.hyphenated().to_string()),
        Scalar::NodeId(value) => text(out, prefix, "Identifier", &namespaces.node_id(value)),
        Scalar::ExpandedNodeId(value) => {
            text(out, prefix, "Identifier", &namespaces.node_id(&value.node_id))
        }
        Scalar::StatusCode(value) => text(out, prefix, "Code", &value.0.to_string()),
        Scalar::LocalizedText(value) => {
            if let Some(locale) = &value.locale {
                text(out, prefix, "Locale", locale);
            }
            if let Some(content) = &value.text {
                text(out, prefix, "Text", content);
            }
        }
        Scalar::QualifiedName(value) => {
            let index = namespaces.index(&value.namespace);
            if index != 0 {
                text(out, prefix, "NamespaceIndex", &index.to_string());
            }
            if let Some(name) = &value.name {
                text(out, prefix, "Name", name);
            }
        }
        Scalar::ExtensionObject(object) => structure(out, object, prefix, namespaces),
        Scalar::Boolean(value) => out.push_str(if *value { "true" } else { "false" }),
        integer => out.push_str(&integer.as_i128().unwrap_or_default().to_string()),
    }
}

/// XML Schema writes the special numbers so.
fn special(value: f64) -> Option<String> {
    let name = match value {
        value if value.is_nan() => "NaN",
        f64::INFINITY => "INF",
        f64::NEG_INFINITY => "-INF",
        _ => return None,
    };
    Some(name.to_owned())
}

fn structure(out: &mut String, object: &ExtensionObject, prefix: &str, namespaces: &Namespaces) {
    let (Some(known), ExtensionBody::Structure(value)) =
        (StructureType::find(&[], &object.type_id.node_id), &object.body)
    else {
        return;
    };
    let xml_encoding = known.encoding_ids.first().unwrap_or(&known.type_id);
    element(out, prefix, "TypeId", |out| {
        text(out, prefix, "Identifier", &namespaces.node_id(xml_encoding))
    });
    element(out, prefix, "Body", |out| {
        element(out, prefix, &known.name, |out| members(out, value, prefix, namespaces))
    });
}

fn members(out: &mut String, value: &StructureValue, prefix: &str, namespaces: &Namespaces) {
    for (name, field) in &value.fields {
        match field {
            Variant::Null => {}
            Variant::Scalar(scalar) => {
                element(out, prefix, name, |out| body(out, scalar, prefix, namespaces))
            }
            Variant::Array(array) => element(out, prefix, name, |out| {
                for scalar in &array.elements {
                    element(out, prefix, array.element_type.name(), |out| {
                        body(out, scalar, prefix, namespaces)
                    });
                }
            }),
        }
    }
}

/// Reads the content of `<Value>`; what our models do not use yields `None`.
pub(super) fn read(value: &Element, names: &Names) -> Option<Variant> {
    let content = value.children.first()?;
    if let Some(element_name) = content.name.strip_prefix("ListOf") {
        let element_type: BuiltInType = element_name.parse().ok()?;
        let elements: Option<Vec<Scalar>> =
            content.children.iter().map(|child| read_scalar(child, element_type, names)).collect();
        return Some(Variant::Array(Arc::new(Array {
            element_type,
            elements: elements?,
            dimensions: None,
        })));
    }
    read_scalar(content, content.name.parse().ok()?, names).map(Variant::Scalar)
}

fn read_scalar(element: &Element, built_in_type: BuiltInType, names: &Names) -> Option<Scalar> {
    use BuiltInType as T;
    let content = || Arc::<str>::from(element.text.as_str());
    let trimmed = element.trimmed();
    let float = |text: &str| match text {
        "INF" => Some(f64::INFINITY),
        "-INF" => Some(f64::NEG_INFINITY),
        text => text.parse::<f64>().ok(),
    };
    Some(match built_in_type {
        T::Boolean => Scalar::Boolean(matches!(trimmed, "true" | "1")),
        T::String => Scalar::String(Some(content())),
        T::XmlElement => Scalar::XmlElement(Some(content())),
        T::DateTime => Scalar::DateTime(read_time(trimmed)?),
        T::Guid => Scalar::Guid(element.child("String")?.trimmed().parse().ok()?),
        T::ByteString => {
            let compact: String = trimmed.split_ascii_whitespace().collect();
            Scalar::ByteString(Some(
                base64::engine::general_purpose::STANDARD.decode(compact).ok()?.into(),
            ))
        }
        #[allow(clippy::cast_possible_truncation)]
        // A Float was written with the digits of a Float.
        T::Float => Scalar::Float(float(trimmed)? as f32),
        T::Double => Scalar::Double(float(trimmed)?),
        T::NodeId => {
            Scalar::NodeId(Box::new(names.node_id(element.child("Identifier")?.trimmed())?))
        }
        T::ExpandedNodeId => Scalar::ExpandedNodeId(Box::new(
            names.node_id(element.child("Identifier")?.trimmed())?.into(),
        )),
        T::StatusCode => {
            Scalar::StatusCode(StatusCode(element.child("Code")?.trimmed().parse().ok()?))
        }
        T::LocalizedText => {
            let part = |name: &str| element.child(name).map(|part| Arc::from(part.text.as_str()));
            Scalar::LocalizedText(Box::new(LocalizedText {
                locale: part("Locale"),
                text: part("Text"),
            }))
        }
        T::QualifiedName => {
            let index = element
                .child("NamespaceIndex")
                .map_or(Some(0), |index| index.trimmed().parse().ok())?;
            Scalar::QualifiedName(Box::new(QualifiedName {
                namespace: names.namespace(Namespace::Index(index))?,
                name: element.child("Name").map(|name| Arc::from(name.text.as_str())),
            }))
        }
        T::ExtensionObject => Scalar::ExtensionObject(Box::new(read_structure(element, names)?)),
        T::DataValue | T::Variant | T::DiagnosticInfo => return None,
        integer => Scalar::from_i128(trimmed.parse().ok()?, integer)?,
    })
}

/// A time as XML Schema allows it: without a zone, UTC is meant.
pub(super) fn read_time(text: &str) -> Option<crate::values::DateTime> {
    text.parse().ok().or_else(|| format!("{text}Z").parse().ok())
}

fn read_structure(element: &Element, names: &Names) -> Option<ExtensionObject> {
    let type_id = names.node_id(element.child("TypeId")?.child("Identifier")?.trimmed())?;
    let known = StructureType::find(&[], &type_id)?;
    let content = element.child("Body")?.children.first()?;
    let mut structure = StructureValue::default();
    for field in &known.fields {
        let value = match content.child(&field.name) {
            None => Variant::Null,
            Some(child) if field.value_rank >= 0 => {
                let elements: Option<Vec<Scalar>> = child
                    .children
                    .iter()
                    .map(|entry| read_scalar(entry, field.built_in_type, names))
                    .collect();
                let array = Array {
                    element_type: field.built_in_type,
                    elements: elements?,
                    dimensions: None,
                };
                if array.elements.is_empty() {
                    Variant::Null
                } else {
                    Variant::Array(Arc::new(array))
                }
            }
            Some(child) => Variant::Scalar(read_scalar(child, field.built_in_type, names)?),
        };
        structure.fields.insert(Arc::clone(&field.name), value);
    }
    Some(ExtensionObject {
        type_id: known.type_id.clone().into(),
        body: ExtensionBody::Structure(structure),
    })
}
