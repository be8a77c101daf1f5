//! Reading single values of the simple built-in types.

use std::sync::Arc;

use base64::Engine as _;
use uuid::Uuid;

use super::{Mismatch, decode::Decoder};
use crate::{
    json::{Kind, Node, write::parse_date_time},
    values::{
        BuiltInType, DataValue, DateTime, DiagnosticInfo, ExpandedNodeId, ExtensionBody,
        ExtensionObject, Identifier, LocalizedText, Namespace, NodeId, QualifiedName, Scalar,
        Server, StatusCode, Variant,
    },
};

impl Decoder<'_> {
    /// A single value of a type; `structure` is the DataType that a structure must have, where one
    /// is declared.
    pub(super) fn scalar<'t, 'a>(
        &mut self,
        node: Node<'t, 'a>,
        built_in_type: BuiltInType,
        structure: Option<&NodeId>,
    ) -> Result<Scalar, Mismatch<'t, 'a>> {
        use BuiltInType as T;
        if node.is_null() {
            return Ok(default_scalar(built_in_type));
        }
        Ok(match built_in_type {
            T::Boolean => Scalar::Boolean(self.boolean(node)?),
            T::SByte => Scalar::SByte(integer(node, "a number from -128 to 127")?),
            T::Byte => Scalar::Byte(integer(node, "a number from 0 to 255")?),
            T::Int16 => Scalar::Int16(integer(node, "a number from -32768 to 32767")?),
            T::UInt16 => Scalar::UInt16(integer(node, "a number from 0 to 65535")?),
            T::Int32 => Scalar::Int32(match named_value(node) {
                Some(value) => value,
                None => integer(node, "a number from -2147483648 to 2147483647")?,
            }),
            T::UInt32 => Scalar::UInt32(integer(node, "a number from 0 to 4294967295")?),
            T::Int64 => Scalar::Int64(self.integer_64(node, "an Int64 as a string of digits")?),
            T::UInt64 => Scalar::UInt64(self.integer_64(node, "a UInt64 as a string of digits")?),
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
            T::DateTime => Scalar::DateTime(self.date_time(node)?),
            T::Guid => Scalar::Guid(guid(node)?),
            T::ByteString => Scalar::ByteString(Some(bytes(node)?)),
            T::NodeId => Scalar::NodeId(Box::new(self.node_id(node)?)),
            T::ExpandedNodeId => Scalar::ExpandedNodeId(Box::new(self.expanded_node_id(node)?)),
            T::StatusCode => Scalar::StatusCode(self.status_code(node)?),
            T::QualifiedName => Scalar::QualifiedName(Box::new(self.qualified_name(node)?)),
            T::LocalizedText => Scalar::LocalizedText(Box::new(localized_text(node)?)),
            T::ExtensionObject => {
                Scalar::ExtensionObject(Box::new(self.extension_object(node, structure)?))
            }
            T::DataValue => Scalar::DataValue(Box::new(self.data_value(node)?)),
            T::Variant => Scalar::Variant(Box::new(self.variant(node)?)),
            T::DiagnosticInfo => Scalar::DiagnosticInfo(Box::new(self.diagnostic_info(node)?)),
        })
    }

    /// The value that an absent one stands for.
    pub(super) fn default_of(&self, built_in_type: BuiltInType) -> Variant {
        Variant::Scalar(default_scalar(built_in_type))
    }

    fn boolean<'t, 'a>(&mut self, node: Node<'t, 'a>) -> Result<bool, Mismatch<'t, 'a>> {
        const QUOTED: &str = "a Boolean must not stand in quotes";
        if let Some(value) = node.boolean() {
            return Ok(value);
        }
        for (text, value) in [("true", true), ("false", false)] {
            if node.is_text(text) {
                self.tolerate(node, QUOTED)?;
                return Ok(value);
            }
        }
        Err(Mismatch::new(node, "expected true or false"))
    }

    pub(crate) fn integer_64<'t, 'a, T: std::str::FromStr>(
        &mut self,
        node: Node<'t, 'a>,
        expected: &'static str,
    ) -> Result<T, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::String => {
                let text = node.text().unwrap_or_default();
                let digits = text.strip_prefix('-').unwrap_or(&text);
                let is_decimal = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
                match text.parse() {
                    Ok(value) if is_decimal => Ok(value),
                    _ if is_decimal => Err(Mismatch::out_of_range(
                        node,
                        format!("out of range: expected {expected}"),
                    )),
                    _ => Err(Mismatch::new(node, format!("expected {expected}"))),
                }
            }
            Kind::Number => {
                let value = integer(node, expected)?;
                self.tolerate(node, "a 64-bit integer must be a string")?;
                Ok(value)
            }
            _ => Err(Mismatch::new(node, format!("expected {expected}"))),
        }
    }

    pub(crate) fn date_time<'t, 'a>(
        &self,
        node: Node<'t, 'a>,
    ) -> Result<DateTime, Mismatch<'t, 'a>> {
        parse_date_time(&text(node)?)
            .ok_or_else(|| Mismatch::new(node, "expected a time as 2019-04-18T18:20:30Z"))
    }

    pub(crate) fn status_code<'t, 'a>(
        &self,
        node: Node<'t, 'a>,
    ) -> Result<StatusCode, Mismatch<'t, 'a>> {
        const EXPECTED: &str = "expected a status code: a number, or an object with Code";
        let code = match node.kind() {
            Kind::Number => Some(node),
            Kind::Object => node.get("Code"),
            Kind::Null => None,
            _ => return Err(Mismatch::new(node, EXPECTED)),
        };
        match code {
            None => Ok(StatusCode::GOOD),
            Some(code) => {
                code.integer().map(StatusCode).ok_or_else(|| Mismatch::new(code, EXPECTED))
            }
        }
    }

    pub(crate) fn node_id<'t, 'a>(&self, node: Node<'t, 'a>) -> Result<NodeId, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::String => {
                let id: NodeId = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a NodeId as nsu=urn:press;s=Counter")
                })?;
                Ok(NodeId { namespace: self.resolve(id.namespace), ..id })
            }
            Kind::Object => self.node_id_object(node),
            _ => Err(Mismatch::new(node, "expected a NodeId: a string or an object with Id")),
        }
    }

    fn node_id_object<'t, 'a>(&self, node: Node<'t, 'a>) -> Result<NodeId, Mismatch<'t, 'a>> {
        let id_type = match node.get("IdType") {
            None => 0,
            Some(kind) => kind.integer::<u8>().filter(|kind| *kind <= 3).ok_or_else(|| {
                Mismatch::new(
                    kind,
                    "IdType must be 0 (numeric), 1 (string), 2 (Guid) or 3 (opaque)",
                )
            })?,
        };
        let identifier = match (id_type, node.get("Id")) {
            (0, None) => Identifier::Numeric(0),
            (_, None) => return Err(Mismatch::new(node, "Id is missing")),
            (0, Some(id)) => Identifier::Numeric(integer(id, "a numeric Id from 0 to 4294967295")?),
            (1, Some(id)) => Identifier::String(text(id)?.into()),
            (2, Some(id)) => Identifier::Guid(guid(id)?),
            (_, Some(id)) => Identifier::Opaque(bytes(id)?),
        };
        Ok(NodeId { namespace: self.namespace(node.get("Namespace"))?, identifier })
    }

    /// A namespace as index or URI; absent it is namespace 0.
    fn namespace<'t, 'a>(&self, node: Option<Node<'t, 'a>>) -> Result<Namespace, Mismatch<'t, 'a>> {
        let Some(node) = node else { return Ok(Namespace::Ua) };
        match node.kind() {
            Kind::Null => Ok(Namespace::Ua),
            Kind::String => Ok(Namespace::uri(&text(node)?)),
            _ => match integer::<u16>(node, "a namespace as index or URI")? {
                0 => Ok(Namespace::Ua),
                index => Ok(self.resolve(Namespace::Index(index))),
            },
        }
    }

    /// The URI behind an index, where the table is known.
    fn resolve(&self, namespace: Namespace) -> Namespace {
        match namespace {
            Namespace::Index(index) => {
                match self.namespaces.get(usize::from(index).wrapping_sub(1)) {
                    Some(uri) => Namespace::uri(uri),
                    None => Namespace::Index(index),
                }
            }
            other => other,
        }
    }

    pub(super) fn expanded_node_id<'t, 'a>(
        &self,
        node: Node<'t, 'a>,
    ) -> Result<ExpandedNodeId, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::String => {
                let id: ExpandedNodeId = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a NodeId as nsu=urn:press;s=Counter")
                })?;
                let namespace = self.resolve(id.node_id.namespace);
                Ok(ExpandedNodeId { node_id: NodeId { namespace, ..id.node_id }, ..id })
            }
            Kind::Object => {
                let server = match node.get("ServerUri") {
                    None => Server::Local,
                    Some(server) if server.kind() == Kind::String => {
                        Server::Uri(text(server)?.into())
                    }
                    Some(server) => match integer(server, "a server as index or URI")? {
                        0 => Server::Local,
                        index => Server::Index(index),
                    },
                };
                Ok(ExpandedNodeId { node_id: self.node_id_object(node)?, server })
            }
            _ => Err(Mismatch::new(node, "expected a NodeId: a string or an object with Id")),
        }
    }

    pub(crate) fn qualified_name<'t, 'a>(
        &self,
        node: Node<'t, 'a>,
    ) -> Result<QualifiedName, Mismatch<'t, 'a>> {
        match node.kind() {
            Kind::Null => Ok(QualifiedName::default()),
            Kind::String => {
                let name: QualifiedName = text(node)?.parse().map_err(|_| {
                    Mismatch::new(node, "expected a qualified name as nsu=urn:press;Counter")
                })?;
                Ok(QualifiedName { namespace: self.resolve(name.namespace), ..name })
            }
            Kind::Object => {
                let name = node
                    .get("Name")
                    .filter(|name| !name.is_null())
                    .map(text)
                    .transpose()?
                    .map(Arc::from);
                Ok(QualifiedName { namespace: self.namespace(node.get("Uri"))?, name })
            }
            _ => Err(Mismatch::new(
                node,
                "expected a qualified name: a string or an object with Name",
            )),
        }
    }

    fn diagnostic_info<'t, 'a>(
        &self,
        node: Node<'t, 'a>,
    ) -> Result<DiagnosticInfo, Mismatch<'t, 'a>> {
        if node.kind() != Kind::Object {
            return Err(Mismatch::new(node, "a DiagnosticInfo must be an object"));
        }
        let number = |name: &str| {
            node.get(name)
                .map(|node| integer(node, "a number from -2147483648 to 2147483647"))
                .transpose()
        };
        Ok(DiagnosticInfo {
            symbolic_id: number("SymbolicId")?,
            namespace_uri: number("NamespaceUri")?,
            locale: number("Locale")?,
            localized_text: number("LocalizedText")?,
            additional_info: node.get("AdditionalInfo").map(text).transpose()?.map(Arc::from),
            inner_status_code: node
                .get("InnerStatusCode")
                .map(|inner| self.status_code(inner))
                .transpose()?,
            inner_diagnostic_info: node
                .get("InnerDiagnosticInfo")
                .map(|inner| self.diagnostic_info(inner).map(Box::new))
                .transpose()?,
        })
    }
}

