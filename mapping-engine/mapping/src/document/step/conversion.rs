//! Steps that compute a value from one value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{
    convert::{Overflow, Rounding},
    document::{Literal, TypeName},
    number::Number,
};

/// Picks an element of an array or a field of a structure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Select {
    /// Field names and 0-based indexes, as `Axes[2].Position` or `[0]`.
    #[schema(max_length = 1024)]
    pub path: String,
}

/// Yields the same value whatever comes in; with no input before it, once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Constant {
    /// Value that the step yields.
    pub value: Literal,
}

/// Converts to another built-in type: numbers, Boolean, String, DateTime and Guid among each other
/// where it makes sense. Text that is no number is a fault, never zero.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Convert {
    /// The wanted type.
    pub to: TypeName,
    /// Rounding of a fraction to an integer.
    #[serde(default)]
    pub rounding: Rounding,
    /// Treatment of a number outside the wanted type's range.
    #[serde(default)]
    pub overflow: Overflow,
}

/// `value * factor / divisor + offset`. Integers stay integers (of 64 bits) where factor, divisor
/// and offset are and the division comes out even.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Scale {
    /// Factor of the value.
    #[serde(default = "one")]
    pub factor: Number,
    /// Divisor of the product; not zero.
    #[serde(default = "one")]
    pub divisor: Number,
    /// Summand added at the end.
    #[serde(default = "zero")]
    pub offset: Number,
}

/// Conversion of one unit of measurement to another of the same kind, by UNECE codes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct UnitConversion {
    /// The unit that comes in; the first input's unit where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// The unit that goes out; the target's unit where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// An arithmetic expression over `value` and the inputs by name.
///
/// Numbers, texts in quotes, `true` and `false`; `+ - * / // %`, comparisons, `&& || !`, `c ? a :
/// b`; `min max abs round floor ceil trunc sqrt pow exp ln log10 clamp mod bit length upper lower
/// trim text number`. `//` divides towards minus infinity; `/` of two integers is an integer where
/// it comes out even. `+` joins texts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Expression {
    /// Text of the expression.
    #[schema(max_length = 4096)]
    pub expression: String,
}

const fn one() -> Number {
    Number::ONE
}

const fn zero() -> Number {
    Number::ZERO
}
