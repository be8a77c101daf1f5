//! The functions a chain is made of, with their parameters.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Literal, TypeName};
use crate::{
    convert::{Overflow, Rounding},
    number::Number,
};

macro_rules! step {
    ($($(#[$doc:meta])* $variant:ident = $name:literal),* $(,)?) => {
        /// One function of a chain. In JSON an object with `function` and the parameters.
        ///
        /// A function gets the value the one before it yielded, and may keep it to itself: then the
        /// chain ends there until the next value.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
        #[serde(tag = "function", rename_all = "camelCase")]
        pub enum Step { $($(#[$doc])* $variant($variant)),* }

        impl Step {
            /// The function's name, as in JSON.
            #[must_use]
            pub const fn function(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name),* }
            }
        }

        $(impl From<$variant> for Step {
            fn from(step: $variant) -> Self { Self::$variant(step) }
        })*
    };
}

step! {
    /// Picks an element of an array or a field of a structure.
    Select = "select",
    /// Yields the same value whatever comes in.
    Constant = "constant",
    /// Converts to another built-in type.
    Convert = "convert",
    /// `value * factor / divisor + offset`.
    Scale = "scale",
    /// From one unit of measurement to another.
    UnitConversion = "unitConversion",
    /// How much a counter went on since its last value.
    Increment = "increment",
    /// The sum of a counter's increments, across wraps, resets and restarts.
    Counter = "counter",
    /// Lets a Boolean pass when it changes.
    Edge = "edge",
    /// Above or below a limit, with hysteresis.
    Threshold = "threshold",
    /// Lets a value pass once it has not changed for a while.
    Debounce = "debounce",
    /// Holds changes back that are too small.
    Deadband = "deadband",
    /// Change per time.
    Rate = "rate",
    /// An aggregate over the last values or the last span of time.
    Window = "window",
    /// From values to values by a table.
    Lookup = "lookup",
    /// From the numbers of an enumeration to texts.
    Enumeration = "enumeration",
    /// One bit of an integer.
    Bit = "bit",
    /// The texts of all bits that are set.
    BitTexts = "bitTexts",
    /// Puts values into a text.
    Format = "format",
    /// Takes a value out of a text.
    Parse = "parse",
    /// An arithmetic expression.
    Expression = "expression",
    /// One value from several inputs.
    Merge = "merge",
    /// A JavaScript function.
    Script = "script",
}

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
    /// The value.
    pub value: Literal,
}

/// Converts to another built-in type: numbers, Boolean, String, DateTime and Guid among each other
/// where it makes sense. Text that is no number is a fault, never zero.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Convert {
    /// The wanted type.
    pub to: TypeName,
    /// How a fraction becomes an integer.
    #[serde(default)]
    pub rounding: Rounding,
    /// What happens outside the wanted type's range.
    #[serde(default)]
    pub overflow: Overflow,
}

/// `value * factor / divisor + offset`. Integers stay integers (of 64 bits) where factor, divisor
/// and offset are and the division comes out even.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Scale {
    /// What the value is multiplied by.
    #[serde(default = "one")]
    pub factor: Number,
    /// What the product is divided by; not zero.
    #[serde(default = "one")]
    pub divisor: Number,
    /// What is added at the end.
    #[serde(default = "zero")]
    pub offset: Number,
}

/// From one unit of measurement to another of the same kind, by UNECE codes.
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

/// How much a counter went on since its last value. The first value yields nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Increment {
    /// How many values the counter has before it starts again at zero (65536 for a UInt16); it does
    /// not wrap where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<Number>,
    /// What a decrease means that is no wrap.
    #[serde(default)]
    pub on_decrease: OnDecrease,
}

/// What it means when a counter's value gets smaller and that is no wrap.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub enum OnDecrease {
    /// The counter was reset to zero and has counted to its value since.
    #[default]
    Reset,
    /// The counter was set; nothing was counted.
    Set,
    /// It counts downwards too: the increment is negative.
    Subtract,
}

/// The sum of a counter's increments, across wraps, resets and restarts of machine and connector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Counter {
    /// What is counted; by the type of the value where absent: increments of numbers, rising edges
    /// of Booleans.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts: Option<CounterInput>,
    /// Where it starts.
    #[serde(default = "zero")]
    pub start: Number,
    /// As in `increment`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulus: Option<Number>,
    /// As in `increment`.
    #[serde(default)]
    pub on_decrease: OnDecrease,
    /// An input that sets the sum back to `start` when it becomes true (or not zero).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reset_by: Option<String>,
}

/// What a `counter` counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum CounterInput {
    /// How much the number went on.
    Increments,
    /// How often the value became true (or not zero).
    RisingEdges,
    /// How many values came.
    Values,
}

/// Lets a Boolean (or a number: not zero is true) pass only when it changes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Edge {
    /// Which change passes.
    pub direction: EdgeDirection,
}

/// A change of a Boolean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum EdgeDirection {
    /// From false to true.
    Rising,
    /// From true to false.
    Falling,
    /// Either.
    Both,
}

