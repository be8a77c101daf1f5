//! Which variable might a requested field mean? Ranked candidates, each with its reasons; a person
//! decides.
//!
//! Pure: callers bring the variables (from browsing), a value of each where they have one, and the
//! factory's earlier decisions. Each piece of evidence gives points and a sentence; types and units
//! that cannot go together rule a variable out. The functions that would be needed (convert, unit
//! conversion) are proposed with it.

mod evidence;
mod words;

use asi_model::{BuiltInType, NodeId, network::Semantic, units as unece};
use serde::{Deserialize, Serialize};
use shop_floor_model::{BrowsedNode, ListedVariable, SourceId};
use utoipa::ToSchema;

use crate::{
    convert::{self, Overflow, Rounding},
    document::{Convert, Step, TypeName, UnitConversion},
};
use evidence::Evidence;

/// Fewer points are no suggestion.
const SCORE_MIN: i32 = 20;
/// Most points.
const SCORE_MAX: i32 = 100;

/// What a partner wants.
#[derive(Debug, Clone, PartialEq)]
pub struct WantedField {
    /// The field's name.
    pub name: String,
    /// Its built-in type.
    pub value_type: BuiltInType,
    /// Its ValueRank: -1 scalar.
    pub value_rank: i32,
    /// Its unit.
    pub unit: Option<String>,
    /// Its meaning.
    pub semantic: Option<Semantic>,
    /// What is said about field, request, operation and product, in words.
    pub descriptions: Vec<String>,
    /// The asset that the operation is done with, where the network names one.
    pub asset: Option<String>,
}

/// A variable of a local server.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownVariable {
    /// The server.
    pub source_id: SourceId,
    /// The variable.
    pub node_id: NodeId,
    /// Its own name.
    pub name: String,
    /// The names above it, outermost first.
    pub path: Vec<String>,
    /// What the server says about it.
    pub description: Option<String>,
    /// The built-in type of its value.
    pub value_type: Option<BuiltInType>,
    /// Its ValueRank.
    pub value_rank: Option<i32>,
    /// Its unit.
    pub unit: Option<String>,
    /// The names of its type and of the types above it, as companion specifications call them.
    pub type_names: Vec<String>,
    /// A value of it, as number.
    pub value: Option<f64>,
}

impl KnownVariable {
    /// A variable as a list of all of a server's shows it: names and types of what stands above,
    /// nothing of its value.
    #[must_use]
    pub fn listed(source_id: &SourceId, variable: &ListedVariable) -> Self {
        let (_, above) = variable.browse_path.0.split_last().unzip();
        Self {
            source_id: source_id.clone(),
            node_id: variable.node_id.clone(),
            name: variable.display_name.clone(),
            path: above
                .into_iter()
                .flatten()
                .filter_map(|element| element.name.as_deref().map(str::to_owned))
                .collect(),
            description: None,
            value_type: None,
            value_rank: None,
            unit: None,
            type_names: variable.type_names.iter().map(|name| (**name).to_owned()).collect(),
            value: None,
        }
    }

    /// With what browsing shows of it.
    #[must_use]
    pub fn described(self, node: &BrowsedNode) -> Self {
        Self {
            description: node.description.clone(),
            value_type: node.built_in_type,
            value_rank: node.value_rank,
            unit: node.unit.as_ref().and_then(|unit| unit.code.clone()),
            ..self
        }
    }
}

/// What an engineer of this factory decided before.
#[derive(Debug, Clone, PartialEq)]
pub struct PastDecision {
    /// The field's name.
    pub field_name: String,
    /// Its meaning.
    pub semantic: Option<Semantic>,
    /// The server it was mapped to.
    pub source_id: SourceId,
    /// The variable it was mapped to.
    pub node_id: NodeId,
}

