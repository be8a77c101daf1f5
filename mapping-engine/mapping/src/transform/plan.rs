//! A mapping in the form it runs in.

use std::{sync::Arc, time::Duration};

use asi_model::{BuiltInType, Variant, units::EngineeringUnit};

use super::table::Table;
use crate::{
    convert::{self, Overflow, Rounding},
    document::{
        Aggregate, CounterInput, EdgeDirection, LateValues, Mapping, MergeRule, OnDecrease,
    },
    expression::Expr,
    fault::Fault,
    number::Number,
    path::PathElement,
    state::{StepState, WindowState},
    text::{Pattern, Source, Template},
};

/// Compiled chain, independent of the variables and the field of its mapping.
#[derive(Debug)]
pub struct Plan {
    /// The mapping it was made for: the first of those that share it.
    pub made_for: Arc<Mapping>,
    pub(crate) target_type: BuiltInType,
    pub(crate) target_rank: i32,
    pub(crate) late_values: LateValues,
    pub(crate) functions: Box<[Function]>,
    pub(crate) inputs: Box<[PlannedInput]>,
    /// Functions at which an input enters that does not come through the chain.
    pub(crate) carried: Box<[usize]>,
    pub(crate) head_uses_value: bool,
}

/// Role of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PlannedInput {
    /// The first function that uses it; `None`: nothing does.
    pub entry: Option<usize>,
    pub triggers: bool,
    /// True where nothing is said before it has a value, and its status counts.
    pub is_required: bool,
    /// Enters at a `merge` that picks one of its inputs.
    pub is_picked: bool,
}

#[derive(Debug)]
pub(crate) enum Function {
    Select(Box<[PathElement]>),
    Constant(Box<Variant>),
    Convert(BuiltInType, Rounding, Overflow),
    Scale(Box<ScaleBy>),
    Unit(Box<UnitFactor>),
    Increment(Box<CountRule>),
    Counter(Box<CounterRule>),
    Edge(EdgeDirection),
    Threshold(Box<ThresholdRule>),
    Debounce(Duration),
    Deadband(Box<Band>),
    /// The period in seconds.
    Rate(f64),
    Window(Aggregate, Span),
    Lookup(Box<Table>),
    Enumeration(Box<Texts>),
    Bit(u8),
    BitTexts(Box<BitWords>),
    Format(Box<Template>),
    Parse(Box<Pattern>),
    Expression(Box<CompiledExpression>),
    Merge(Box<MergeOf>),
    Script,
}

#[derive(Debug)]
pub(crate) struct ScaleBy {
    pub factor: Number,
    pub divisor: Number,
    pub offset: Number,
}

/// Conversion from unit to unit; on integers `value * multiply / divide` where that says the same
/// exactly.
#[derive(Debug)]
pub(crate) struct UnitFactor {
    pub from: EngineeringUnit,
    pub to: EngineeringUnit,
    pub exact: Option<(i128, i128)>,
}

#[derive(Debug)]
pub(crate) struct CountRule {
    pub modulus: Option<Number>,
    pub on_decrease: OnDecrease,
}

#[derive(Debug)]
pub(crate) struct CounterRule {
    pub counts: Option<CounterInput>,
    pub start: Number,
    pub rule: CountRule,
    pub reset_by: Option<usize>,
}

#[derive(Debug)]
pub(crate) struct ThresholdRule {
    pub limit: Number,
    pub release: Number,
    pub above: Variant,
    pub below: Variant,
}

#[derive(Debug)]
pub(crate) struct Band {
    pub absolute: Option<Number>,
    pub percent: Option<f64>,
}

/// Extent of a window.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Span {
    Samples(usize),
    Time(Duration),
}

#[derive(Debug)]
pub(crate) struct Texts {
    /// Sorted by number.
    pub texts: Box<[(i64, Arc<str>)]>,
    pub otherwise: Option<Arc<str>>,
}

#[derive(Debug)]
pub(crate) struct BitWords {
    pub bits: Box<[(u8, Box<str>)]>,
    pub separator: Box<str>,
    pub none: Box<str>,
}

