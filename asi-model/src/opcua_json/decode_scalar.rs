//! Reading single values of the simple built-in types.

use std::sync::Arc;

use base64::Engine as _;
use uuid::Uuid;

use super::{diagnostics::Diagnostics, mismatch::Mismatch};
use crate::{
    json::{JsonNode, Kind, write::parse_date_time},
    values::{
        BuiltInType, DataValue, DateTime, DiagnosticInfo, ExtensionBody, ExtensionObject,
        LocalizedText, NodeId, Scalar, StatusCode, Variant,
    },
};

pub(super) fn boolean<'t, 'a>(
    node: JsonNode<'t, 'a>,
    diagnostics: &mut Diagnostics,
) -> Result<bool, Mismatch<'t, 'a>> {
    const QUOTED: &str = "a Boolean must not stand in quotes";
    if let Some(value) = node.boolean() {
        return Ok(value);
    }
    for (text, value) in [("true", true), ("false", false)] {
        if node.is_text(text) {
            diagnostics.tolerate(node, QUOTED)?;
            return Ok(value);
        }
    }
    Err(Mismatch::new(node, "expected true or false"))
}

pub(crate) fn integer_64<'t, 'a, T: std::str::FromStr>(
    node: JsonNode<'t, 'a>,
    expected: &'static str,
    diagnostics: &mut Diagnostics,
) -> Result<T, Mismatch<'t, 'a>> {
    match node.kind() {
        Kind::String => {
            let text = node.text().unwrap_or_default();
            let digits = text.strip_prefix('-').unwrap_or(&text);
            let is_decimal = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
            match text.parse() {
                Ok(value) if is_decimal => Ok(value),
                _ if is_decimal => {
                    Err(Mismatch::out_of_range(node, format!("out of range: expected {expected}")))
                }
                _ => Err(Mismatch::new(node, format!("expected {expected}"))),
            }
        }
        Kind::Number => {
            let value = integer(node, expected)?;
            diagnostics.tolerate(node, "a 64-bit integer must be a string")?;
            Ok(value)
        }
        _ => Err(Mismatch::new(node, format!("expected {expected}"))),
    }
}

pub(crate) fn date_time<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<DateTime, Mismatch<'t, 'a>> {
    parse_date_time(&text(node)?)
        .ok_or_else(|| Mismatch::new(node, "expected a time as 2019-04-18T18:20:30Z"))
}

/// A time of a value, with a note where it is not quite what the text says.
pub(super) fn noted_time<'t, 'a>(
    node: JsonNode<'t, 'a>,
    diagnostics: &mut Diagnostics,
) -> Result<DateTime, Mismatch<'t, 'a>> {
    let time = date_time(node)?;
    let text = text(node)?;
    let clock = text.get(10..).unwrap_or_default();
    if !clock.starts_with('T') {
        diagnostics.tolerate(node, "a T must stand between date and time")?;
    }
    if clock.get(6..).is_some_and(|second| second.starts_with(":60")) {
        diagnostics.note(node, "the leap second is read as the end of the second before");
    }
    let is_early = text.get(..4).is_some_and(|year| year < "1601");
    if is_early && !text.starts_with("0001-01-01T00:00:00") {
        diagnostics.note(node, "a time before 1601 is read as no time");
    }
    Ok(time)
}

pub(crate) fn status_code<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<StatusCode, Mismatch<'t, 'a>> {
    const EXPECTED: &str = "expected a status code: a number, or an object with Code";
    let code = match node.kind() {
        Kind::Number => Some(node),
        Kind::Object => match (node.get("Code"), node.get("Symbol").and_then(JsonNode::text)) {
            // A name without its code is not Good by that.
            (None, Some(symbol)) => {
                return StatusCode::from_symbol(&symbol)
                    .ok_or_else(|| Mismatch::new(node, EXPECTED));
            }
            (code, _) => code,
        },
        Kind::Null => None,
        _ => return Err(Mismatch::new(node, EXPECTED)),
    };
    match code {
        None => Ok(StatusCode::GOOD),
        Some(code) => code.integer().map(StatusCode).ok_or_else(|| Mismatch::new(code, EXPECTED)),
    }
}

/// The status of a data value in other spellings of foreign stacks: the member called `StatusCode`,
/// as node-opcua and older OPC Publishers write it, or a symbolic name alone.
pub(super) fn foreign_status<'t, 'a>(
    node: JsonNode<'t, 'a>,
    diagnostics: &mut Diagnostics,
) -> Result<StatusCode, Mismatch<'t, 'a>> {
    diagnostics.tolerate(node, "the status of a DataValue is called Status")?;
    named_status(node, diagnostics)
}

/// The status of a data value, also as a symbolic name alone.
pub(super) fn named_status<'t, 'a>(
    node: JsonNode<'t, 'a>,
    diagnostics: &mut Diagnostics,
) -> Result<StatusCode, Mismatch<'t, 'a>> {
    match node.text().and_then(|symbol| StatusCode::from_symbol(&symbol)) {
        Some(status) => {
            diagnostics.tolerate(node, "a status code must be a number or an object with Code")?;
            Ok(status)
        }
        None => status_code(node),
    }
}

pub(super) fn diagnostic_info<'t, 'a>(
    node: JsonNode<'t, 'a>,
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
        inner_status_code: node.get("InnerStatusCode").map(status_code).transpose()?,
        inner_diagnostic_info: node
            .get("InnerDiagnosticInfo")
            .map(|inner| diagnostic_info(inner).map(Box::new))
            .transpose()?,
    })
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

pub(crate) fn text<'t, 'a>(
    node: JsonNode<'t, 'a>,
) -> Result<std::borrow::Cow<'a, str>, Mismatch<'t, 'a>> {
    node.text().ok_or_else(|| Mismatch::new(node, "expected a string"))
}

/// A number without fraction and exponent.
pub(crate) fn integer<'t, 'a, T: std::str::FromStr>(
    node: JsonNode<'t, 'a>,
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
pub(crate) fn named_value(node: JsonNode<'_, '_>) -> Option<i32> {
    let text = node.text()?;
    let (name, number) = text.rsplit_once('_')?;
    if name.is_empty() || number.starts_with('+') { None } else { number.parse().ok() }
}

pub(super) fn float<'t, 'a, T>(
    node: JsonNode<'t, 'a>,
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

pub(crate) fn guid<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<Uuid, Mismatch<'t, 'a>> {
    let text = text(node)?;
    // The parser also takes braces and other forms that are not the standard's.
    let guid = if text.len() == 36 { Uuid::try_parse(&text).ok() } else { None };
    guid.ok_or_else(|| {
        Mismatch::new(node, "expected a Guid as 72962b91-fa75-4ae6-8d28-b404dc7daf63")
    })
}

pub(super) fn bytes<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<Arc<[u8]>, Mismatch<'t, 'a>> {
    base64::engine::general_purpose::STANDARD
        .decode(text(node)?.as_bytes())
        .map(Arc::from)
        .map_err(|_| Mismatch::new(node, "expected bytes in Base64"))
}

pub(crate) fn localized_text<'t, 'a>(
    node: JsonNode<'t, 'a>,
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
