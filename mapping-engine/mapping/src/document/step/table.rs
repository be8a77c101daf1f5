//! Steps that give values and bits a meaning by a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::document::Literal;

/// Conversion of values to values by a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Lookup {
    /// The table. Numbers match by value whatever their types, texts exactly.
    #[schema(max_items = 1024)]
    pub entries: Vec<LookupEntry>,
    /// Value yielded for a value that is not in the table; a fault where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub otherwise: Option<Literal>,
    /// Between two numeric entries, interpolate linearly; outside, the nearest entry.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub interpolate: bool,
}

/// One line of a lookup table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct LookupEntry {
    /// The value that comes in.
    pub from: Literal,
    /// The value that goes out.
    pub to: Literal,
}

/// Conversion of the numbers of an enumeration to texts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Enumeration {
    /// Number to text.
    #[schema(max_items = 1024)]
    pub texts: Vec<EnumerationText>,
    /// The text for any other number; the number itself in digits where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub otherwise: Option<String>,
}

/// The text of one number of an enumeration.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct EnumerationText {
    /// Number of the enumeration.
    pub value: i64,
    /// Text that is yielded.
    pub text: String,
}

/// One bit of an integer, as Boolean.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Bit {
    /// 0 is the lowest.
    #[schema(maximum = 63)]
    pub bit: u8,
}

/// The texts of all bits that are set, in their order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BitTexts {
    /// Texts of bits; bits without one are left out.
    #[schema(max_items = 64)]
    pub bits: Vec<BitText>,
    /// Separator between two texts.
    #[serde(default = "comma")]
    pub separator: String,
    /// The text when none of the bits is set.
    #[serde(default)]
    pub none: String,
}

/// Text of one bit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BitText {
    /// 0 is the lowest.
    #[schema(maximum = 63)]
    pub bit: u8,
    /// Text that is yielded.
    pub text: String,
}

fn comma() -> String {
    ", ".to_owned()
}
