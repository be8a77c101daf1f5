//! The functions with their parameters checked.

use std::time::Duration;

use super::{Chain, Code, Compiler};
use crate::{
    document::{
        Bit, BitTexts, Counter, Deadband, Enumeration, Lookup, Merge, MergeRule, OnDecrease, Parse,
        RatePeriod, Scale, Script, Step, Threshold, Window,
    },
    expression,
    number::Number,
    path, script_source,
    text::{Pattern, Template},
    transform::{
        plan::{
            Band, BitWords, CompiledExpression, CountRule, CounterRule, Function, MergeOf, ScaleBy,
            Span, Texts, ThresholdRule,
        },
        table::Table,
        windows::SAMPLES_MAX,
    },
};

/// Longest span of a debounce or window.
const SPAN_MAX: Duration = Duration::from_secs(366 * 24 * 3600);
/// Most entries of a table.
const ENTRIES_MAX: usize = 1024;
/// Longest text parameter, in bytes.
const TEXT_BYTES_MAX: usize = 4096;

impl Compiler<'_> {
    pub(super) fn function(
        &mut self,
        pointer: &str,
        step: &Step,
        chain: &mut Chain,
    ) -> Option<Function> {
        Some(match step {
            Step::Select(select) => match path::parse(&select.path) {
                Ok(parts) => Function::Select(parts),
                Err(message) => return self.invalid(pointer, "path", message),
            },
            Step::Constant(constant) => {
                chain.unit = None;
                Function::Constant(constant.value.to_variant().into())
            }
            Step::Convert(convert) => {
                Function::Convert(convert.to.0, convert.rounding, convert.overflow)
            }
            Step::Scale(scale) => self.scale(pointer, scale)?,
            Step::UnitConversion(conversion) => self.unit_conversion(pointer, conversion, chain)?,
            Step::Increment(increment) => Function::Increment(
                self.count_rule(pointer, increment.modulus, increment.on_decrease)?.into(),
            ),
            Step::Counter(counter) => self.counter(pointer, counter)?,
            Step::Edge(edge) => Function::Edge(edge.direction),
            Step::Threshold(threshold) => self.threshold(pointer, threshold)?,
            Step::Debounce(debounce) => {
                Function::Debounce(self.span(pointer, "quietMs", debounce.quiet_ms)?)
            }
            Step::Deadband(deadband) => self.deadband(pointer, deadband)?,
            Step::Rate(rate) => Function::Rate(match rate.per {
                RatePeriod::Second => 1.0,
                RatePeriod::Minute => 60.0,
                RatePeriod::Hour => 3600.0,
                RatePeriod::Day => 86_400.0,
            }),
            Step::Window(window) => self.window(pointer, window)?,
            Step::Lookup(lookup) => self.lookup(pointer, lookup)?,
            Step::Enumeration(enumeration) => self.enumeration(pointer, enumeration)?,
            Step::Bit(Bit { bit }) if *bit > 63 => {
                return self.invalid(pointer, "bit", "bits go from 0 to 63");
            }
            Step::Bit(Bit { bit }) => Function::Bit(*bit),
            Step::BitTexts(texts) => self.bit_texts(pointer, texts)?,
            Step::Format(format) => self.format(pointer, &format.template)?,
            Step::Parse(parse) => self.parse(pointer, parse)?,
            Step::Expression(expression) => self.expression(pointer, &expression.expression)?,
            Step::Merge(merge) => self.merge(pointer, merge)?,
            Step::Script(script) => self.script(pointer, script, chain)?,
        })
    }

    /// Reports a wrong parameter. The result is `None`, so that callers can leave with it.
    pub(super) fn invalid<T>(
        &mut self,
        pointer: &str,
        member: &str,
        message: impl Into<String>,
    ) -> Option<T> {
        self.error(format!("{pointer}/{member}"), Code::InvalidParameter, message);
        None
    }

    fn span(&mut self, pointer: &str, member: &str, millis: u64) -> Option<Duration> {
        let span = Duration::from_millis(millis);
        if span.is_zero() || span > SPAN_MAX {
            return self.invalid(pointer, member, "a span of time is 1 ms to 366 days");
        }
        Some(span)
    }

    fn scale(&mut self, pointer: &str, scale: &Scale) -> Option<Function> {
        let Scale { factor, divisor, offset } = *scale;
        if divisor.is_zero() {
            return self.invalid(pointer, "divisor", "the divisor must not be zero");
        }
        if !(factor.is_finite() && divisor.is_finite() && offset.is_finite()) {
            return self.invalid(
                pointer,
                "factor",
                "factor, divisor and offset are finite numbers",
            );
        }
        Some(Function::Scale(ScaleBy { factor, divisor, offset }.into()))
    }

    fn count_rule(
        &mut self,
        pointer: &str,
        modulus: Option<Number>,
        on_decrease: OnDecrease,
    ) -> Option<CountRule> {
        if modulus.is_some_and(|modulus| !modulus.is_finite() || modulus <= Number::ZERO) {
            return self.invalid(
                pointer,
                "modulus",
                "the modulus is a number above zero, as 65536 for a UInt16",
            );
        }
        Some(CountRule { modulus, on_decrease })
    }

    fn counter(&mut self, pointer: &str, counter: &Counter) -> Option<Function> {
        let rule = self.count_rule(pointer, counter.modulus, counter.on_decrease)?;
        let reset_by = match &counter.reset_by {
            Some(name) => Some(self.input(format!("{pointer}/resetBy"), name)?),
            None => None,
        };
        Some(Function::Counter(
            CounterRule { counts: counter.counts, start: counter.start, rule, reset_by }.into(),
        ))
    }

    fn threshold(&mut self, pointer: &str, threshold: &Threshold) -> Option<Function> {
        let limit = threshold.limit;
        let release = threshold.release.unwrap_or(limit);
        if !limit.is_finite() || !release.is_finite() || release > limit {
            let rule = "release is a number that is not above the limit";
            return self.invalid(pointer, "release", rule);
        }
        let above = Self::literal(threshold.above.as_ref(), true);
        let below = Self::literal(threshold.below.as_ref(), false);
        Some(Function::Threshold(ThresholdRule { limit, release, above, below }.into()))
    }

    fn parse(&mut self, pointer: &str, parse: &Parse) -> Option<Function> {
        let is_radix = |radix| (2..=36).contains(&radix) && parse.to.0.is_integer();
        if parse.radix.is_some_and(|radix| !is_radix(radix)) {
            let rule = "a radix is 2 to 36, and goes with an integer type";
            return self.invalid(pointer, "radix", rule);
        }
        match Pattern::new(parse) {
            Ok(pattern) => Some(Function::Parse(pattern.into())),
            Err(message) => self.invalid(pointer, "pattern", message),
        }
    }

    fn deadband(&mut self, pointer: &str, deadband: &Deadband) -> Option<Function> {
        let Deadband { absolute, percent } = *deadband;
        if absolute.is_some_and(|limit| !limit.is_finite() || limit < Number::ZERO) {
            return self.invalid(
                pointer,
                "absolute",
                "the deadband is a number that is not below zero",
            );
        }
        if percent.is_some_and(|share| !(0.0..=100.0).contains(&share)) {
            return self.invalid(pointer, "percent", "the share is a number from 0 to 100");
        }
        Some(Function::Deadband(Band { absolute, percent }.into()))
    }

    fn window(&mut self, pointer: &str, window: &Window) -> Option<Function> {
        let span = match (window.samples, window.duration_ms) {
            (Some(samples), None) => {
                let samples = usize::try_from(samples).unwrap_or(usize::MAX);
                if samples == 0 || samples > SAMPLES_MAX {
                    return self.invalid(
                        pointer,
                        "samples",
                        format!("a window has 1 to {SAMPLES_MAX} values"),
                    );
                }
                Span::Samples(samples)
            }
            (None, Some(millis)) => Span::Time(self.span(pointer, "durationMs", millis)?),
            _ => {
                return self.invalid(
                    pointer,
                    "samples",
                    "a window has either samples or durationMs",
                );
            }
        };
        Some(Function::Window(window.aggregate, span))
    }

    fn lookup(&mut self, pointer: &str, lookup: &Lookup) -> Option<Function> {
        if lookup.entries.len() > ENTRIES_MAX {
            return self.invalid(
                pointer,
                "entries",
                format!("a table has at most {ENTRIES_MAX} entries"),
            );
        }
        match Table::new(lookup) {
            Ok(table) => Some(Function::Lookup(table.into())),
            Err((index, message)) => {
                self.invalid(&format!("{pointer}/entries"), &index.to_string(), message)
            }
        }
    }

    fn enumeration(&mut self, pointer: &str, enumeration: &Enumeration) -> Option<Function> {
        if enumeration.texts.len() > ENTRIES_MAX {
            return self.invalid(
                pointer,
                "texts",
                format!("an enumeration has at most {ENTRIES_MAX} texts"),
            );
        }
        let mut texts: Vec<_> = enumeration
            .texts
            .iter()
            .map(|entry| (entry.value, entry.text.as_str().into()))
            .collect();
        texts.sort_by_key(|(number, _)| *number);
        if let Some(twice) = texts.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return self.invalid(
                pointer,
                "texts",
                format!("{} stands in the enumeration twice", twice[0].0),
            );
        }
        let otherwise = enumeration.otherwise.as_deref().map(Into::into);
        Some(Function::Enumeration(Texts { texts: texts.into(), otherwise }.into()))
    }

    fn bit_texts(&mut self, pointer: &str, texts: &BitTexts) -> Option<Function> {
        if texts.bits.is_empty()
            || texts.bits.iter().any(|bit| bit.bit > 63)
            || texts.bits.len() > 64
        {
            return self.invalid(pointer, "bits", "there are 1 to 64 bits, from 0 to 63");
        }
        let mut bits: Vec<_> =
            texts.bits.iter().map(|bit| (bit.bit, bit.text.as_str().into())).collect();
        bits.sort_by_key(|(bit, _)| *bit);
        let (separator, none) = (texts.separator.as_str().into(), texts.none.as_str().into());
        Some(Function::BitTexts(BitWords { bits: bits.into(), separator, none }.into()))
    }

    fn format(&mut self, pointer: &str, template: &str) -> Option<Function> {
        if template.len() > TEXT_BYTES_MAX {
            return self.invalid(
                pointer,
                "template",
                format!("a template has at most {TEXT_BYTES_MAX} bytes"),
            );
        }
        let mapping = self.mapping;
        match Template::parse(template, &|name| mapping.input_index(name)) {
            Ok(template) => Some(Function::Format(template.into())),
            Err((message, column)) => {
                self.syntax(&format!("{pointer}/template"), message, 1, column)
            }
        }
    }

    fn expression(&mut self, pointer: &str, text: &str) -> Option<Function> {
        let mapping = self.mapping;
        match expression::parse(text, &|name| mapping.input_index(name)) {
            Ok(expression) => {
                let names = expression.names();
                let (inputs, uses_value) = (names.inputs.into(), names.value);
                Some(Function::Expression(
                    CompiledExpression { expression, inputs, uses_value }.into(),
                ))
            }
            Err(error) => {
                self.syntax(&format!("{pointer}/expression"), error.message, 1, error.column)
            }
        }
    }

    fn syntax<T>(&mut self, pointer: &str, message: String, line: u32, column: u32) -> Option<T> {
        let diagnostic = super::MappingDiagnostic::error(pointer, Code::Syntax, message);
        self.diagnostics.push(diagnostic.at(Some(line), Some(column)));
        None
    }

    fn merge(&mut self, pointer: &str, merge: &Merge) -> Option<Function> {
        let mut inputs = Vec::new();
        if merge.inputs.is_empty() {
            inputs.extend(0..self.mapping.inputs.len());
        }
        for (index, name) in merge.inputs.iter().enumerate() {
            inputs.extend(self.input(format!("{pointer}/inputs/{index}"), name));
        }
        if inputs.is_empty() {
            return self.invalid(pointer, "inputs", "there are no inputs to merge");
        }
        if merge.separator.is_some() && merge.rule != MergeRule::Join {
            self.warn(
                format!("{pointer}/separator"),
                Code::InvalidParameter,
                "only join has a separator",
            );
        }
        let separator = merge.separator.as_deref().unwrap_or("").into();
        Some(Function::Merge(MergeOf { inputs: inputs.into(), rule: merge.rule, separator }.into()))
    }

    fn script(&mut self, pointer: &str, script: &Script, chain: &mut Chain) -> Option<Function> {
        chain.unit = None;
        if let Err(message) = script_source::check(&script.source) {
            return self.invalid(pointer, "source", message);
        }
        for (line, column, message) in script_source::closure_state(&script.source) {
            let pointer = format!("{pointer}/source");
            let warning = super::MappingDiagnostic::warning(pointer, Code::ClosureState, message);
            self.diagnostics.push(warning.at(Some(line), Some(column)));
        }
        Some(Function::Script)
    }
}
