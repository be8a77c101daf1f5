//! One function on one value.

use asi_model::{DateTime, Scalar, Variant, units as unece};

use super::{
    counting,
    flow::{Applied, Flow},
    operand::{array_of, integer, number},
    plan::{
        Band, BitWords, CompiledExpression, Function, ScaleBy, Texts, ThresholdRule, UnitFactor,
    },
    slots::Slot,
    windows,
};
use crate::{
    convert,
    expression::{Name, Value},
    fault::Fault,
    number::Number,
    path,
    quality::Meta,
    state::{Pending, RatePoint, StepState, StoredValue},
    text::{Source, Template},
};

impl Function {
    /// Applies the function. `trigger` is the input that made the chain run from here.
    pub(super) fn apply(
        &self,
        state: &mut StepState,
        flow: Flow,
        trigger: Option<usize>,
        slots: &[Slot],
        now: DateTime,
    ) -> Applied {
        match (self, state) {
            (Self::Debounce(quiet), StepState::Debounce { shown, pending }) => {
                let due = now.after(*quiet);
                debounce(shown.as_deref(), pending, flow, due)
            }
            (Self::Deadband(band), StepState::Deadband { passed }) => band.apply(passed, flow),
            (Self::Edge(direction), StepState::Edge { level }) => {
                counting::edge(*direction, level, flow)
            }
            (Self::Increment(rule), StepState::Increment { last }) => {
                counting::increment(rule, last, flow)
            }
            (Self::Counter(rule), StepState::Counter { total, last, level }) => {
                counting::count(rule, (total, last, level), flow, trigger, slots)
            }
            (Self::Threshold(rule), StepState::Threshold { above }) => rule.apply(above, flow),
            (Self::Rate(period), StepState::Rate { last }) => rate(*period, last, flow, now),
            (Self::Window(aggregate, span), StepState::Window(window)) => {
                windows::push(*aggregate, *span, window, flow, now)
            }
            (Self::Expression(expression), _) => expression.apply(flow, slots),
            (Self::Format(template), _) => format(template, flow, slots),
            (Self::Merge(merge), _) => merge.apply(slots),
            (Self::Script, _) => Applied::Call(flow),
            (function, _) => {
                let Flow { value, meta } = flow;
                match function.map(value) {
                    Ok(value) => Applied::Pass(Flow { value, meta }),
                    Err(fault) => Applied::Fail(fault, meta),
                }
            }
        }
    }

    /// The functions that need nothing but the value.
    fn map(&self, value: Variant) -> Result<Variant, Fault> {
        match self {
            Self::Select(parts) => path::select(&value, parts),
            Self::Constant(constant) => Ok((**constant).clone()),
            Self::Convert(to, rounding, overflow) => {
                convert::convert(&value, *to, *rounding, *overflow)
            }
            Self::Scale(by) => each_number(&value, |number| by.apply(number)),
            Self::Unit(factor) => each_number(&value, |number| factor.apply(number)),
            Self::Lookup(table) => table.find(&value),
            Self::Enumeration(texts) => texts.of(integer(&value)?),
            Self::Bit(bit) => Ok((integer(&value)? >> bit & 1 == 1).into()),
            Self::BitTexts(words) => Ok(words.of(integer(&value)?)),
            Self::Parse(pattern) => {
                let text = match value.as_scalar() {
                    Some(Scalar::LocalizedText(localized)) => localized.text.as_deref(),
                    other => other.and_then(Scalar::as_str),
                };
                pattern
                    .read(text.ok_or_else(|| Fault::type_mismatch("parse takes a text"))?)
                    .map(Variant::Scalar)
            }
            _ => Ok(value),
        }
    }

    /// Returns the time at which the function yields without a new value.
    pub(super) fn due(&self, state: &StepState) -> Option<DateTime> {
        match (self, state) {
            (Self::Debounce(_), StepState::Debounce { pending: Some(pending), .. }) => {
                Some(pending.due)
            }
            (Self::Window(aggregate, span), StepState::Window(window)) => {
                windows::due(*aggregate, *span, window)
            }
            _ => None,
        }
    }

