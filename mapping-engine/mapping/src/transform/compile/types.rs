//! Types that functions take and yield, as far as they are known before a value comes.

use asi_model::BuiltInType as T;

use crate::{
    convert,
    document::{Aggregate, CounterInput, Literal, Mapping, MergeRule, Step},
    expression::ResultKind,
    transform::plan::Function,
};

/// Mismatch between a function and the type that comes in.
pub(super) struct InputMismatch {
    /// JSON pointer below the function; empty for the function itself.
    pub member: &'static str,
    pub message: String,
}

/// Checks that a function takes values of a type.
pub(super) fn check_input(step: &Step, value: T) -> Result<(), InputMismatch> {
    let number_or_boolean = value.is_numeric() || value == T::Boolean;
    let wanted = match step {
        Step::Scale(_)
        | Step::UnitConversion(_)
        | Step::Increment(_)
        | Step::Threshold(_)
        | Step::Rate(_)
            if !value.is_numeric() =>
        {
            "a number"
        }
        Step::Window(window) if window.aggregate != Aggregate::Count && !number_or_boolean => {
            "a number"
        }
        Step::Counter(counter)
            if counter.counts == Some(CounterInput::Increments) && !value.is_numeric() =>
        {
            "a number"
        }
        Step::Counter(counter)
            if counter.counts != Some(CounterInput::Values) && !number_or_boolean =>
        {
            "a number or Boolean"
        }
        Step::Edge(_) if !number_or_boolean => "a Boolean or number",
        Step::Enumeration(_) | Step::Bit(_) | Step::BitTexts(_)
            if !value.is_integer() && value != T::Boolean =>
        {
            "an integer"
        }
        Step::Parse(_) if !matches!(value, T::String | T::LocalizedText) => "a text",
        Step::Convert(to) if !convert::converts(value, to.to.0) => {
            let message = format!("a {value} does not convert to {}", to.to);
            return Err(InputMismatch { member: "/to", message });
        }
        _ => return Ok(()),
    };
    let message = format!("{} takes {wanted}, but a {value} comes in", step.function());
    Err(InputMismatch { member: "", message })
}

/// Returns the type that a function yields; `None` where it depends on the value.
pub(super) fn output_type(
    mapping: &Mapping,
    step: &Step,
    function: Option<&Function>,
    value: Option<T>,
) -> Option<T> {
    match step {
        Step::Select(_) | Step::Script(_) => None,
        Step::Constant(constant) => Some(constant.value.0.built_in_type()),
        Step::Convert(convert) => Some(convert.to.0),
        Step::Parse(parse) => Some(parse.to.0),
        // 64-bit arithmetic decides at run time whether the result is an integer.
        Step::Scale(_) | Step::UnitConversion(_) | Step::Increment(_) | Step::Counter(_) => {
            match value {
                Some(T::Float | T::Double) => Some(T::Double),
                _ => None,
            }
        }
        Step::Edge(_) | Step::Bit(_) => Some(T::Boolean),
        Step::Threshold(threshold) => {
            let of = |literal: &Option<Literal>| {
                literal.as_ref().map_or(T::Boolean, |literal| literal.0.built_in_type())
            };
            let (above, below) = (of(&threshold.above), of(&threshold.below));
            (above == below).then_some(above)
        }
        Step::Debounce(_) | Step::Deadband(_) => value,
        Step::Rate(_) => Some(T::Double),
        Step::Window(window) => match window.aggregate {
            Aggregate::Count => Some(T::Int64),
            Aggregate::Mean => Some(T::Double),
            _ => value.filter(|value| *value == T::Double).or_else(|| {
                value.filter(|value| value.is_integer() && *value != T::UInt64).map(|_| T::Int64)
            }),
        },
        Step::Lookup(lookup) if lookup.interpolate => Some(T::Double),
        Step::Lookup(lookup) => {
            let mut types = lookup.entries.iter().map(|entry| &entry.to).chain(&lookup.otherwise);
            let first = types.next().map(|literal| literal.0.built_in_type())?;
            types.all(|literal| literal.0.built_in_type() == first).then_some(first)
        }
        Step::Enumeration(_) | Step::BitTexts(_) | Step::Format(_) => Some(T::String),
        Step::Expression(_) => match function {
            Some(Function::Expression(expression)) => match expression.expression.result() {
                Some(ResultKind::Boolean) => Some(T::Boolean),
                Some(ResultKind::Text) => Some(T::String),
                Some(ResultKind::Number) | None => None,
            },
            _ => None,
        },
        Step::Merge(merge) => match merge.rule {
            MergeRule::Mean => Some(T::Double),
            MergeRule::All | MergeRule::Any => Some(T::Boolean),
            MergeRule::Join => Some(T::String),
            MergeRule::Newest | MergeRule::FirstGood => common_type(mapping, &merge.inputs),
            _ => None,
        },
    }
}

/// Returns the type of the inputs with these names, of all where there are no names, where it is
/// one.
fn common_type(mapping: &Mapping, names: &[String]) -> Option<T> {
    let inputs = mapping.inputs.iter();
    let mut types = inputs
        .filter(|input| names.is_empty() || names.contains(&input.name))
        .map(|i| i.value_type);
    let first = types.next()??;
    types.all(|other| other == Some(first)).then_some(first.0)
}
