//! Writing values.

use std::sync::Arc;

use crate::{
    json::write,
    values::{
        Array, DataValue, DiagnosticInfo, EnumType, Scalar, StatusCode, StructureType, Variant,
    },
};

/// The forms in which values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DataEncoding {
    /// 1.04 reversible: `{"Type": 9, "Body": "1"}`.
    Reversible104,
    /// 1.04 non-reversible: the bare value. Locales, types and switch fields are lost.
    NonReversible104,
    /// 1.05 compact: `{"UaType": 9, "Value": "1"}`.
    Compact105,
    /// 1.05 verbose: as compact, with symbols and defaults for people.
    Verbose105,
}

impl DataEncoding {
    /// One of the two forms of 1.05.
    #[must_use]
    pub const fn is_105(self) -> bool {
        matches!(self, Self::Compact105 | Self::Verbose105)
    }
}

/// Writes values in one encoding, straight into a buffer.
#[derive(Debug, Clone, Copy)]
pub struct Encoder<'e> {
    pub(super) encoding: DataEncoding,
    /// Namespaces that a 1.04 NodeId may name by index; the first is index 1. Others are written as
    /// URIs.
    pub(super) namespaces: &'e [Arc<str>],
    /// Descriptions of structures beside those of namespace 0.
    pub(super) types: &'e [StructureType],
    /// Descriptions of enumerations, whose values have names for people.
    pub(super) enum_types: &'e [EnumType],
}

impl Encoder<'static> {
    /// An encoder that writes namespaces as URIs.
    #[must_use]
    pub const fn new(encoding: DataEncoding) -> Self {
        Self { encoding, namespaces: &[], types: &[], enum_types: &[] }
    }
}

impl<'e> Encoder<'e> {
    /// An encoder with the namespaces and structures that the receiver knows from metadata.
    #[must_use]
    pub const fn described(
        encoding: DataEncoding,
        namespaces: &'e [Arc<str>],
        types: &'e [StructureType],
    ) -> Self {
        Self { encoding, namespaces, types, enum_types: &[] }
    }

    /// Takes the enumerations that the receiver knows from metadata: where forms for people are
    /// written, their values inside structures have their names.
    #[must_use]
    pub const fn with_enum_types(self, enum_types: &'e [EnumType]) -> Self {
        Self { enum_types, ..self }
    }

    /// A variant with its type (bare in 1.04 non-reversible).
    pub fn variant(&self, out: &mut Vec<u8>, value: &Variant) {
        match value {
            Variant::Null => out.extend_from_slice(b"null"),
            _ if self.encoding == DataEncoding::NonReversible104 => self.bare(out, value),
            _ => {
                out.push(b'{');
                self.typed_members(out, value);
                out.push(b'}');
            }
        }
    }

    /// A value without its type; a matrix in the form it has as a field.
    pub fn bare(&self, out: &mut Vec<u8>, value: &Variant) {
        match value {
            Variant::Null => out.extend_from_slice(b"null"),
            Variant::Scalar(scalar) => self.scalar(out, scalar),
            Variant::Array(array) => match &array.dimensions {
                None => self.elements(out, &array.elements),
                Some(dimensions) if self.encoding.is_105() => {
                    out.extend_from_slice(b"{\"Array\":");
                    self.elements(out, &array.elements);
                    write_dimensions(out, dimensions);
                    out.push(b'}');
                }
                Some(dimensions) => self.nested(out, &array.elements, dimensions),
            },
        }
    }

    /// A value with status and times.
    pub fn data_value(&self, out: &mut Vec<u8>, value: &DataValue) {
        out.push(b'{');
        if !value.value.is_null() {
            match self.encoding {
                DataEncoding::Reversible104 | DataEncoding::NonReversible104 => {
                    out.extend_from_slice(b"\"Value\":");
                    self.variant(out, &value.value);
                }
                DataEncoding::Compact105 | DataEncoding::Verbose105 => {
                    self.typed_members(out, &value.value)
                }
            }
        }
        self.quality_members(out, value);
        out.push(b'}');
    }

