//! Operands of functions, taken from values of the chain.

use asi_model::{BuiltInType, Scalar, Variant, values::Array};

use crate::{convert, fault::Fault, number::Number};

/// Returns the number that a function needs.
///
/// # Errors
/// [`Fault`] `BadTypeMismatch` for anything else.
pub(super) fn number(value: &Variant) -> Result<Number, Fault> {
    value
        .as_scalar()
        .and_then(Number::of)
        .ok_or_else(|| Fault::type_mismatch("a number is needed here"))
}

/// Returns the integer that a function needs.
///
/// # Errors
/// [`Fault`] `BadTypeMismatch` for anything else.
pub(super) fn integer(value: &Variant) -> Result<i128, Fault> {
    value
        .as_scalar()
        .and_then(Scalar::as_i128)
        .ok_or_else(|| Fault::type_mismatch("an integer is needed here"))
}

/// Returns the truth of a Boolean, or of a number: not zero is true.
///
/// # Errors
/// [`Fault`] `BadTypeMismatch` for anything else.
pub(super) fn level(value: &Variant) -> Result<bool, Fault> {
    let level = value.as_scalar().and_then(convert::is_true);
    level.ok_or_else(|| Fault::type_mismatch("a Boolean or a number is needed here"))
}

/// Returns an array of Int64, or of Double as soon as one element is not an integer of 64 bits.
pub(super) fn array_of(numbers: Vec<Number>, dimensions: Option<Vec<u32>>) -> Variant {
    let mut elements: Vec<Scalar> = numbers.iter().map(|n| n.to_scalar()).collect();
    let first = elements.first().map_or(BuiltInType::Double, Scalar::built_in_type);
    let uniform = elements.iter().all(|element| element.built_in_type() == first);
    let element_type = if uniform { first } else { BuiltInType::Double };
    if !uniform {
        elements = numbers.iter().map(|n| Scalar::Double(n.as_f64())).collect();
    }
    Variant::Array(Array { element_type, elements, dimensions }.into())
}
