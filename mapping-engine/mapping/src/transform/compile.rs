//! Compiler from a mapping to its plan, with everything that is wrong or doubtful about it.

mod steps;
mod types;
mod units;

use std::{collections::HashSet, sync::Arc};

use asi_model::{BuiltInType, Variant, units as unece};

use super::plan::{Function, Plan, PlannedInput};
use crate::{
    convert,
    diagnostic::{DiagnosticCode as Code, MappingDiagnostic},
    document::{INPUTS_MAX, Mapping, SCRIPT_STEPS_MAX, STEPS_MAX, Step},
};
use types::{check_input, output_type};

/// Compiles a mapping. There is a plan unless one of the diagnostics is an error.
pub fn compile(mapping: &Arc<Mapping>) -> (Option<Plan>, Vec<MappingDiagnostic>) {
    let mut compiler = Compiler { mapping, diagnostics: Vec::new() };
    compiler.inputs();
    if mapping.steps.len() > STEPS_MAX {
        compiler.error(
            "/steps".to_owned(),
            Code::TooMany,
            format!("a mapping has at most {STEPS_MAX} functions"),
        );
    }
    let mut chain = Chain {
        value: mapping.inputs.first().and_then(|input| input.value_type).map(|t| t.0),
        unit: mapping.inputs.first().and_then(|input| input.unit.clone()),
        scripts: 0,
    };
    let mut functions = Vec::with_capacity(mapping.steps.len());
    for (index, step) in mapping.steps.iter().take(STEPS_MAX).enumerate() {
        let pointer = format!("/steps/{index}");
        if let Some(Err(mismatch)) = chain.value.map(|value| check_input(step, value)) {
            let pointer = format!("{pointer}{}", mismatch.member);
            compiler.error(pointer, Code::TypeMismatch, mismatch.message);
        }
        functions.extend(compiler.step(&pointer, index, step, &mut chain));
        chain.value = output_type(mapping, step, functions.last(), chain.value);
    }
    compiler.target(&chain);
    let plan = if compiler.diagnostics.iter().any(MappingDiagnostic::is_error) {
        None
    } else {
        let plan = compiler.plan(functions);
        compiler.unused(&plan);
        Some(plan)
    };
    (plan, compiler.diagnostics)
}

/// Known properties of the value at a step of the chain.
struct Chain {
    value: Option<BuiltInType>,
    unit: Option<String>,
    scripts: usize,
}

struct Compiler<'a> {
    mapping: &'a Arc<Mapping>,
    diagnostics: Vec<MappingDiagnostic>,
}

