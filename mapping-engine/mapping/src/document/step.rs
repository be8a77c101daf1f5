//! The functions a chain is made of, with their parameters.

mod combination;
mod conversion;
mod counting;
mod signal;
mod table;
mod text;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

pub use combination::{Merge, MergeRule, Script};
pub use conversion::{Constant, Convert, Expression, Scale, Select, UnitConversion};
pub use counting::{Counter, CounterInput, Increment, OnDecrease};
pub use signal::{
    Aggregate, Deadband, Debounce, Edge, EdgeDirection, Rate, RatePeriod, Threshold, Window,
};
pub use table::{Bit, BitText, BitTexts, Enumeration, EnumerationText, Lookup, LookupEntry};
pub use text::{Format, Parse};

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
    /// Conversion of one unit of measurement to another.
    UnitConversion = "unitConversion",
    /// Increase of a counter since its last value.
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
    /// Conversion of values to values by a table.
    Lookup = "lookup",
    /// Conversion of the numbers of an enumeration to texts.
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
