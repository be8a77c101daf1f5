//! Counters that wrap and restart; edges of Booleans.

use asi_model::{Scalar, Variant};

use super::{
    flow::{Applied, Flow},
    operand::{level as level_in, number},
    plan::{CountRule, CounterRule},
    slots::Slot,
};
use crate::{
    document::{CounterInput, EdgeDirection, OnDecrease},
    fault::Fault,
    number::Number,
};

fn overflow() -> Fault {
    Fault::out_of_range("the count is beyond all integer types")
}

impl CountRule {
    /// Returns the increment from one value to the next.
    ///
    /// A decrease is a wrap where the way over the top is the shorter one, that is less than half
    /// of the modulus.
    pub fn increment(&self, before: Number, now: Number) -> Option<Number> {
        let change = now.minus(before)?;
        if change >= Number::ZERO {
            return Some(change);
        }
        if let Some(modulus) = self.modulus {
            let wrapped = change.plus(modulus)?;
            if wrapped >= Number::ZERO && wrapped.times(Number::Integer(2))? < modulus {
                return Some(wrapped);
            }
        }
        Some(match self.on_decrease {
            OnDecrease::Reset => now,
            OnDecrease::Set => Number::ZERO,
            OnDecrease::Subtract => change,
        })
    }
}

pub(super) fn increment(rule: &CountRule, last: &mut Option<Number>, flow: Flow) -> Applied {
    let Flow { value, meta } = flow;
    let value = match number(&value) {
        Ok(number) => number,
        Err(fault) => return Applied::Fail(fault, meta),
    };
    let Some(before) = last.replace(value) else { return Applied::Hold };
    match rule.increment(before, value) {
        Some(increment) => Applied::Pass(Flow { value: increment.to_scalar().into(), meta }),
        None => Applied::Fail(overflow(), meta),
    }
}

pub(super) fn count(
    rule: &CounterRule,
    (total, last, level): (&mut Number, &mut Option<Number>, &mut Option<bool>),
    flow: Flow,
    trigger: Option<usize>,
    slots: &[Slot],
) -> Applied {
    let Flow { value, mut meta } = flow;
    if let Some(reset) = rule.reset_by.filter(|reset| trigger == Some(*reset)) {
        let slot = slots.get(reset);
        let is_set = slot.and_then(Slot::variant).map(level_in);
        if !matches!(is_set, Some(Ok(true))) {
            return Applied::Hold;
        }
        if let Some(of_input) = slot.and_then(Slot::meta) {
            meta.combine(&of_input);
        }
        *total = rule.start;
        return Applied::Pass(Flow { value: total.to_scalar().into(), meta });
    }
    match advance(rule, total, last, level, &value) {
        Ok(()) => Applied::Pass(Flow { value: total.to_scalar().into(), meta }),
        Err(fault) => Applied::Fail(fault, meta),
    }
}

fn advance(
    rule: &CounterRule,
    total: &mut Number,
    last: &mut Option<Number>,
    level: &mut Option<bool>,
    value: &Variant,
) -> Result<(), Fault> {
    let counts = rule.counts.unwrap_or(match value.as_scalar() {
        Some(Scalar::Boolean(_)) => CounterInput::RisingEdges,
        _ => CounterInput::Increments,
    });
    let step = match counts {
        CounterInput::Values => Number::ONE,
        CounterInput::RisingEdges => {
            let now = level_in(value)?;
            let before = level.replace(now);
            // Not at the first value, of which nobody knows when it rose.
            if now && before == Some(false) { Number::ONE } else { Number::ZERO }
        }
        CounterInput::Increments => {
            let now = number(value)?;
            match last.replace(now) {
                Some(before) => rule.rule.increment(before, now).ok_or_else(overflow)?,
                None => Number::ZERO,
            }
        }
    };
    *total = total.plus(step).ok_or_else(overflow)?;
    Ok(())
}

pub(super) fn edge(direction: EdgeDirection, level: &mut Option<bool>, flow: Flow) -> Applied {
    let now = match level_in(&flow.value) {
        Ok(now) => now,
        Err(fault) => return Applied::Fail(fault, flow.meta),
    };
    let before = level.replace(now);
    let passes = before.is_some_and(|before| before != now)
        && match direction {
            EdgeDirection::Rising => now,
            EdgeDirection::Falling => !now,
            EdgeDirection::Both => true,
        };
    if passes { Applied::Pass(Flow { value: now.into(), meta: flow.meta }) } else { Applied::Hold }
}
