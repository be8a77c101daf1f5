//! Scalars, arrays, variants and data values (OPC 10000-6 §5.1.2).

use std::sync::Arc;

use indexmap::IndexMap;
use uuid::Uuid;

use super::{BuiltInType, DateTime, ExpandedNodeId, NodeId, QualifiedName, StatusCode};

/// A single value of a built-in type. Texts and bytes are shared, so that a clone costs no copy;
/// `None` is the null string or null bytes, which differ from empty ones.
#[derive(Debug, Clone, PartialEq)]
pub enum Scalar {
    Boolean(bool),
    SByte(i8),
    Byte(u8),
    Int16(i16),
    UInt16(u16),
    Int32(i32),
    UInt32(u32),
    Int64(i64),
    UInt64(u64),
    Float(f32),
    Double(f64),
    String(Option<Arc<str>>),
    DateTime(DateTime),
    Guid(Uuid),
    ByteString(Option<Arc<[u8]>>),
    XmlElement(Option<Arc<str>>),
    NodeId(Box<NodeId>),
    ExpandedNodeId(Box<ExpandedNodeId>),
    StatusCode(StatusCode),
    QualifiedName(Box<QualifiedName>),
    LocalizedText(Box<LocalizedText>),
    ExtensionObject(Box<ExtensionObject>),
    DataValue(Box<DataValue>),
    /// Element of an array of variants.
    Variant(Box<Variant>),
    DiagnosticInfo(Box<DiagnosticInfo>),
}

impl Scalar {
    /// The built-in type of this value.
    #[must_use]
    pub const fn built_in_type(&self) -> BuiltInType {
        use BuiltInType as T;
        match self {
            Self::Boolean(_) => T::Boolean,
            Self::SByte(_) => T::SByte,
            Self::Byte(_) => T::Byte,
            Self::Int16(_) => T::Int16,
            Self::UInt16(_) => T::UInt16,
            Self::Int32(_) => T::Int32,
            Self::UInt32(_) => T::UInt32,
            Self::Int64(_) => T::Int64,
            Self::UInt64(_) => T::UInt64,
            Self::Float(_) => T::Float,
            Self::Double(_) => T::Double,
            Self::String(_) => T::String,
            Self::DateTime(_) => T::DateTime,
            Self::Guid(_) => T::Guid,
            Self::ByteString(_) => T::ByteString,
            Self::XmlElement(_) => T::XmlElement,
            Self::NodeId(_) => T::NodeId,
            Self::ExpandedNodeId(_) => T::ExpandedNodeId,
            Self::StatusCode(_) => T::StatusCode,
            Self::QualifiedName(_) => T::QualifiedName,
            Self::LocalizedText(_) => T::LocalizedText,
            Self::ExtensionObject(_) => T::ExtensionObject,
            Self::DataValue(_) => T::DataValue,
            Self::Variant(_) => T::Variant,
            Self::DiagnosticInfo(_) => T::DiagnosticInfo,
        }
    }

    /// The number as `f64`, for the numeric types and Boolean; 64-bit integers beyond 2^53 lose
    /// digits.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn as_f64(&self) -> Option<f64> {
        Some(match *self {
            Self::Boolean(v) => f64::from(u8::from(v)),
            Self::SByte(v) => v.into(),
            Self::Byte(v) => v.into(),
            Self::Int16(v) => v.into(),
            Self::UInt16(v) => v.into(),
            Self::Int32(v) => v.into(),
            Self::UInt32(v) => v.into(),
            Self::Int64(v) => v as f64,
            Self::UInt64(v) => v as f64,
            Self::Float(v) => v.into(),
            Self::Double(v) => v,
            _ => return None,
        })
    }

    /// The number as an exact integer, for the integer types and Boolean.
    #[must_use]
    pub fn as_i128(&self) -> Option<i128> {
        Some(match *self {
            Self::Boolean(v) => v.into(),
            Self::SByte(v) => v.into(),
            Self::Byte(v) => v.into(),
            Self::Int16(v) => v.into(),
            Self::UInt16(v) => v.into(),
            Self::Int32(v) => v.into(),
            Self::UInt32(v) => v.into(),
            Self::Int64(v) => v.into(),
            Self::UInt64(v) => v.into(),
            _ => return None,
        })
    }

    /// An integer as the wanted integer type; `None` where it does not fit or the type is not an
    /// integer one.
    #[must_use]
    pub fn from_i128(value: i128, wanted: BuiltInType) -> Option<Self> {
        use BuiltInType as T;
        Some(match wanted {
            T::SByte => Self::SByte(value.try_into().ok()?),
            T::Byte => Self::Byte(value.try_into().ok()?),
            T::Int16 => Self::Int16(value.try_into().ok()?),
            T::UInt16 => Self::UInt16(value.try_into().ok()?),
            T::Int32 => Self::Int32(value.try_into().ok()?),
            T::UInt32 => Self::UInt32(value.try_into().ok()?),
            T::Int64 => Self::Int64(value.try_into().ok()?),
            T::UInt64 => Self::UInt64(value.try_into().ok()?),
            _ => return None,
        })
    }

    /// The text of a non-null String.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        match self {
            Self::String(text) => text.as_deref(),
            _ => None,
        }
    }
}

/// A text with the language it is in.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct LocalizedText {
    /// The language as RFC 3066 (`en`, `de-DE`); `None` is null.
    pub locale: Option<Arc<str>>,
    /// The text; `None` is null.
    pub text: Option<Arc<str>>,
}

