//! The functions of the expression language.

use super::{ResultKind, Value};
use crate::{
    convert::{self, Rounding, round},
    fault::Fault,
    number::Number,
};

macro_rules! builtins {
    ($($variant:ident $name:literal $least:literal..$most:expr => $result:ident),* $(,)?) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Builtin { $($variant),* }

        impl Builtin {
            pub fn named(name: &str) -> Option<Self> {
                match name { $($name => Some(Self::$variant),)* _ => None }
            }

            pub fn names() -> String {
                [$($name),*].join(", ")
            }

            pub const fn arity(self) -> (usize, usize) {
                match self { $(Self::$variant => ($least, $most)),* }
            }

            pub const fn result(self) -> ResultKind {
                match self { $(Self::$variant => ResultKind::$result),* }
            }

            const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }
        }
    };
}

builtins! {
    Min "min" 1..usize::MAX => Number, Max "max" 1..usize::MAX => Number, Abs "abs" 1..1 => Number,
    Round "round" 1..2 => Number, Floor "floor" 1..1 => Number, Ceil "ceil" 1..1 => Number,
    Trunc "trunc" 1..1 => Number, Sqrt "sqrt" 1..1 => Number, Pow "pow" 2..2 => Number, Exp "exp" 1..1 => Number,
    Ln "ln" 1..1 => Number, Log10 "log10" 1..1 => Number, Clamp "clamp" 3..3 => Number, Mod "mod" 2..2 => Number,
    Bit "bit" 2..2 => Boolean, Length "length" 1..1 => Number, Upper "upper" 1..1 => Text, Lower "lower" 1..1 => Text,
    Trim "trim" 1..1 => Text, Text "text" 1..1 => Text, ToNumber "number" 1..1 => Number,
}

/// Longest text an expression makes, in bytes.
pub(super) const TEXT_BYTES_MAX: usize = 65_536;

pub(super) fn overflow() -> Fault {
    Fault::out_of_range("the expression's result is beyond all integer types")
}

impl Builtin {
    /// Calls the function.
    ///
    /// # Errors
    /// A [`Fault`] for arguments of the wrong kind and results that are not numbers.
    pub(super) fn call(self, arguments: &[Value]) -> Result<Value, Fault> {
        let arguments = Arguments { of: self, values: arguments };
        match self {
            Self::Length | Self::Upper | Self::Lower | Self::Trim => arguments.text_function(),
            Self::Text => arguments.to_text(),
            Self::ToNumber => arguments.to_number(),
            Self::Bit => arguments.bit().map(Value::Boolean),
            _ => arguments.number_function().map(Value::Number),
        }
    }
}

/// Arguments of one call.
struct Arguments<'a> {
    of: Builtin,
    values: &'a [Value],
}

impl Arguments<'_> {
    fn number(&self, index: usize) -> Result<Number, Fault> {
        let name = self.of.name();
        match self.values.get(index) {
            Some(Value::Number(number)) => Ok(*number),
            Some(other) => {
                Err(Fault::type_mismatch(format!("{name} takes a number, not {}", other.kind())))
            }
            None => Err(Fault::type_mismatch(format!("{name} lacks an argument"))),
        }
    }

    fn text(&self) -> Result<&str, Fault> {
        match self.values.first() {
            Some(Value::Text(text)) => Ok(text),
            _ => Err(Fault::type_mismatch(format!("{} takes a text", self.of.name()))),
        }
    }

    fn number_function(&self) -> Result<Number, Fault> {
        use Builtin as B;
        match self.of {
            B::Abs => self.number(0)?.magnitude().ok_or_else(overflow),
            B::Round if self.values.len() == 2 => round_to(self.number(0)?, self.number(1)?),
            B::Floor => whole(self.number(0)?, Rounding::Down),
            B::Ceil => whole(self.number(0)?, Rounding::Up),
            B::Trunc => whole(self.number(0)?, Rounding::TowardZero),
            B::Sqrt => self.real(f64::sqrt),
            B::Exp => self.real(f64::exp),
            B::Ln => self.real(f64::ln),
            B::Log10 => self.real(f64::log10),
            B::Pow => power(self.number(0)?, self.number(1)?).ok_or_else(|| self.no_result()),
            B::Mod => modulo(self.number(0)?, self.number(1)?),
            B::Min => self.best(|next, best| next < best),
            B::Max => self.best(|next, best| next > best),
            B::Clamp => {
                let (value, low, high) = (self.number(0)?, self.number(1)?, self.number(2)?);
                Ok(if value < low {
                    low
                } else if value > high {
                    high
                } else {
                    value
                })
            }
            _ => whole(self.number(0)?, Rounding::Nearest),
        }
    }

    fn real(&self, function: impl FnOnce(f64) -> f64) -> Result<Number, Fault> {
        let result = function(self.number(0)?.as_f64());
        if result.is_nan() { Err(self.no_result()) } else { Ok(Number::Real(result)) }
    }

    fn no_result(&self) -> Fault {
        Fault::out_of_range(format!("{} has no result for this number", self.of.name()))
    }

    fn best(&self, is_better: impl Fn(Number, Number) -> bool) -> Result<Number, Fault> {
        let mut best = self.number(0)?;
        for index in 1..self.values.len() {
            let next = self.number(index)?;
            if is_better(next, best) {
                best = next;
            }
        }
        Ok(best)
    }

    fn bit(&self) -> Result<bool, Fault> {
        match (self.number(0)?, self.number(1)?) {
            (Number::Integer(value), Number::Integer(bit @ 0..=63)) => Ok(value >> bit & 1 == 1),
            _ => Err(Fault::type_mismatch("bit takes an integer and a position from 0 to 63")),
        }
    }

    fn text_function(&self) -> Result<Value, Fault> {
        let text = self.text()?;
        Ok(match self.of {
            Builtin::Upper => Value::Text(text.to_uppercase().into()),
            Builtin::Lower => Value::Text(text.to_lowercase().into()),
            Builtin::Trim => Value::Text(text.trim().into()),
            _ => {
                let length = i128::try_from(text.chars().count()).unwrap_or(i128::MAX);
                Value::Number(Number::Integer(length))
            }
        })
    }

    fn to_text(&self) -> Result<Value, Fault> {
        match self.values.first().cloned().ok_or_else(overflow)? {
            text @ Value::Text(_) => Ok(text),
            other => convert::to_text(other.into_variant().as_scalar().ok_or_else(overflow)?)
                .map(|text| Value::Text(text.into()))
                .ok_or_else(|| Fault::type_mismatch("text takes a single value")),
        }
    }

    fn to_number(&self) -> Result<Value, Fault> {
        Ok(Value::Number(match self.values.first() {
            Some(Value::Text(text)) => text
                .trim()
                .parse()
                .map_err(|_| Fault::decoding("number: the text is not a number"))?,
            Some(Value::Boolean(v)) => Number::Integer((*v).into()),
            _ => self.number(0)?,
        }))
    }
}