    /// Writes like [`Self::data_value`] in 1.05, without the type, which the receiver knows from
    /// metadata.
    pub fn data_value_without_type(&self, out: &mut Vec<u8>, value: &DataValue) {
        out.push(b'{');
        match &value.value {
            Variant::Null => {}
            Variant::Scalar(scalar) => {
                out.extend_from_slice(b"\"Value\":");
                self.scalar(out, scalar);
            }
            Variant::Array(array) => {
                out.extend_from_slice(b"\"Value\":");
                self.elements(out, &array.elements);
                if let Some(dimensions) = &array.dimensions {
                    write_dimensions(out, dimensions);
                }
            }
        }
        self.quality_members(out, value);
        out.push(b'}');
    }

    /// `"Type":n,"Body":…` or `"UaType":n,"Value":…`, of a value that is not null.
    fn typed_members(&self, out: &mut Vec<u8>, value: &Variant) {
        let Some(built_in_type) = value.built_in_type() else { return };
        let (type_name, value_name): (&[u8], &[u8]) = if self.encoding.is_105() {
            (b"\"UaType\":", b",\"Value\":")
        } else {
            (b"\"Type\":", b",\"Body\":")
        };
        out.extend_from_slice(type_name);
        write::unsigned(out, u64::from(built_in_type.id()));
        out.extend_from_slice(value_name);
        match value {
            Variant::Null => {}
            Variant::Scalar(scalar) => self.scalar(out, scalar),
            Variant::Array(array) => self.flat(out, array),
        }
    }

    fn flat(&self, out: &mut Vec<u8>, array: &Array) {
        self.elements(out, &array.elements);
        if let Some(dimensions) = &array.dimensions {
            write_dimensions(out, dimensions);
        }
    }

    fn elements(&self, out: &mut Vec<u8>, elements: &[Scalar]) {
        out.push(b'[');
        for (index, element) in elements.iter().enumerate() {
            if index > 0 {
                out.push(b',');
            }
            self.scalar(out, element);
        }
        out.push(b']');
    }

    /// A matrix as arrays of arrays, the first dimension outermost.
    fn nested(&self, out: &mut Vec<u8>, elements: &[Scalar], dimensions: &[u32]) {
        let [first, inner @ ..] = dimensions else { return self.elements(out, elements) };
        if inner.is_empty() || elements.is_empty() {
            return self.elements(out, elements);
        }
        out.push(b'[');
        let step = elements.len() / (*first as usize).max(1);
        for (index, part) in elements.chunks(step.max(1)).enumerate() {
            if index > 0 {
                out.push(b',');
            }
            self.nested(out, part, inner);
        }
        out.push(b']');
    }

    /// `Status` and times, each unless it is the default, with the commas they need.
    fn quality_members(&self, out: &mut Vec<u8>, value: &DataValue) {
        if value.status != StatusCode::GOOD {
            write_name(out, "Status");
            self.status_code(out, value.status);
        }
        let times = [
            (
                "SourceTimestamp",
                value.source_timestamp,
                "SourcePicoseconds",
                value.source_picoseconds,
            ),
            (
                "ServerTimestamp",
                value.server_timestamp,
                "ServerPicoseconds",
                value.server_picoseconds,
            ),
        ];
        for (time_name, time, picoseconds_name, picoseconds) in times {
            if let Some(time) = time {
                write_name(out, time_name);
                write::date_time(out, time);
            }
            if picoseconds != 0 {
                write_name(out, picoseconds_name);
                write::unsigned(out, u64::from(picoseconds));
            }
        }
    }

