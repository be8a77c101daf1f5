//! Suggestions of variables for a requested field, ranked, each with its reasons; a person decides.
//!
//! Pure: callers bring the variables (from browsing), a value of each where they have one, and the
//! factory's earlier decisions. Each piece of evidence gives points and a sentence; types and units
//! that cannot go together rule a variable out. The functions that would be needed (convert, unit
//! conversion) are proposed with it.

mod context;
mod evidence;
mod words;

use asi_model::{BuiltInType, NodeId, units as unece};
use serde::Serialize;
use shop_floor_model::SourceId;
use utoipa::ToSchema;

use crate::{
    convert::{self, Overflow, Rounding},
    document::{Convert, Step, TypeName, UnitConversion},
};
use context::unit;
pub use context::{KnownVariable, PastDecision, RequestedField};
use evidence::Evidence;
pub use evidence::{Reason, ReasonKind};

/// Fewer points are no suggestion.
const SCORE_MIN: i32 = 20;
/// Most points.
const SCORE_MAX: i32 = 100;

/// A variable that might be meant.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Suggestion {
    /// Source of the variable.
    pub source_id: SourceId,
    /// Node id with its namespace's URI.
    pub node_id: NodeId,
    /// Names down to the variable, joined by `/`.
    #[serde(rename = "place")]
    pub path: String,
    /// 20 to 100.
    pub score: u8,
    /// Evidence, the weightiest first.
    pub reasons: Vec<Reason>,
    /// The functions it would need.
    pub steps: Vec<Step>,
}

/// The variables that might be meant, best first, at most so many.
#[must_use]
pub fn suggest(
    requested: &RequestedField,
    variables: &[KnownVariable],
    decisions: &[PastDecision],
    most: usize,
) -> Vec<Suggestion> {
    let mut suggestions: Vec<Suggestion> =
        variables.iter().filter_map(|variable| judge(requested, variable, decisions)).collect();
    // Equal scores in a stable order, so that a page does not jump.
    suggestions.sort_by(|a, b| {
        b.score
            .cmp(&a.score)
            .then_with(|| (&a.source_id, &a.node_id).cmp(&(&b.source_id, &b.node_id)))
    });
    suggestions.truncate(most);
    suggestions
}

fn judge(
    requested: &RequestedField,
    variable: &KnownVariable,
    decisions: &[PastDecision],
) -> Option<Suggestion> {
    let steps = steps_needed(requested, variable)?;
    let mut evidence = Evidence::default();
    evidence.names(requested, variable);
    evidence.meaning(requested, variable);
    evidence.decisions(requested, variable, decisions);
    // Without a word in common the rest proves nothing: half the plant is a Double.
    if evidence.score() <= 0 {
        return None;
    }
    evidence.surroundings(requested, variable);
    evidence.descriptions(requested, variable);
    evidence.types(requested, variable, &steps);
    evidence.units(requested, variable);
    evidence.companion(requested, variable);
    evidence.value(requested, variable);
    let score = evidence.score().min(SCORE_MAX);
    if score < SCORE_MIN {
        return None;
    }
    let path = variable
        .path
        .iter()
        .map(String::as_str)
        .chain([variable.name.as_str()])
        .collect::<Vec<_>>()
        .join("/");
    Some(Suggestion {
        source_id: variable.source_id.clone(),
        node_id: variable.node_id.clone(),
        path,
        score: u8::try_from(score).unwrap_or(100),
        reasons: evidence.into_reasons(),
        steps,
    })
}

/// The functions between variable and field; `None` where nothing leads from one to the other.
fn steps_needed(requested: &RequestedField, variable: &KnownVariable) -> Option<Vec<Step>> {
    let is_scalar = |rank: i32| rank < 0;
    if variable.value_rank.is_some_and(|rank| {
        rank != -2 && rank != -3 && is_scalar(rank) != is_scalar(requested.value_rank)
    }) {
        return None;
    }
    let mut steps = Vec::new();
    let mut have = variable.value_type;
    if let (Some(from), Some(to)) =
        (unit(variable.unit.as_deref()), unit(requested.unit.as_deref()))
        && from.code != to.code
    {
        unece::convert(0.0, &from, &to).ok()?;
        let conversion =
            UnitConversion { from: Some(from.code.to_owned()), to: Some(to.code.to_owned()) };
        steps.push(conversion.into());
        // A converted number has a fraction in general.
        have = have.filter(|have| have.is_numeric()).map(|_| BuiltInType::Double);
    }
    if let Some(have) = have {
        let loses = matches!(have, BuiltInType::Float | BuiltInType::Double)
            && requested.value_type.is_integer();
        if !convert::coerces(have, requested.value_type) || loses {
            if !convert::converts(have, requested.value_type) {
                return None;
            }
            let (rounding, overflow) = (Rounding::default(), Overflow::default());
            steps.push(Convert { to: TypeName(requested.value_type), rounding, overflow }.into());
        }
    }
    Some(steps)
}

#[cfg(test)]
mod tests;