#[derive(Debug)]
pub(crate) struct CompiledExpression {
    pub expression: Expr,
    pub inputs: Box<[usize]>,
    pub uses_value: bool,
}

#[derive(Debug)]
pub(crate) struct MergeOf {
    pub inputs: Box<[usize]>,
    pub rule: MergeRule,
    pub separator: Box<str>,
}

impl MergeOf {
    /// Returns true where the rule picks one of the inputs, so that the others do not count.
    pub const fn picks(&self) -> bool {
        matches!(self.rule, MergeRule::Newest | MergeRule::FirstGood)
    }
}

impl Plan {
    /// Returns the state before the first value; empty where no function has state.
    pub(crate) fn fresh_state(&self) -> Vec<StepState> {
        if self.functions.iter().all(|function| function.fresh_state() == StepState::None) {
            return Vec::new();
        }
        self.functions.iter().map(Function::fresh_state).collect()
    }

    /// Returns the value at the end of the chain as one of the target's type.
    ///
    /// # Errors
    /// A [`Fault`] where type or rank do not fit, or the number is none of the type's.
    pub(super) fn coerce(&self, value: Variant) -> Result<Variant, Fault> {
        let is_rank = match &value {
            Variant::Null => true,
            Variant::Scalar(_) => self.target_rank < 1,
            Variant::Array(array) => {
                let rank = array.dimensions.as_ref().map_or(1, Vec::len);
                // 0 is an array of any number of dimensions.
                usize::try_from(self.target_rank).is_ok_and(|wanted| wanted == rank || wanted == 0)
            }
        };
        if !is_rank {
            return Err(Fault::type_mismatch(
                "the chain yields an array where the field is a single value, or the reverse",
            ));
        }
        convert::coerce(value, self.target_type)
    }

    /// The steps that are scripts.
    pub fn script_steps(&self) -> impl Iterator<Item = usize> + '_ {
        self.functions
            .iter()
            .enumerate()
            .filter(|(_, f)| matches!(f, Function::Script))
            .map(|(step, _)| step)
    }

    /// The function's name, as in JSON.
    pub fn name_of(&self, step: usize) -> &'static str {
        self.made_for.steps.get(step).map_or("", |step| step.function())
    }
}

impl Function {
    /// Returns true where the function reads the chain's value.
    pub fn uses_value(&self) -> bool {
        match self {
            Self::Constant(_) | Self::Merge(_) => false,
            Self::Expression(expression) => expression.uses_value,
            Self::Format(template) => template.sources().any(|source| source == Source::Value),
            _ => true,
        }
    }

    /// The inputs it reads besides the chain's value.
    pub fn inputs(&self, count: usize) -> Vec<usize> {
        match self {
            Self::Expression(expression) => expression.inputs.to_vec(),
            Self::Format(template) => template
                .sources()
                .filter_map(|source| match source {
                    Source::Input(index) => Some(index),
                    Source::Value => None,
                })
                .collect(),
            Self::Merge(merge) => merge.inputs.to_vec(),
            Self::Counter(counter) => counter.reset_by.into_iter().collect(),
            Self::Script => (0..count).collect(),
            _ => Vec::new(),
        }
    }

    fn fresh_state(&self) -> StepState {
        match self {
            Self::Increment(_) => StepState::Increment { last: None },
            Self::Counter(rule) => {
                StepState::Counter { total: rule.start, last: None, level: None }
            }
            Self::Edge(_) => StepState::Edge { level: None },
            Self::Threshold(_) => StepState::Threshold { above: false },
            Self::Debounce(_) => StepState::Debounce { shown: None, pending: None },
            Self::Deadband(_) => StepState::Deadband { passed: None },
            Self::Rate(_) => StepState::Rate { last: None },
            Self::Window(..) => StepState::Window(WindowState::default()),
            Self::Script => StepState::Script { state: None },
            _ => StepState::None,
        }
    }
}
