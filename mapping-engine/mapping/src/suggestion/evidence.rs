//! Evidence for and against a variable.

use std::collections::BTreeSet;

use asi_model::network::Semantic;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    context::{KnownVariable, PastDecision, RequestedField, unit},
    words::{likeness, words},
};
use crate::document::Step;

/// A piece of evidence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Reason {
    /// Kind of evidence, for programs.
    pub kind: ReasonKind,
    /// Its weight; negative where it speaks against.
    pub points: i8,
    /// Sentence for the engineer.
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
    /// A person decided so before.
    Decision,
}

/// Words that a variable of this meaning has in its name, and words that speak against it.
fn meaning_words(semantic: &Semantic) -> (&'static str, &'static str) {
    match semantic {
        Semantic::ProducedQuantity => {
            ("count part produced", "scrap good target planned temperature")
        }
        Semantic::GoodQuantity => ("good count part", "scrap target planned"),
        Semantic::ScrapQuantity => ("scrap count part", "good target planned"),
        Semantic::PercentComplete => ("progress", "scrap temperature"),
        Semantic::OperationState => ("state", "count"),
        Semantic::ActualStart => ("start time actual", "end planned"),
        Semantic::ActualEnd => ("end time actual", "start planned"),
        Semantic::ExpectedEnd => ("end time expected estimated remaining", "start"),
        Semantic::Iri(_) => ("", ""),
    }
}

/// Types of companion specifications and the words that their variables carry: robots (OPC 40010),
/// machine tools (OPC 40501), machinery (OPC 40001), plastics (OPC 40083), ISA-95 jobs (OPC
/// 10031-4).
const COMPANION_TYPES: &[(&str, &str)] = &[
    ("AxisType", "axis position speed"),
    ("PowerTrainType", "motor temperature"),
    ("MotorType", "motor temperature"),
    ("MotionDeviceType", "robot speed load"),
    ("SafetyStateType", "safety state stop"),
    ("ControllerType", "controller state program"),
    ("ProductionProgramType", "program state count part"),
    ("ProductionPartSetType", "count part planned completed"),
    ("ProductionActiveProgramType", "program state count part"),
    ("JobManagementType", "order count part state"),
    ("JobCycleParametersType", "count part cycle"),
    ("ISA95JobOrderStatusType", "order state"),
    ("MachineryItemStateStateMachineType", "state"),
    ("MachineryOperationModeStateMachineType", "state"),
    ("MachineryBuildingBlocksType", "machine"),
];

/// The evidence so far.
#[derive(Debug, Default)]
pub(super) struct Evidence {
    reasons: Vec<Reason>,
}

impl Evidence {
    /// Returns the sum of all points.
    pub fn score(&self) -> i32 {
        self.reasons.iter().map(|reason| i32::from(reason.points)).sum()
    }

    /// Returns the reasons, the weightiest first, whether for or against.
    pub fn into_reasons(mut self) -> Vec<Reason> {
        self.reasons.sort_by_key(|reason| -i32::from(reason.points).abs());
        self.reasons
    }

    fn add(&mut self, kind: ReasonKind, points: i8, text: impl Into<String>) {
        if points != 0 {
            self.reasons.push(Reason { kind, points, text: text.into() });
        }
    }

    /// Compares the names: up to 35 points.
    pub fn names(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        let points = share(likeness(&words(&requested.name), &words(&variable.name)), 35);
        self.add(
            ReasonKind::Name,
            points,
            format!("its name \"{}\" is like \"{}\"", variable.name, requested.name),
        );
    }

    /// Looks for words of the field's meaning in the name: 15 or 25 points, or -20.
    pub fn meaning(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        let Some(semantic) = &requested.semantic else { return };
        let (likely, unlikely) = meaning_words(semantic);
        let have = words(&variable.name);
        let count = |text: &str| words(text).intersection(&have).count();
        match (count(likely), count(unlikely)) {
            (0, 0) => {}
            (_, 1..) => self.add(
                ReasonKind::Semantic,
                -20,
                format!("its name says something else than {}", semantic.as_str()),
            ),
            (hits, _) => {
                let points = if hits > 1 { 25 } else { 15 };
                self.add(
                    ReasonKind::Semantic,
                    points,
                    format!("its name has words of {}", semantic.as_str()),
                );
            }
        }
    }

    /// Compares asset and names above the variable: up to 23 points.
    pub fn surroundings(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        if let Some(asset) = &requested.asset
            && (variable.path.iter().any(|name| name.eq_ignore_ascii_case(asset))
                || variable.source_id.as_str().eq_ignore_ascii_case(asset))
        {
            self.add(ReasonKind::Place, 15, format!("it belongs to the asset \"{asset}\""));
        }
        let above: BTreeSet<String> = variable.path.iter().flat_map(|name| words(name)).collect();
        let points = share(likeness(&words(&requested.name), &above), 8);
        self.add(ReasonKind::Place, points, "the names above it are like the field's");
    }

