//! Exact decimals: rounding must neither lose digits of 64-bit integers nor show binary fractions.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// A decimal number `mantissa * 10^exponent`, normalised so that the mantissa has no trailing
/// zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Decimal {
    mantissa: i128,
    exponent: i32,
}

/// Largest power of ten that an `i128` holds.
const POWER_MAX: i32 = 38;

impl Decimal {
    /// Number 0 in its normalised form.
    pub const ZERO: Self = Self { mantissa: 0, exponent: 0 };

    /// Creates `mantissa * 10^exponent`, normalised.
    #[must_use]
    pub const fn new(mut mantissa: i128, mut exponent: i32) -> Self {
        if mantissa == 0 {
            return Self::ZERO;
        }
        while mantissa % 10 == 0 {
            mantissa /= 10;
            exponent += 1;
        }
        Self { mantissa, exponent }
    }

    /// Returns the shortest decimal that parses to this number; `None` for NaN and the infinities.
    #[must_use]
    pub fn from_f64(value: f64) -> Option<Self> {
        value.is_finite().then(|| format!("{value:e}").parse().ok()).flatten()
    }

    /// Returns the shortest decimal that parses to this number; `None` for NaN and the infinities.
    #[must_use]
    pub fn from_f32(value: f32) -> Option<Self> {
        value.is_finite().then(|| format!("{value:e}").parse().ok()).flatten()
    }

    /// Returns the nearest `f64`.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.scientific().parse().unwrap_or(f64::NAN)
    }

    /// Returns the nearest `f32`.
    #[must_use]
    pub fn to_f32(self) -> f32 {
        self.scientific().parse().unwrap_or(f32::NAN)
    }

    /// Returns the number as an integer, if it is one that fits.
    #[must_use]
    pub fn to_integer(self) -> Option<i128> {
        if self.exponent < 0 {
            None
        } else {
            self.mantissa.checked_mul(power_of_ten(self.exponent)?)
        }
    }

    /// Returns the multiple of `step` nearest to this number, ties away from zero. A number so large that
    /// even its own last digit is coarser than the step is returned as it is.
    #[must_use]
    pub fn round_to(self, step: RoundingStep) -> Self {
        let step = step.0;
        let shift = self.exponent.saturating_sub(step.exponent);
        let count = if shift >= 0 {
            let Some(numerator) =
                power_of_ten(shift).and_then(|power| self.mantissa.checked_mul(power))
            else {
                return self;
            };
            divide_to_nearest(numerator, step.mantissa)
        } else {
            match power_of_ten(-shift).and_then(|power| step.mantissa.checked_mul(power)) {
                Some(denominator) => divide_to_nearest(self.mantissa, denominator),
                // The number is below half a step by more digits than an i128 has.
                None => 0,
            }
        };
        count.checked_mul(step.mantissa).map_or(self, |mantissa| Self::new(mantissa, step.exponent))
    }

    /// Rounds to at most so many significant digits, ties away from zero.
    #[must_use]
    pub fn with_digits(self, digits: u8) -> Self {
        let (unit, exponent) = self.unit_of(digits);
        Self::new(divide_to_nearest(self.mantissa, unit), exponent)
    }

    /// Cuts after so many significant digits, towards zero.
    #[must_use]
    pub fn truncated_to(self, digits: u8) -> Self {
        let (unit, exponent) = self.unit_of(digits);
        Self::new(self.mantissa / unit, exponent)
    }

    /// Returns the number of significant digits; one for zero.
    #[must_use]
    pub fn digits(self) -> u32 {
        self.mantissa.unsigned_abs().checked_ilog10().unwrap_or(0) + 1
    }

    /// Returns the last of so many digits in units of the mantissa's last digit, and its exponent.
    fn unit_of(self, digits: u8) -> (i128, i32) {
        let excess = self.digits().saturating_sub(u32::from(digits.max(1)));
        (10_i128.pow(excess), self.exponent + i32::try_from(excess).unwrap_or(0))
    }

    fn scientific(self) -> String {
        format!("{}e{}", self.mantissa, self.exponent)
    }
}

/// Returns `10^exponent`, if it fits.
fn power_of_ten(exponent: i32) -> Option<i128> {
    if !(0..=POWER_MAX).contains(&exponent) {
        return None;
    }
    10_i128.checked_pow(exponent.unsigned_abs())
}

/// Returns the integer nearest to a quotient, ties away from zero; the denominator is positive.
pub(super) const fn divide_to_nearest(numerator: i128, denominator: i128) -> i128 {
    let (quotient, remainder) = (numerator / denominator, numerator % denominator);
    // `remainder >= denominator - remainder` says `2 * remainder >= denominator` without overflow.
    if remainder.abs() >= denominator - remainder.abs() {
        quotient + numerator.signum()
    } else {
        quotient
    }
}

impl FromStr for Decimal {
    type Err = InvalidStep;