/// A structure with the NodeId of its type.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtensionObject {
    /// The DataType's NodeId (OPC 10000-14 §7.2.5 asks for the DataType, not an encoding node).
    pub type_id: ExpandedNodeId,
    pub body: ExtensionBody,
}

/// The content of an [`ExtensionObject`].
#[derive(Debug, Clone, PartialEq)]
pub enum ExtensionBody {
    /// No body at all.
    None,
    /// A structure whose fields are known by name and type.
    Structure(StructureValue),
    /// The JSON text of a structure without a known description, as it came.
    Json(Arc<str>),
    /// OPC UA Binary of a structure without a known description.
    Binary(Arc<[u8]>),
    /// XML of a structure without a known description.
    Xml(Arc<str>),
}

/// The fields of a structure in the order of its definition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StructureValue {
    /// Field name to value; an absent optional field is absent here.
    pub fields: IndexMap<Arc<str>, Variant>,
    /// 1-based index of a union's selected field (0: none).
    pub switch_field: Option<u32>,
    /// Encoding mask of a structure with optional fields.
    pub encoding_mask: Option<u32>,
}

/// Diagnostics beside a status (OPC 10000-4 §7.12); rarely seen, carried for completeness.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DiagnosticInfo {
    pub symbolic_id: Option<i32>,
    pub namespace_uri: Option<i32>,
    pub locale: Option<i32>,
    pub localized_text: Option<i32>,
    pub additional_info: Option<Arc<str>>,
    pub inner_status_code: Option<StatusCode>,
    pub inner_diagnostic_info: Option<Box<DiagnosticInfo>>,
}

/// An array of one built-in type, of one or more dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// The type of every element.
    pub element_type: BuiltInType,
    /// The elements, the last dimension varying fastest.
    pub elements: Vec<Scalar>,
    /// The lengths of a matrix' dimensions (two or more); `None` for a plain array. Their product
    /// is the number of elements.
    pub dimensions: Option<Vec<u32>>,
}

/// Any value: nothing, one scalar, or an array.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Variant {
    /// The null value, which has no type.
    #[default]
    Null,
    Scalar(Scalar),
    /// An array or matrix.
    Array(Arc<Array>),
}

impl Variant {
    /// The built-in type, unless there is no value.
    #[must_use]
    pub fn built_in_type(&self) -> Option<BuiltInType> {
        match self {
            Self::Null => None,
            Self::Scalar(scalar) => Some(scalar.built_in_type()),
            Self::Array(array) => Some(array.element_type),
        }
    }

    /// The scalar, if this is one.
    #[must_use]
    pub fn as_scalar(&self) -> Option<&Scalar> {
        match self {
            Self::Scalar(scalar) => Some(scalar),
            _ => None,
        }
    }

    /// The number, if this is a numeric scalar or Boolean.
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        self.as_scalar()?.as_f64()
    }

    /// The text, if this is a non-null String scalar.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        self.as_scalar()?.as_str()
    }

    /// True where there is no value.
    #[must_use]
    pub const fn is_null(&self) -> bool {
        matches!(self, Self::Null)
    }
}

/// A value with its quality and times (OPC 10000-4 §7.11). The three never travel apart.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataValue {
    /// The value; [`Variant::Null`] where there is none.
    pub value: Variant,
    /// The quality; Good where none is stated.
    pub status: StatusCode,
    /// Time at which the source measured the value.
    pub source_timestamp: Option<DateTime>,
    /// Further resolution of the source time, in units of 10 ps (0 to 9999).
    pub source_picoseconds: u16,
    /// Time at which the server last knew the value to be true.
    pub server_timestamp: Option<DateTime>,
    /// Further resolution of the server time, in units of 10 ps (0 to 9999).
    pub server_picoseconds: u16,
}

impl DataValue {
    /// A Good value measured at a time.
    #[must_use]
    pub fn good(value: impl Into<Variant>, source_timestamp: DateTime) -> Self {
        Self { value: value.into(), source_timestamp: Some(source_timestamp), ..Self::default() }
    }

    /// No value, only a status and the time since which it holds.
    #[must_use]
    pub fn status_only(status: StatusCode, source_timestamp: Option<DateTime>) -> Self {
        Self { status, source_timestamp, ..Self::default() }
    }
}

macro_rules! from_native {
    ($($native:ty => $variant:ident),* $(,)?) => {$(
        impl From<$native> for Scalar {
            fn from(value: $native) -> Self { Self::$variant(value) }
        }
        impl From<$native> for Variant {
            fn from(value: $native) -> Self { Self::Scalar(Scalar::$variant(value)) }
        }
    )*};
}

from_native! {
    bool => Boolean, i8 => SByte, u8 => Byte, i16 => Int16, u16 => UInt16, i32 => Int32,
    u32 => UInt32, i64 => Int64, u64 => UInt64, f32 => Float, f64 => Double, DateTime => DateTime,
    Uuid => Guid, StatusCode => StatusCode,
}

impl From<&str> for Scalar {
    fn from(text: &str) -> Self {
        Self::String(Some(Arc::from(text)))
    }
}

impl From<&str> for Variant {
    fn from(text: &str) -> Self {
        Self::Scalar(text.into())
    }
}

impl From<String> for Variant {
    fn from(text: String) -> Self {
        Self::Scalar(Scalar::String(Some(text.into())))
    }
}

impl From<Scalar> for Variant {
    fn from(scalar: Scalar) -> Self {
        Self::Scalar(scalar)
    }
}