    /// Time passed.
    pub(super) fn on_timer(&self, state: &mut StepState, now: DateTime) -> Applied {
        match (self, state) {
            (Self::Debounce(_), StepState::Debounce { shown, pending }) => match pending.take() {
                Some(waited) => {
                    let StoredValue { value, meta } = &waited.kept;
                    let flow = Flow { value: value.clone(), meta: *meta };
                    *shown = Some(Box::new(waited.kept));
                    Applied::Pass(flow)
                }
                None => Applied::Hold,
            },
            (Self::Window(aggregate, span), StepState::Window(window)) => {
                windows::expire(*aggregate, *span, window, now)
            }
            _ => Applied::Hold,
        }
    }
}

/// A scalar's or every element's number through a function.
fn each_number(
    value: &Variant,
    f: impl Fn(Number) -> Result<Number, Fault>,
) -> Result<Variant, Fault> {
    let Variant::Array(array) = value else { return Ok(f(number(value)?)?.to_scalar().into()) };
    let numbers = array.elements.iter().map(|element| {
        f(Number::of(element)
            .ok_or_else(|| Fault::type_mismatch("an array of numbers is needed here"))?)
    });
    Ok(array_of(numbers.collect::<Result<Vec<_>, _>>()?, array.dimensions.clone()))
}

impl ScaleBy {
    fn apply(&self, number: Number) -> Result<Number, Fault> {
        let scaled = number.times(self.factor).and_then(|product| product.divided_by(self.divisor));
        scaled
            .and_then(|quotient| quotient.plus(self.offset))
            .ok_or_else(|| Fault::out_of_range("the scaled number is beyond all integer types"))
    }
}

impl UnitFactor {
    fn apply(&self, number: Number) -> Result<Number, Fault> {
        // Whole numbers stay exact where the factor allows it; a double is not beyond 2^53.
        if let (Number::Integer(value), Some((multiply, divide))) = (number, self.exact) {
            let product = value.checked_mul(multiply);
            let product = product
                .ok_or_else(|| Fault::out_of_range("the number is beyond all integer types"))?;
            if product % divide == 0 {
                return Ok(Number::Integer(product / divide));
            }
        }
        unece::convert(number.as_f64(), &self.from, &self.to)
            .map(Number::Real)
            .map_err(|error| Fault::type_mismatch(error.to_string()))
    }
}

fn debounce(
    shown: Option<&StoredValue>,
    pending: &mut Option<Box<Pending>>,
    flow: Flow,
    due: DateTime,
) -> Applied {
    let Flow { value, meta } = flow;
    match pending {
        // Its time goes on, since the value did not change; only status and times are newer.
        Some(waiting) if waiting.kept.value == value => waiting.kept.meta = meta,
        _ if shown.is_some_and(|shown| shown.value == value) => *pending = None,
        _ => *pending = Some(Box::new(Pending { kept: StoredValue { value, meta }, due })),
    }
    Applied::Hold
}

impl Band {
    fn apply(&self, passed: &mut Option<Box<StoredValue>>, flow: Flow) -> Applied {
        if let Some(last) = passed
            && last.meta.status == flow.meta.status
            && self.holds(&last.value, &flow.value)
        {
            return Applied::Hold;
        }
        *passed = Some(Box::new(StoredValue { value: flow.value.clone(), meta: flow.meta }));
        Applied::Pass(flow)
    }

    fn holds(&self, last: &Variant, new: &Variant) -> bool {
        let (Ok(a), Ok(b)) = (number(last), number(new)) else { return last == new };
        let Some(change) = b.minus(a).and_then(Number::magnitude) else { return false };
        match (self.absolute, self.percent) {
            (None, None) => change.is_zero(),
            (absolute, percent) => {
                absolute.is_none_or(|limit| change <= limit)
                    && percent
                        .is_none_or(|share| change.as_f64() <= a.as_f64().abs() * share / 100.0)
            }
        }
    }
}