fn whole(number: Number, rounding: Rounding) -> Result<Number, Fault> {
    match number {
        Number::Integer(_) => Ok(number),
        Number::Real(v) if v.is_finite() => Ok(Number::Integer(round(v, rounding)?)),
        Number::Real(_) => Err(Fault::out_of_range("only a finite number can be rounded")),
    }
}

/// Rounds to so many decimals as people do it: by the decimal digits that the double shows, halves
/// away from zero.
fn round_to(number: Number, decimals: Number) -> Result<Number, Fault> {
    let Number::Integer(decimals @ 0..=15) = decimals else {
        return Err(Fault::out_of_range("round takes 0 to 15 decimals"));
    };
    match number {
        Number::Integer(_) => Ok(number),
        Number::Real(v) if v.is_finite() => {
            let factor = 10_f64.powi(i32::try_from(decimals).unwrap_or(0));
            // 2.675 is stored as 2.67499...; multiplied it is 267.49999999999994. One ulp up gives
            // what was written.
            let scaled = v * factor;
            let nudged = if scaled > 0.0 { scaled.next_up() } else { scaled.next_down() };
            let rounded = nudged.round();
            Ok(Number::Real(if scaled.is_finite() { rounded / factor } else { v }))
        }
        Number::Real(_) => Err(Fault::out_of_range("only a finite number can be rounded")),
    }
}

fn power(base: Number, exponent: Number) -> Option<Number> {
    if let (Number::Integer(base), Number::Integer(exponent)) = (base, exponent)
        && let Ok(exponent) = u32::try_from(exponent)
        && let Some(result) = base.checked_pow(exponent)
    {
        return Some(Number::Integer(result));
    }
    let result = base.as_f64().powf(exponent.as_f64());
    (!result.is_nan()).then_some(Number::Real(result))
}

/// The remainder with the sign of the divisor.
pub(super) fn modulo(a: Number, b: Number) -> Result<Number, Fault> {
    if b.is_zero() {
        return Err(Fault::out_of_range("division by zero"));
    }
    match (a, b) {
        (Number::Integer(a), Number::Integer(b)) => {
            let remainder = a.checked_rem(b).ok_or_else(overflow)?;
            let other_sign = remainder != 0 && (remainder < 0) != (b < 0);
            Ok(Number::Integer(if other_sign { remainder + b } else { remainder }))
        }
        (a, b) => {
            let (a, b) = (a.as_f64(), b.as_f64());
            Ok(Number::Real(a - b * (a / b).floor()))
        }
    }
}

/// The quotient rounded towards minus infinity.
pub(super) fn floor_divide(a: Number, b: Number) -> Result<Number, Fault> {
    if b.is_zero() {
        return Err(Fault::out_of_range("division by zero"));
    }
    match (a, b) {
        (Number::Integer(a), Number::Integer(b)) => {
            let quotient = a.checked_div(b).ok_or_else(overflow)?;
            let uneven = a % b != 0 && (a < 0) != (b < 0);
            Ok(Number::Integer(if uneven { quotient - 1 } else { quotient }))
        }
        (a, b) => whole(Number::Real(a.as_f64() / b.as_f64()), Rounding::Down),
    }
}
