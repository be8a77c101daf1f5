//! PubSub messages as JSON (OPC 10000-14 §7.2.5), in three encodings out and every header layout
//! in.

mod decode;
mod decode_members;
mod decode_message;
mod decode_meta_data;
mod encode;

pub use decode::{Decoded, PubSubError, decode, decode_described};
pub use encode::{
    NetworkMessageHeader, encode, encode_data_set_message, encode_described, encode_message,
    encode_meta_data,
};

use std::{fmt, str::FromStr};

use crate::opcua_json::DataEncoding;

/// The encodings that a connector may be set to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Encoding {
    /// 1.04 reversible, as the DIGICOR paper shows it.
    #[default]
    Digicor,
    /// 1.05 Compact: types as ids, default values left out.
    Compact105,
    /// 1.05 Verbose: bare values, with their types in metadata only.
    Verbose105,
}

impl Encoding {
    /// All encodings.
    pub const ALL: [Self; 3] = [Self::Digicor, Self::Compact105, Self::Verbose105];

    /// The name in configurations: `digicor`, `1.05-compact` or `1.05-verbose`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Digicor => "digicor",
            Self::Compact105 => "1.05-compact",
            Self::Verbose105 => "1.05-verbose",
        }
    }

    /// Returns the form of values.
    #[must_use]
    pub const fn data_encoding(self) -> DataEncoding {
        match self {
            Self::Digicor => DataEncoding::Reversible104,
            Self::Compact105 => DataEncoding::Compact105,
            Self::Verbose105 => DataEncoding::Verbose105,
        }
    }

    /// Returns the form of metadata: 1.04 reversible or, for both forms of 1.05, compact.
    #[must_use]
    pub const fn meta_data_encoding(self) -> DataEncoding {
        match self {
            Self::Digicor => DataEncoding::Reversible104,
            Self::Compact105 | Self::Verbose105 => DataEncoding::Compact105,
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text names no encoding.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("an encoding must be digicor, 1.05-compact or 1.05-verbose, but is {found:?}")]
pub struct UnknownEncoding {
    /// The text, cut after 40 characters.
    pub found: String,
}

impl FromStr for Encoding {
    type Err = UnknownEncoding;
    fn from_str(name: &str) -> Result<Self, UnknownEncoding> {
        Self::ALL
            .into_iter()
            .find(|encoding| encoding.name() == name)
            .ok_or_else(|| UnknownEncoding { found: name.chars().take(40).collect() })
    }
}

impl serde::Serialize for Encoding {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> serde::Deserialize<'de> for Encoding {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        std::borrow::Cow::<'de, str>::deserialize(deserializer)?
            .parse()
            .map_err(serde::de::Error::custom)
    }
}

impl schemars::JsonSchema for Encoding {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Encoding".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string", "enum": Self::ALL.map(Self::name) })
    }
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