impl ThresholdRule {
    fn apply(&self, above: &mut bool, flow: Flow) -> Applied {
        let Flow { value, meta } = flow;
        match number(&value) {
            Ok(number) => {
                *above = number >= if *above { self.release } else { self.limit };
                let value = if *above { &self.above } else { &self.below };
                Applied::Pass(Flow { value: value.clone(), meta })
            }
            Err(fault) => Applied::Fail(fault, meta),
        }
    }
}

fn rate(period_s: f64, last: &mut Option<RatePoint>, flow: Flow, now: DateTime) -> Applied {
    let Flow { value, meta } = flow;
    let value = match number(&value) {
        Ok(number) => number,
        Err(fault) => return Applied::Fail(fault, meta),
    };
    let at = meta.source_timestamp.unwrap_or(now);
    let before = match last {
        // Two values of one instant have no rate between them; the later one counts.
        Some(before) if before.at >= at => {
            *last = Some(RatePoint { value, at });
            return Applied::Hold;
        }
        before => before.replace(RatePoint { value, at }),
    };
    let Some(before) = before else { return Applied::Hold };
    let change = value.minus(before.value).map_or(f64::INFINITY, Number::as_f64);
    let per_second = change / at.since(before.at).as_secs_f64();
    Applied::Pass(Flow { value: (per_second * period_s).into(), meta })
}

impl Texts {
    fn of(&self, number: i128) -> Result<Variant, Fault> {
        let found = i64::try_from(number)
            .ok()
            .and_then(|n| self.texts.binary_search_by_key(&n, |(n, _)| *n).ok());
        let text = match found.and_then(|index| self.texts.get(index)) {
            Some((_, text)) => text.clone(),
            None => self.otherwise.clone().unwrap_or_else(|| number.to_string().into()),
        };
        Ok(Scalar::String(Some(text)).into())
    }
}

impl BitWords {
    fn of(&self, number: i128) -> Variant {
        let words: Vec<&str> = self
            .bits
            .iter()
            .filter(|(bit, _)| number >> bit & 1 == 1)
            .map(|(_, text)| &**text)
            .collect();
        if words.is_empty() { (&*self.none).into() } else { words.join(&self.separator).into() }
    }
}

impl CompiledExpression {
    fn apply(&self, flow: Flow, slots: &[Slot]) -> Applied {
        let mut meta = if self.uses_value { flow.meta } else { Meta::default() };
        for meta_of_input in self.inputs.iter().filter_map(|index| slots.get(*index)?.meta()) {
            meta.combine(&meta_of_input);
        }
        if !self.uses_value && self.inputs.is_empty() {
            meta = flow.meta;
        }
        let lookup = |name| match name {
            Name::Value => Value::of(&flow.value),
            Name::Input(index) => {
                Value::of(slots.get(index).and_then(Slot::variant).unwrap_or(&Variant::Null))
            }
        };
        match self.expression.evaluate(&lookup) {
            Ok(value) => Applied::Pass(Flow { value: value.into_variant(), meta }),
            Err(fault) => Applied::Fail(fault, meta),
        }
    }
}

fn format(template: &Template, flow: Flow, slots: &[Slot]) -> Applied {
    let mut meta = flow.meta;
    for source in template.sources() {
        if let Source::Input(index) = source
            && let Some(of_input) = slots.get(index).and_then(Slot::meta)
        {
            meta.combine(&of_input);
        }
    }
    let lookup = |source| match source {
        Source::Value => flow.value.as_scalar(),
        Source::Input(index) => {
            slots.get(index).and_then(Slot::variant).and_then(Variant::as_scalar)
        }
    };
    match template.fill(&lookup) {
        Ok(text) => Applied::Pass(Flow { value: text.into(), meta }),
        Err(fault) => Applied::Fail(fault, meta),
    }
}