/// The null or default value of a type.
pub(super) fn default_scalar(built_in_type: BuiltInType) -> Scalar {
    use BuiltInType as T;
    match built_in_type {
        T::Boolean => Scalar::Boolean(false),
        T::SByte => Scalar::SByte(0),
        T::Byte => Scalar::Byte(0),
        T::Int16 => Scalar::Int16(0),
        T::UInt16 => Scalar::UInt16(0),
        T::Int32 => Scalar::Int32(0),
        T::UInt32 => Scalar::UInt32(0),
        T::Int64 => Scalar::Int64(0),
        T::UInt64 => Scalar::UInt64(0),
        T::Float => Scalar::Float(0.0),
        T::Double => Scalar::Double(0.0),
        T::String => Scalar::String(None),
        T::DateTime => Scalar::DateTime(DateTime::MIN),
        T::Guid => Scalar::Guid(Uuid::nil()),
        T::ByteString => Scalar::ByteString(None),
        T::XmlElement => Scalar::XmlElement(None),
        T::NodeId => Scalar::NodeId(Box::new(NodeId::null())),
        T::ExpandedNodeId => Scalar::ExpandedNodeId(Box::new(NodeId::null().into())),
        T::StatusCode => Scalar::StatusCode(StatusCode::GOOD),
        T::QualifiedName => Scalar::QualifiedName(Box::default()),
        T::LocalizedText => Scalar::LocalizedText(Box::default()),
        T::ExtensionObject => Scalar::ExtensionObject(Box::new(ExtensionObject {
            type_id: NodeId::null().into(),
            body: ExtensionBody::None,
        })),
        T::DataValue => Scalar::DataValue(Box::<DataValue>::default()),
        T::Variant => Scalar::Variant(Box::<Variant>::default()),
        T::DiagnosticInfo => Scalar::DiagnosticInfo(Box::default()),
    }
}