/// Whether a number is above a limit, with hysteresis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Threshold {
    /// At or above this it is above.
    pub limit: Number,
    /// Once above, it stays so until the number falls below this; the limit itself where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub release: Option<Number>,
    /// What is yielded above; `true` where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<Literal>,
    /// What is yielded below; `false` where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<Literal>,
}

/// Lets a value pass once it has not changed for a while.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Debounce {
    /// How long it must stay the same, in milliseconds.
    #[schema(minimum = 1)]
    pub quiet_ms: u64,
}

/// Holds changes back that are too small. Without parameters only repeats of the same value are
/// held back; values that are no numbers pass when they differ. A change of the status always
/// passes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Deadband {
    /// The change must be greater than this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absolute: Option<Number>,
    /// The change must be greater than this share of the last value that passed, in percent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub percent: Option<f64>,
}

/// Change per time, by the source's times, as Double. The first value yields nothing.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Rate {
    /// Per what.
    #[serde(default)]
    pub per: RatePeriod,
}

/// The time that a rate refers to.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema, ToSchema,
)]
#[serde(rename_all = "camelCase")]
#[allow(missing_docs)]
pub enum RatePeriod {
    #[default]
    Second,
    Minute,
    Hour,
    Day,
}

/// An aggregate over the last values (`samples`) or the last span of time (`durationMs`); exactly
/// one of the two. Over time it also changes when values leave the window. At most 4096 values are
/// kept; beyond, the oldest leave early.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Window {
    /// What is computed.
    pub aggregate: Aggregate,
    /// How many values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 4096)]
    pub samples: Option<u32>,
    /// How long back from the newest value, in milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1)]
    pub duration_ms: Option<u64>,
}

/// What a window computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum Aggregate {
    /// The smallest value.
    Minimum,
    /// The greatest value.
    Maximum,
    /// The arithmetic mean, as Double.
    Mean,
    /// The sum; exact for integers.
    Sum,
    /// How many values.
    Count,
    /// The newest value.
    Last,
}

/// From values to values by a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Lookup {
    /// The table. Numbers match by value whatever their types, texts exactly.
    #[schema(max_items = 1024)]
    pub entries: Vec<LookupEntry>,
    /// What is yielded for a value that is not in the table; a fault where absent.
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

/// From the numbers of an enumeration to texts.
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
    /// The number.
    pub value: i64,
    /// Its text.
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
    /// What the bits mean; others are left out.
    #[schema(max_items = 64)]
    pub bits: Vec<BitText>,
    /// What stands between two texts.
    #[serde(default = "comma")]
    pub separator: String,
    /// The text when none of the bits is set.
    #[serde(default)]
    pub none: String,
}

/// What a bit means.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BitText {
    /// 0 is the lowest.
    #[schema(maximum = 63)]
    pub bit: u8,
    /// Its text.
    pub text: String,
}

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
    /// Where it stands: `{}` is the value, `*` any text, all else itself (`Temp={} *`). The whole
    /// text where absent.
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

/// An arithmetic expression over `value` and the inputs by name.
///
/// Numbers, texts in quotes, `true` and `false`; `+ - * / // %`, comparisons, `&& || !`, `c ? a :
/// b`; `min max abs round floor ceil trunc sqrt pow exp ln log10 clamp mod bit length upper lower
/// trim text number`. `//` divides towards minus infinity; `/` of two integers is an integer where
/// it comes out even. `+` joins texts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Expression {
    /// The expression.
    #[schema(max_length = 4096)]
    pub expression: String,
}

/// One value from several inputs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Merge {
    /// The names of the inputs, in their order of precedence; all where empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<String>,
    /// How.
    pub rule: MergeRule,
    /// What stands between the texts of `join`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub separator: Option<String>,
}

/// How several inputs become one value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum MergeRule {
    /// The one with the newest source time.
    Newest,
    /// The first whose status is Good; else the first that is Uncertain.
    FirstGood,
    /// The smallest.
    Minimum,
    /// The greatest.
    Maximum,
    /// The sum.
    Sum,
    /// The arithmetic mean, as Double.
    Mean,
    /// Whether all are true.
    All,
    /// Whether any is true.
    Any,
    /// Their texts one after the other.
    Join,
    /// An array of them, all of one type.
    Array,
}

/// A JavaScript function `(value, ctx) => ...`, run in a worker process.
///
/// `ctx.state` is kept between calls (at most 4 KiB as JSON) and survives restarts; variables
/// outside the function do not. `ctx.inputs.<name>` has `value`, `status` and `sourceTimestamp`,
/// `ctx.status` and `ctx.sourceTimestamp` are those of `value`. 64-bit integers are BigInt.
/// `undefined` yields nothing, `null` no value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Script {
    /// The source text.
    #[schema(max_length = 65536)]
    pub source: String,
}

const fn one() -> Number {
    Number::ONE
}

const fn zero() -> Number {
    Number::ZERO
}

fn comma() -> String {
    ", ".to_owned()
}