impl Compiler<'_> {
    fn error(&mut self, pointer: String, code: Code, message: impl Into<String>) {
        self.diagnostics.push(MappingDiagnostic::error(pointer, code, message));
    }

    fn warn(&mut self, pointer: String, code: Code, message: impl Into<String>) {
        self.diagnostics.push(MappingDiagnostic::warning(pointer, code, message));
    }

    fn inputs(&mut self) {
        let mapping = self.mapping;
        if mapping.inputs.len() > INPUTS_MAX {
            self.error(
                "/inputs".to_owned(),
                Code::TooMany,
                format!("a mapping has at most {INPUTS_MAX} inputs"),
            );
        }
        let mut names = HashSet::new();
        for (index, input) in mapping.inputs.iter().enumerate() {
            let pointer = format!("/inputs/{index}/name");
            if !is_input_name(&input.name) {
                let rule = "an input's name is a letter or _ followed by letters, digits or _, at most 64, and not \
                            value, ctx, true or false";
                self.error(pointer.clone(), Code::InvalidName, rule);
            }
            if !names.insert(input.name.as_str()) {
                self.error(
                    pointer,
                    Code::InvalidName,
                    format!("another input is named \"{}\" too", input.name),
                );
            }
            if let Some(unit) = &input.unit
                && unece::lookup(unit).is_none()
            {
                let message =
                    format!("the unit \"{unit}\" of the input is not a known UNECE code or name");
                self.warn(format!("/inputs/{index}/unit"), Code::UnknownUnit, message);
            }
        }
        if let Some(unit) = &mapping.target_unit
            && unece::lookup(unit).is_none()
        {
            let message =
                format!("the unit \"{unit}\" asked for is not a known UNECE code or name");
            self.warn("/targetUnit".to_owned(), Code::UnknownUnit, message);
        }
        if !mapping.inputs.is_empty() && !mapping.inputs.iter().any(|input| input.triggers) {
            let message = "no input triggers, so the mapping never runs: let one trigger";
            self.error("/inputs".to_owned(), Code::Missing, message);
        }
        if mapping.inputs.is_empty() && mapping.steps.is_empty() {
            self.error(
                "/inputs".to_owned(),
                Code::Missing,
                "the mapping has neither inputs nor functions",
            );
        }
    }

    /// Checks that the chain's result fits the field.
    fn target(&mut self, chain: &Chain) {
        let target = self.mapping.target_type.0;
        if let Some(from) = chain.value {
            let pointer = "/targetType".to_owned();
            if !convert::coerces(from, target) {
                let message =
                    format!("the chain yields a {from} but the field is a {target}: add a convert");
                self.error(pointer, Code::TypeMismatch, message);
            } else if matches!(from, BuiltInType::Float | BuiltInType::Double)
                && target.is_integer()
            {
                let message = format!(
                    "the chain yields a {from} but the field is a {target}: a value with a fraction is a fault; add a \
                     convert with a rounding"
                );
                self.warn(pointer, Code::LossyConversion, message);
            } else if from == BuiltInType::Double && target == BuiltInType::Float {
                self.warn(
                    pointer,
                    Code::LossyConversion,
                    "a Double becomes a Float: digits beyond the 7th get lost",
                );
            }
        }
        let known = |unit: &Option<String>| unit.as_deref().and_then(unece::lookup);
        if let (Some(have), Some(want)) = (known(&chain.unit), known(&self.mapping.target_unit))
            && have.code != want.code
        {
            let message = format!(
                "the chain yields {} but {} is asked for: add a unitConversion",
                have.description, want.description
            );
            self.warn("/targetUnit".to_owned(), Code::UnitMismatch, message);
        }
    }

    fn plan(&self, functions: Vec<Function>) -> Plan {
        let mapping = self.mapping;
        let head_uses_value = functions.first().is_none_or(Function::uses_value);
        let count = mapping.inputs.len();
        let uses: Vec<Vec<usize>> =
            functions.iter().map(|function| function.inputs(count)).collect();
        let picks = |step: usize| matches!(functions.get(step), Some(Function::Merge(merge)) if merge.picks());
        let mut carried = Vec::new();
        let inputs = mapping.inputs.iter().enumerate().map(|(index, input)| {
            let through_chain = index == 0 && head_uses_value;
            let mut users = (0..functions.len())
                .filter(|step| uses.get(*step).is_some_and(|u| u.contains(&index)));
            let entry = if through_chain { Some(0) } else { users.clone().next() };
            if let Some(step) = entry.filter(|step| *step > 0) {
                carried.push(step);
            }
            let is_picked = !through_chain && entry.is_some_and(picks);
            let is_required = through_chain || users.any(|step| !picks(step));
            PlannedInput { entry, triggers: input.triggers, is_required, is_picked }
        });
        let inputs = inputs.collect();
        carried.sort_unstable();
        carried.dedup();
        Plan {
            made_for: Arc::clone(mapping),
            target_type: mapping.target_type.0,
            target_rank: mapping.target_value_rank,
            late_values: mapping.late_values,
            functions: functions.into(),
            inputs,
            carried: carried.into(),
            head_uses_value,
        }
    }

    fn unused(&mut self, plan: &Plan) {
        for (index, input) in self.mapping.inputs.iter().enumerate() {
            if plan.inputs.get(index).is_some_and(|planned| planned.entry.is_none()) {
                let message = format!("no function uses the input \"{}\"", input.name);
                self.warn(format!("/inputs/{index}"), Code::UnusedInput, message);
            }
        }
    }

    /// Checks and adds a step. A constant or a script alone makes something of nothing.
    fn step(
        &mut self,
        pointer: &str,
        index: usize,
        step: &Step,
        chain: &mut Chain,
    ) -> Option<Function> {
        let makes_itself = matches!(
            step,
            Step::Constant(_) | Step::Merge(_) | Step::Expression(_) | Step::Format(_)
        );
        if index == 0 && self.mapping.inputs.is_empty() && !makes_itself {
            self.error(
                pointer.to_owned(),
                Code::Missing,
                format!("{} needs an input", step.function()),
            );
        }
        if matches!(step, Step::Script(_)) {
            chain.scripts += 1;
            if chain.scripts > SCRIPT_STEPS_MAX {
                let message = format!("a mapping has at most {SCRIPT_STEPS_MAX} scripts");
                self.error(pointer.to_owned(), Code::TooMany, message);
            }
        }
        self.function(pointer, step, chain)
    }

    fn input(&mut self, pointer: String, name: &str) -> Option<usize> {
        let found = self.mapping.input_index(name);
        if found.is_none() {
            self.error(pointer, Code::UnknownName, format!("there is no input \"{name}\""));
        }
        found
    }

    fn literal(literal: Option<&crate::document::Literal>, default: bool) -> Variant {
        literal.map_or_else(|| default.into(), crate::document::Literal::to_variant)
    }
}

fn is_input_name(name: &str) -> bool {
    let mut bytes = name.bytes();
    name.len() <= crate::document::INPUT_NAME_BYTES_MAX
        && bytes.next().is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && !matches!(name, "value" | "ctx" | "true" | "false" | "__proto__")
}