/// A string's content.
pub(crate) fn text<'t, 'a>(
    node: Node<'t, 'a>,
) -> Result<std::borrow::Cow<'a, str>, Mismatch<'t, 'a>> {
    node.text().ok_or_else(|| Mismatch::new(node, "expected a string"))
}

/// A number without fraction and exponent.
pub(crate) fn integer<'t, 'a, T: std::str::FromStr>(
    node: Node<'t, 'a>,
    expected: &'static str,
) -> Result<T, Mismatch<'t, 'a>> {
    let digits =
        node.number().ok_or_else(|| Mismatch::new(node, format!("expected {expected}")))?;
    digits.parse().map_err(|_| {
        if digits.contains(['.', 'e', 'E']) {
            Mismatch::new(node, format!("expected {expected}, without fraction and exponent"))
        } else {
            Mismatch::out_of_range(node, format!("out of range: expected {expected}"))
        }
    })
}

/// The number of an enumeration's value as people read it: `"AUTOMATIC_3"`.
fn named_value(node: Node<'_, '_>) -> Option<i32> {
    let text = node.text()?;
    let (name, number) = text.rsplit_once('_')?;
    if name.is_empty() || number.starts_with('+') { None } else { number.parse().ok() }
}

fn float<'t, 'a, T>(
    node: Node<'t, 'a>,
    infinity: T,
    is_finite: fn(&T) -> bool,
    nan: T,
) -> Result<T, Mismatch<'t, 'a>>
where
    T: std::str::FromStr + std::ops::Neg<Output = T>,
{
    if let Some(digits) = node.number() {
        return digits
            .parse()
            .ok()
            .filter(is_finite)
            .ok_or_else(|| Mismatch::out_of_range(node, "the number is too large for the type"));
    }
    match node.text().as_deref() {
        Some("NaN") => Ok(nan),
        Some("Infinity") => Ok(infinity),
        Some("-Infinity") => Ok(-infinity),
        _ => Err(Mismatch::new(node, "expected a number, \"NaN\", \"Infinity\" or \"-Infinity\"")),
    }
}

