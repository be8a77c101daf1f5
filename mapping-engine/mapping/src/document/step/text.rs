//! Steps from values to texts and back.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::document::TypeName;

/// Puts values into a text: `Order {value}: {temperature:.1} of {limit}`.
///
/// `{value}` is the chain's value, `{name}` an input. After a colon: an optional `0` and width
/// (`{value:06}`), an optional number of decimals (`{value:.2}`). `{{` and `}}` are braces.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Format {
    /// The text with its placeholders.
    #[schema(max_length = 4096)]
    pub template: String,
}

/// Takes a value out of a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Parse {
    /// The type of the value.
    pub to: TypeName,
    /// Position of the value: `{}` is the value, `*` any text, all else itself (`Temp={} *`). The
    /// whole text where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 1024)]
    pub pattern: Option<String>,
    /// The base of an integer: 2 to 36.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 2, maximum = 36)]
    pub radix: Option<u32>,
    /// A comma is the decimal sign, points group digits.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub decimal_comma: bool,
}
