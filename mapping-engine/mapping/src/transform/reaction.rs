//! Reactions of a transform to an event.

use std::sync::Arc;

use asi_model::{DataValue, StatusCode, Variant};

use super::flow::Flow;
use crate::{fault::Fault, quality::Meta};

/// Reaction to an event.
#[derive(Debug, Clone, PartialEq)]
pub enum Reaction {
    Quiet,
    /// A new candidate for the field.
    Candidate(DataValue),
    /// A candidate without value because a function failed.
    Failed(DataValue, FailedStep),
    /// A script is to be called; the chain goes on with [`super::Transform::resume`].
    Call(ScriptCall),
}

/// Fault with its step; `None` is the end of the chain.
#[derive(Debug, Clone, PartialEq)]
pub struct FailedStep {
    pub step: Option<usize>,
    pub fault: Fault,
}

/// A script to be called.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptCall {
    pub step: usize,
    pub flow: Flow,
    /// Inputs that changed since the last call of this script.
    pub inputs: Vec<(usize, DataValue)>,
    /// Inputs whose source is away or that are otherwise worse decide the result's status too.
    pub input_meta: Meta,
}

impl ScriptCall {
    /// A call that never was, to carry the fault of a script that is not there.
    pub fn without_value(step: usize) -> Self {
        let flow = Flow { value: Variant::Null, meta: Meta::default() };
        Self { step, flow, inputs: Vec::new(), input_meta: Meta::default() }
    }
}

/// Result of a script.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptYield {
    /// `None`: the script returned `undefined`.
    pub value: Option<(Variant, StatusCode)>,
    /// `ctx.state` where it changed.
    pub state: Option<Arc<str>>,
}
