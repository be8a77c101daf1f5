//! State of functions between values, in a form that can be stored and restored.

use std::{collections::VecDeque, sync::Arc};

use asi_model::{DateTime, StatusCode, Variant};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::{document::Step, number::Number, quality::Meta, stored};

/// State of a mapping's functions. It is returned with the candidate that it belongs to, so that
/// both can be committed together, and given back when the mapping is published again. Copies are
/// cheap; it is serialised when it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema, ToSchema)]
#[serde(transparent)]
#[schemars(with = "Vec<serde_json::Value>")]
#[schema(value_type = Vec<Object>)]
pub struct TransformState(pub(crate) Arc<[StepState]>);

impl TransformState {
    /// Returns the part of this state, left by a mapping with the steps `before`, with which a
    /// mapping with the steps `after` may continue: that of every function at the same index with
    /// the same parameters. A script's state survives as long as there is a script at its index, so
    /// that a corrected script continues to count.
    #[must_use]
    pub fn carried_over(&self, before: &[Step], after: &[Step]) -> Self {
        let is_same = |index: usize| match (before.get(index), after.get(index)) {
            (Some(Step::Script(_)), Some(Step::Script(_))) => true,
            (Some(before), Some(after)) => before == after,
            _ => false,
        };
        let kept = self
            .0
            .iter()
            .enumerate()
            .map(|(index, state)| if is_same(index) { state.clone() } else { StepState::None });
        Self::new(kept.collect())
    }

    pub(crate) fn new(steps: Vec<StepState>) -> Self {
        // Nearly all mappings remember nothing, and the empty slice needs no memory of its own.
        Self(if steps.is_empty() { Arc::default() } else { steps.into() })
    }
}

/// State of one function.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(tag = "function", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub(crate) enum StepState {
    /// The function remembers nothing.
    #[default]
    None,
    Increment {
        last: Option<Number>,
    },
    Counter {
        total: Number,
        last: Option<Number>,
        level: Option<bool>,
    },
    Edge {
        level: Option<bool>,
    },
    Threshold {
        above: bool,
    },
    Debounce {
        shown: Option<Box<StoredValue>>,
        pending: Option<Box<Pending>>,
    },
    Deadband {
        passed: Option<Box<StoredValue>>,
    },
    Rate {
        last: Option<RatePoint>,
    },
    Window(WindowState),
    Script {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        state: Option<Arc<str>>,
    },
}

impl StepState {
    /// Returns true where this can be the state of a function whose initial state is `fresh`.
    pub fn is_like(&self, fresh: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(fresh)
    }
}

/// A value that is remembered with its status and times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredValue {
    #[serde(with = "stored::variant")]
    pub value: Variant,
    #[serde(with = "stored::meta", flatten)]
    pub meta: Meta,
}

/// A value that waits for being stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pending {
    pub kept: StoredValue,
    /// Time at which it passes, by the local clock.
    pub due: DateTime,
}

/// The last value of a rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct RatePoint {
    pub value: Number,
    pub at: DateTime,
}

/// The values in a window, oldest first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct WindowState {
    pub samples: VecDeque<Sample>,
    /// Arrival time of the newest by the local clock; relates the source's clock to ours.
    pub received_at: DateTime,
}

/// A value in a window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Sample {
    pub at: DateTime,
    pub value: Number,
    pub status: StatusCode,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_mapping_keeps_the_state_of_what_did_not_change() {
        let steps = |json: &str| -> Vec<Step> { serde_json::from_str(json).expect("steps") };
        let counter = r#"{"function":"counter"}"#;
        let before = steps(&format!(
            r#"[{counter},{{"function":"deadband","absolute":1}},{{"function":"script","source":"a"}}]"#
        ));
        let after = steps(&format!(
            r#"[{counter},{{"function":"deadband","absolute":2}},{{"function":"script","source":"b"}}]"#
        ));
        let total = StepState::Counter { total: Number::Integer(7), last: None, level: None };
        let script = StepState::Script { state: Some("1".into()) };
        let state = TransformState::new(vec![
            total.clone(),
            StepState::Deadband { passed: None },
            script.clone(),
        ]);
        assert_eq!(
            state.carried_over(&before, &after),
            TransformState::new(vec![total, StepState::None, script])
        );
        assert_eq!(state.carried_over(&before, &[]), TransformState::new(vec![StepState::None; 3]));
    }
}