    /// Counts common words of the descriptions: up to 12 points.
    pub fn descriptions(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        let of_requested: BTreeSet<String> =
            requested.descriptions.iter().flat_map(|text| words(text)).collect();
        let mut of_variable = variable.description.as_deref().map(words).unwrap_or_default();
        of_variable.extend(words(&variable.name));
        let common: Vec<&str> =
            of_requested.intersection(&of_variable).map(String::as_str).collect();
        let points = i8::try_from(common.len() * 4).unwrap_or(12).min(12);
        self.add(
            ReasonKind::Description,
            points,
            format!("the descriptions share: {}", common.join(", ")),
        );
    }

    /// Compares the types: -10 to 12 points.
    pub fn types(&mut self, requested: &RequestedField, variable: &KnownVariable, steps: &[Step]) {
        let Some(have) = variable.value_type else { return };
        let needs_convert = steps.iter().any(|step| matches!(step, Step::Convert(_)));
        if have == requested.value_type {
            self.add(ReasonKind::Type, 12, format!("both are {have}"));
        } else if !needs_convert {
            self.add(ReasonKind::Type, 9, format!("a {have} fits a {}", requested.value_type));
        } else if have.is_numeric() && requested.value_type.is_numeric() {
            self.add(
                ReasonKind::Type,
                4,
                format!("a {have} can be rounded to a {}", requested.value_type),
            );
        } else {
            self.add(
                ReasonKind::Type,
                -10,
                format!("a {have} must be converted to a {}", requested.value_type),
            );
        }
    }

    /// Compares the units: -5 to 15 points.
    pub fn units(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        match (unit(variable.unit.as_deref()), unit(requested.unit.as_deref())) {
            (Some(have), Some(want)) if have.code == want.code => {
                self.add(ReasonKind::Unit, 15, format!("both are in {}", want.description));
            }
            (Some(have), Some(want)) => {
                let text = format!("{} can be converted to {}", have.description, want.description);
                self.add(ReasonKind::Unit, 10, text);
            }
            (Some(have), None) if requested.value_type.is_numeric() => {
                self.add(
                    ReasonKind::Unit,
                    -5,
                    format!("it is in {}, but no unit is asked for", have.description),
                );
            }
            _ => {}
        }
    }

    /// Looks for the variable's type in companion specifications: 8 points.
    pub fn companion(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        let mut of_requested = words(&requested.name);
        if let Some(semantic) = &requested.semantic {
            of_requested.extend(words(meaning_words(semantic).0));
        }
        for name in &variable.type_names {
            let known = COMPANION_TYPES.iter().find(|(type_name, _)| type_name == name);
            if let Some((type_name, carried)) = known
                && words(carried).intersection(&of_requested).next().is_some()
            {
                return self.add(
                    ReasonKind::CompanionType,
                    8,
                    format!("it is part of a {type_name}"),
                );
            }
        }
    }

    /// Compares the current value with the field's meaning: 5 or -25 points.
    pub fn value(&mut self, requested: &RequestedField, variable: &KnownVariable) {
        let (Some(value), Some(semantic)) = (variable.value, &requested.semantic) else { return };
        let is_plausible = match semantic {
            Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity => {
                value >= 0.0 && value.fract() == 0.0
            }
            Semantic::PercentComplete => (0.0..=100.0).contains(&value),
            Semantic::OperationState => value.fract() == 0.0 && (0.0..=100.0).contains(&value),
            _ => return,
        };
        if is_plausible {
            self.add(ReasonKind::Value, 5, format!("its value may be a {}", semantic.as_str()));
        } else {
            self.add(
                ReasonKind::Value,
                -25,
                format!("its value cannot be a {}", semantic.as_str()),
            );
        }
    }

    /// Looks for earlier decisions on the variable: up to 40 points.
    pub fn decisions(
        &mut self,
        requested: &RequestedField,
        variable: &KnownVariable,
        decisions: &[PastDecision],
    ) {
        let of_variable = decisions.iter().filter(|past| {
            past.source_id == variable.source_id && past.node_id == variable.node_id
        });
        let mut best = 0;
        for past in of_variable {
            let same_meaning = requested.semantic.is_some() && past.semantic == requested.semantic;
            let points = match (same_meaning, past.field_name == requested.name) {
                (true, true) => 40,
                (true, false) => 30,
                (false, true) => 25,
                (false, false) => 0,
            };
            best = best.max(points);
        }
        self.add(ReasonKind::Decision, best, "such a field was mapped to it before");
    }
}

/// A share of so many points.
fn share(part: f64, points: i8) -> i8 {
    #[allow(clippy::cast_possible_truncation)]
    let points = (part.clamp(0.0, 1.0) * f64::from(points)).round() as i8;
    points
}
