//! One value from several inputs.

use asi_model::{BuiltInType, Scalar, Variant, values::Array};

use super::{
    flow::{Applied, Flow},
    operand::{array_of, level, number},
    plan::MergeOf,
    slots::Slot,
};
use crate::{
    convert,
    document::MergeRule,
    fault::Fault,
    number::Number,
    quality::{Meta, severity},
};

impl MergeOf {
    pub(super) fn apply(&self, slots: &[Slot]) -> Applied {
        let slots: Vec<&Slot> = self.inputs.iter().filter_map(|index| slots.get(*index)).collect();
        match self.rule {
            MergeRule::Newest => {
                let newest = slots.iter().filter_map(|slot| slot.flow()).reduce(|a, b| {
                    if b.meta.source_timestamp > a.meta.source_timestamp { b } else { a }
                });
                pick(newest, &slots)
            }
            MergeRule::FirstGood => {
                let mut usable: Vec<Flow> = slots.iter().filter_map(|slot| slot.flow()).collect();
                // Stable: among equals the order of precedence holds.
                usable.sort_by_key(|flow| severity(flow.meta.status));
                pick(usable.into_iter().next(), &slots)
            }
            rule => {
                let mut meta = Meta::default();
                for (index, of_input) in slots.iter().filter_map(|slot| slot.meta()).enumerate() {
                    if index == 0 { meta = of_input } else { meta.combine(&of_input) }
                }
                let values: Vec<&Variant> =
                    slots.iter().filter_map(|slot| slot.variant()).collect();
                match join(rule, &values, &self.separator) {
                    Ok(value) => Applied::Pass(Flow { value, meta }),
                    Err(fault) => Applied::Fail(fault, meta),
                }
            }
        }
    }
}

/// The picked input, or the first one's bad status where none is usable.
fn pick(picked: Option<Flow>, slots: &[&Slot]) -> Applied {
    match picked {
        Some(flow) => Applied::Pass(flow),
        None => match slots.iter().find_map(|slot| slot.bad(false)) {
            Some(bad) => {
                let message = "none of the inputs has a usable value";
                let fault = Fault::new(crate::fault::FaultKind::OutOfRange, bad.status, message);
                Applied::Fail(fault, Meta::of(&bad))
            }
            None => Applied::Hold,
        },
    }
}

fn join(rule: MergeRule, values: &[&Variant], separator: &str) -> Result<Variant, Fault> {
    let numbers =
        || values.iter().map(|value| number(value)).collect::<Result<Vec<Number>, Fault>>();
    let overflow = || Fault::out_of_range("the sum is beyond all integer types");
    let none = || Fault::type_mismatch("there is no input to merge");
    match rule {
        MergeRule::Minimum | MergeRule::Maximum => {
            let best = numbers()?.into_iter().reduce(|a, b| {
                let takes_b = if rule == MergeRule::Minimum { b < a } else { b > a };
                if takes_b { b } else { a }
            });
            best.map(|n| n.to_scalar().into()).ok_or_else(none)
        }
        MergeRule::Sum | MergeRule::Mean => {
            let numbers = numbers()?;
            let sum = numbers
                .iter()
                .try_fold(Number::ZERO, |sum, n| sum.plus(*n))
                .ok_or_else(overflow)?;
            if rule == MergeRule::Sum {
                return Ok(sum.to_scalar().into());
            }
            #[allow(clippy::cast_precision_loss)]
            Ok((sum.as_f64() / numbers.len().max(1) as f64).into())
        }
        MergeRule::All | MergeRule::Any => {
            let levels = values.iter().map(|value| level(value));
            let levels = levels.collect::<Result<Vec<bool>, Fault>>()?;
            Ok(if rule == MergeRule::All {
                levels.iter().all(|l| *l)
            } else {
                levels.iter().any(|l| *l)
            }
            .into())
        }
        MergeRule::Join => {
            let texts = values.iter().map(|value| {
                let text = value.as_scalar().and_then(convert::to_text);
                text.ok_or_else(|| Fault::type_mismatch("an input has no text form"))
            });
            Ok(texts.collect::<Result<Vec<String>, Fault>>()?.join(separator).into())
        }
        _ => array(values),
    }
}

fn array(values: &[&Variant]) -> Result<Variant, Fault> {
    let scalars: Option<Vec<Scalar>> =
        values.iter().map(|value| value.as_scalar().cloned()).collect();
    let scalars =
        scalars.ok_or_else(|| Fault::type_mismatch("an array is made of single values"))?;
    let first = scalars.first().map_or(BuiltInType::Double, Scalar::built_in_type);
    if scalars.iter().all(|scalar| scalar.built_in_type() == first) {
        return Ok(Variant::Array(
            Array { element_type: first, elements: scalars, dimensions: None }.into(),
        ));
    }
    let numbers: Option<Vec<Number>> = scalars.iter().map(Number::of).collect();
    numbers
        .map(|numbers| array_of(numbers, None))
        .ok_or_else(|| Fault::type_mismatch("the inputs of an array are of different types"))
}