    /// The body of a single value.
    pub fn scalar(&self, out: &mut Vec<u8>, scalar: &Scalar) {
        match scalar {
            Scalar::Boolean(v) => out.extend_from_slice(if *v { b"true" } else { b"false" }),
            Scalar::SByte(v) => write::signed(out, i64::from(*v)),
            Scalar::Byte(v) => write::unsigned(out, u64::from(*v)),
            Scalar::Int16(v) => write::signed(out, i64::from(*v)),
            Scalar::UInt16(v) => write::unsigned(out, u64::from(*v)),
            Scalar::Int32(v) => write::signed(out, i64::from(*v)),
            Scalar::UInt32(v) => write::unsigned(out, u64::from(*v)),
            Scalar::Int64(v) => quoted(out, |out| write::signed(out, *v)),
            Scalar::UInt64(v) => quoted(out, |out| write::unsigned(out, *v)),
            Scalar::Float(v) => write::float(out, *v),
            Scalar::Double(v) => write::double(out, *v),
            Scalar::String(v) | Scalar::XmlElement(v) => write::nullable_string(out, v.as_deref()),
            Scalar::DateTime(v) => write::date_time(out, *v),
            Scalar::Guid(v) => quoted(out, |out| {
                let mut text = uuid::Uuid::encode_buffer();
                out.extend_from_slice(v.hyphenated().encode_lower(&mut text).as_bytes());
            }),
            Scalar::ByteString(None) => out.extend_from_slice(b"null"),
            Scalar::ByteString(Some(v)) => write::base64(out, v),
            Scalar::NodeId(v) => self.node_id(out, v),
            Scalar::ExpandedNodeId(v) => self.expanded_node_id(out, v),
            Scalar::StatusCode(v) => self.status_code(out, *v),
            Scalar::QualifiedName(v) => self.qualified_name(out, v),
            Scalar::LocalizedText(v) => self.localized_text(out, v),
            Scalar::ExtensionObject(v) => self.extension_object(out, v),
            Scalar::DataValue(v) => self.data_value(out, v),
            Scalar::Variant(v) => self.variant(out, v),
            Scalar::DiagnosticInfo(v) => self.diagnostic_info(out, v),
        }
    }

    /// A status code: a number in 1.04 reversible, else an object, empty for Good.
    pub fn status_code(&self, out: &mut Vec<u8>, status: StatusCode) {
        if self.encoding == DataEncoding::Reversible104 {
            return write::unsigned(out, u64::from(status.0));
        }
        out.push(b'{');
        if status != StatusCode::GOOD {
            out.extend_from_slice(b"\"Code\":");
            write::unsigned(out, u64::from(status.0));
            if self.encoding != DataEncoding::Compact105
                && let Some(symbol) = status.symbol()
            {
                write_name(out, "Symbol");
                write::string(out, symbol);
            }
        }
        out.push(b'}');
    }

    fn diagnostic_info(&self, out: &mut Vec<u8>, info: &DiagnosticInfo) {
        out.push(b'{');
        let numbers = [
            ("SymbolicId", info.symbolic_id),
            ("NamespaceUri", info.namespace_uri),
            ("Locale", info.locale),
            ("LocalizedText", info.localized_text),
        ];
        for (name, number) in numbers {
            if let Some(number) = number {
                write_name(out, name);
                write::signed(out, i64::from(number));
            }
        }
        if let Some(text) = &info.additional_info {
            write_name(out, "AdditionalInfo");
            write::string(out, text);
        }
        if let Some(status) = info.inner_status_code {
            write_name(out, "InnerStatusCode");
            self.status_code(out, status);
        }
        if let Some(inner) = &info.inner_diagnostic_info {
            write_name(out, "InnerDiagnosticInfo");
            self.diagnostic_info(out, inner);
        }
        out.push(b'}');
    }

    /// True where members with default or null values are written all the same.
    pub(super) const fn writes_nulls(&self) -> bool {
        matches!(self.encoding, DataEncoding::NonReversible104 | DataEncoding::Verbose105)
    }
}

fn quoted(out: &mut Vec<u8>, write: impl FnOnce(&mut Vec<u8>)) {
    out.push(b'"');
    write(out);
    out.push(b'"');
}

fn write_dimensions(out: &mut Vec<u8>, dimensions: &[u32]) {
    out.extend_from_slice(b",\"Dimensions\":[");
    for (index, length) in dimensions.iter().enumerate() {
        if index > 0 {
            out.push(b',');
        }
        write::unsigned(out, u64::from(*length));
    }
    out.push(b']');
}

/// A member's name, after a comma unless the object was just opened.
pub(crate) fn write_name(out: &mut Vec<u8>, name: &str) {
    if out.last() != Some(&b'{') {
        out.push(b',');
    }
    out.push(b'"');
    out.extend_from_slice(name.as_bytes());
    out.extend_from_slice(b"\":");
}