pub(crate) fn guid<'t, 'a>(node: Node<'t, 'a>) -> Result<Uuid, Mismatch<'t, 'a>> {
    let text = text(node)?;
    // The parser also takes braces and other forms that are not the standard's.
    let guid = if text.len() == 36 { Uuid::try_parse(&text).ok() } else { None };
    guid.ok_or_else(|| {
        Mismatch::new(node, "expected a Guid as 72962b91-fa75-4ae6-8d28-b404dc7daf63")
    })
}

fn bytes<'t, 'a>(node: Node<'t, 'a>) -> Result<Arc<[u8]>, Mismatch<'t, 'a>> {
    base64::engine::general_purpose::STANDARD
        .decode(text(node)?.as_bytes())
        .map(Arc::from)
        .map_err(|_| Mismatch::new(node, "expected bytes in Base64"))
}

pub(crate) fn localized_text<'t, 'a>(
    node: Node<'t, 'a>,
) -> Result<LocalizedText, Mismatch<'t, 'a>> {
    let part = |name: &str| {
        node.get(name)
            .filter(|part| !part.is_null())
            .map(text)
            .transpose()
            .map(|part| part.map(Arc::from))
    };
    match node.kind() {
        Kind::Null => Ok(LocalizedText::default()),
        // 1.04 non-reversible keeps the text alone.
        Kind::String => Ok(LocalizedText { locale: None, text: Some(text(node)?.into()) }),
        Kind::Object => Ok(LocalizedText { locale: part("Locale")?, text: part("Text")? }),
        _ => Err(Mismatch::new(
            node,
            "expected a localized text: an object with Locale and Text, or a string",
        )),
    }
}