/// A variable that might be meant.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Suggestion {
    /// The server.
    #[schema(value_type = String)]
    pub source_id: SourceId,
    /// The variable.
    #[schema(value_type = String)]
    pub node_id: NodeId,
    /// Where it stands, as people read it.
    pub place: String,
    /// 20 to 100.
    pub score: u8,
    /// Why, the weightiest first.
    pub reasons: Vec<Reason>,
    /// The functions it would need.
    pub steps: Vec<Step>,
}

/// A piece of evidence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Reason {
    /// What kind of evidence.
    pub kind: ReasonKind,
    /// Its weight; negative where it speaks against.
    pub points: i8,
    /// In a sentence.
    pub text: String,
}

/// Kinds of evidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub enum ReasonKind {
    /// The names are alike.
    Name,
    /// The name has words of the field's meaning.
    Semantic,
    /// The names above it, or the asset, are alike.
    Place,
    /// The descriptions have words in common.
    Description,
    /// The types go together.
    Type,
    /// The units go together.
    Unit,
    /// A companion specification defines it so.
    CompanionType,
    /// Its value is such as the field's would be, or not.
    Value,
    /// It was decided so before.
    Decision,
}

/// The variables that might be meant, best first, at most so many.
#[must_use]
pub fn suggest(
    wanted: &WantedField,
    variables: &[KnownVariable],
    decisions: &[PastDecision],
    most: usize,
) -> Vec<Suggestion> {
    let mut suggestions: Vec<Suggestion> =
        variables.iter().filter_map(|variable| judge(wanted, variable, decisions)).collect();
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
    wanted: &WantedField,
    variable: &KnownVariable,
    decisions: &[PastDecision],
) -> Option<Suggestion> {
    let steps = steps_needed(wanted, variable)?;
    let mut evidence = Evidence::default();
    evidence.names(wanted, variable);
    evidence.meaning(wanted, variable);
    evidence.decisions(wanted, variable, decisions);
    // Without a word in common the rest proves nothing: half the plant is a Double.
    if evidence.score() <= 0 {
        return None;
    }
    evidence.place(wanted, variable);
    evidence.descriptions(wanted, variable);
    evidence.types(wanted, variable, &steps);
    evidence.units(wanted, variable);
    evidence.companion(wanted, variable);
    evidence.value(wanted, variable);
    let score = evidence.score().min(SCORE_MAX);
    if score < SCORE_MIN {
        return None;
    }
    let place = variable
        .path
        .iter()
        .map(String::as_str)
        .chain([variable.name.as_str()])
        .collect::<Vec<_>>()
        .join("/");
    Some(Suggestion {
        source_id: variable.source_id.clone(),
        node_id: variable.node_id.clone(),
        place,
        score: u8::try_from(score).unwrap_or(100),
        reasons: evidence.into_reasons(),
        steps,
    })
}

/// The functions between variable and field; `None` where nothing leads from one to the other.
fn steps_needed(wanted: &WantedField, variable: &KnownVariable) -> Option<Vec<Step>> {
    let is_scalar = |rank: i32| rank < 0;
    if variable.value_rank.is_some_and(|rank| {
        rank != -2 && rank != -3 && is_scalar(rank) != is_scalar(wanted.value_rank)
    }) {
        return None;
    }
    let mut steps = Vec::new();
    let mut have = variable.value_type;
    if let (Some(from), Some(to)) = (unit(variable.unit.as_deref()), unit(wanted.unit.as_deref()))
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
            && wanted.value_type.is_integer();
        if !convert::coerces(have, wanted.value_type) || loses {
            if !convert::converts(have, wanted.value_type) {
                return None;
            }
            let (rounding, overflow) = (Rounding::default(), Overflow::default());
            steps.push(Convert { to: TypeName(wanted.value_type), rounding, overflow }.into());
        }
    }
    Some(steps)
}

fn unit(name: Option<&str>) -> Option<unece::EngineeringUnit> {
    unece::lookup(name?)
}

#[cfg(test)]
mod tests;