    /// Plain or scientific notation with up to 38 digits.
    fn from_str(text: &str) -> Result<Self, InvalidStep> {
        let invalid = || InvalidStep { found: text.chars().take(40).collect() };
        let (number, exponent) = match text.split_once(['e', 'E']) {
            Some((number, exponent)) => (number, exponent.parse::<i32>().map_err(|_| invalid())?),
            None => (text, 0),
        };
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        let mantissa = format!("{whole}{fraction}").parse::<i128>().map_err(|_| invalid())?;
        let digits = i32::try_from(fraction.len()).map_err(|_| invalid())?;
        Ok(Self::new(mantissa, exponent.checked_sub(digits).ok_or_else(invalid)?))
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.mantissa.unsigned_abs().to_string();
        let sign = if self.mantissa < 0 { "-" } else { "" };
        let exponent = self.exponent.unsigned_abs() as usize;
        if self.exponent > 30 || self.exponent < -30 {
            return write!(f, "{sign}{digits}e{}", self.exponent);
        }
        if self.exponent >= 0 {
            return write!(f, "{sign}{digits}{:0<exponent$}", "");
        }
        let padded = format!("{digits:0>width$}", width = exponent + 1);
        let (whole, fraction) = padded.split_at(padded.len() - exponent);
        write!(f, "{sign}{whole}.{fraction}")
    }
}

/// Fault of a text that is not a positive decimal number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a rounding step must be a positive number with at most 15 digits, but is {found}")]
pub struct InvalidStep {
    /// The text, cut after 40 characters.
    pub found: String,
}

/// A positive decimal with at most 15 significant digits: values are rounded to multiples of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, utoipa::ToSchema)]
#[schema(value_type = f64, exclusive_minimum = 0.0)]
pub struct RoundingStep(Decimal);

impl RoundingStep {
    /// Creates a step from a decimal.
    ///
    /// # Errors
    /// [`InvalidStep`] when it is not positive, has more than 15 digits or an exponent beyond ±30.
    pub fn new(step: Decimal) -> Result<Self, InvalidStep> {
        if step.mantissa > 0
            && step.mantissa < 1_000_000_000_000_000
            && (-30..=30).contains(&step.exponent)
        {
            Ok(Self(step))
        } else {
            Err(InvalidStep { found: step.to_string() })
        }
    }

    /// Returns the step as a decimal.
    #[must_use]
    pub const fn decimal(self) -> Decimal {
        self.0
    }

    /// Returns the step, if it is an integer.
    #[must_use]
    pub fn to_integer(self) -> Option<i128> {
        self.0.to_integer()
    }
}

impl TryFrom<f64> for RoundingStep {
    type Error = InvalidStep;
    fn try_from(step: f64) -> Result<Self, InvalidStep> {
        Self::new(Decimal::from_f64(step).ok_or_else(|| InvalidStep { found: step.to_string() })?)
    }
}

impl fmt::Display for RoundingStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Serialize for RoundingStep {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.to_integer().map(i64::try_from) {
            Some(Ok(integer)) => serializer.serialize_i64(integer),
            _ => serializer.serialize_f64(self.0.to_f64()),
        }
    }
}

impl<'de> Deserialize<'de> for RoundingStep {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::try_from(f64::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(text: &str) -> RoundingStep {
        RoundingStep::new(text.parse().expect("a number")).expect("a step")
    }

    #[test]
    fn text_round_trips() {
        for (text, shown) in
            [("0.1", "0.1"), ("2500", "2500"), ("-0.0250", "-0.025"), ("1e3", "1000"), ("0", "0")]
        {
            assert_eq!(
                text.parse::<Decimal>().map(|d| d.to_string()),
                Ok(shown.to_owned()),
                "{text}"
            );
        }
        for text in ["", "-", "1.2.3", "abc", "1e99999999999", "--1"] {
            assert!(text.parse::<Decimal>().is_err(), "{text}");
        }
    }

    #[test]
    fn rounds_to_the_nearest_multiple() {
        for (value, by, rounded) in [
            (0.3, "0.1", 0.3),
            (0.25, "0.1", 0.3),
            (-0.25, "0.1", -0.3),
            (1.005, "0.01", 1.01),
            (17.0, "5", 15.0),
            (17.5, "5", 20.0),
            (1e-300, "0.1", 0.0),
            (1e300, "0.1", 1e300),
            (123_456_789.123, "1000", 123_457_000.0),
            (2.5, "2.5", 2.5),
        ] {
            let result = Decimal::from_f64(value).map(|d| d.round_to(step(by)).to_f64());
            assert_eq!(result, Some(rounded), "{value} by {by}");
        }
    }

    #[test]
    fn integers_of_64_bits_stay_exact() {
        let value = Decimal::new(i128::from(u64::MAX), 0).round_to(step("3"));
        assert_eq!(value.to_integer(), Some(i128::from(u64::MAX)));
        let value = Decimal::new(9_007_199_254_740_993, 0).round_to(step("1"));
        assert_eq!(value.to_integer(), Some(9_007_199_254_740_993));
    }

    #[test]
    fn steps_are_positive() {
        for (text, ok) in
            [(1.0, true), (0.001, true), (0.0, false), (-1.0, false), (f64::NAN, false)]
        {
            assert_eq!(RoundingStep::try_from(text).is_ok(), ok, "{text}");
        }
    }
}
