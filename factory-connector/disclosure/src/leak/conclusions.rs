//! Conclusions from several disclosed fields together.

use std::collections::HashMap;

use asi_model::{
    BuiltInType, FieldKey, OperationId, OperationNetworkId,
    network::{Operation, Semantic},
};
use serde::Serialize;

use super::open_field::OpenField;
use crate::{DisclosurePolicy, effects::time_resolution_ms};

/// Times coarser than this do not reveal the utilisation of a machine.
const UTILISATION_MS: u64 = 3_600_000;
/// Times coarser than this do not reveal single pieces, when the plan has no time per piece.
const PIECE_MS: u64 = 15 * 60_000;

/// Conclusion from fields that are disclosed together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Conclusion {
    /// Time of single pieces: the times of a counter are finer than that of a piece.
    CycleTime,
    /// Share of the time in which a machine works: the times of a state are finer than an hour.
    Utilisation,
    /// Size of the whole order: a share and a count of the same operation.
    OrderQuantity,
    /// Share of scrap: counts of good, bad or all pieces of the same operation.
    Yield,
}

/// Warning about a conclusion that a partner can draw.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakWarning {
    /// The conclusion, as a code with the other members as parameters.
    pub conclusion: Conclusion,
    /// English text, with the remedy.
    pub text: String,
    /// The fields that allow the conclusion.
    pub fields: Vec<FieldKey>,
    /// Planned time of a piece in milliseconds, for `CYCLE_TIME` and when the plan has one.
    pub piece_ms: Option<u64>,
    /// Resolution of times that prevents the conclusion, in milliseconds, if one does.
    pub needed_ms: Option<u64>,
}

/// Returns all conclusions from disclosed fields together.
#[must_use]
pub fn leak_warnings(open: &[OpenField<'_>]) -> Vec<LeakWarning> {
    let mut warnings = Vec::new();
    for field in open {
        warnings.extend(cycle_time(field));
        warnings.extend(utilisation(field));
    }
    let mut operations: HashMap<(&OperationNetworkId, &OperationId), Vec<&OpenField<'_>>> =
        HashMap::new();
    for field in open {
        let request = &field.key.request;
        operations
            .entry((&request.operation_network_id, &request.operation_id))
            .or_default()
            .push(field);
    }
    for fields in operations.into_values() {
        let of = |searched: &[Semantic]| -> Vec<FieldKey> {
            let means = |field: &&&OpenField<'_>| {
                field.definition.semantic.as_ref().is_some_and(|s| searched.contains(s))
            };
            fields.iter().filter(means).map(|field| field.key.clone()).collect()
        };
        let (shares, all) = (of(&[Semantic::PercentComplete]), of(&[Semantic::ProducedQuantity]));
        let (good, scrap) = (of(&[Semantic::GoodQuantity]), of(&[Semantic::ScrapQuantity]));
        let counts: Vec<FieldKey> = all.iter().chain(&good).cloned().collect();
        if !shares.is_empty() && !counts.is_empty() {
            warnings.push(LeakWarning {
                conclusion: Conclusion::OrderQuantity,
                text:
                    "A count divided by the share completed is the size of the whole order. Disclose one of them, or \
                       put the share into bands."
                        .to_owned(),
                fields: shares.into_iter().chain(counts).collect(),
                piece_ms: None,
                needed_ms: None,
            });
        }
        let kinds = [&all, &good, &scrap].into_iter().filter(|fields| !fields.is_empty()).count();
        if kinds >= 2 {
            warnings.push(LeakWarning {
                conclusion: Conclusion::Yield,
                text:
                    "Counts of good, bad or all pieces together tell the yield. Disclose one of them, or round both to \
                       steps larger than the scrap to be expected."
                        .to_owned(),
                fields: all.into_iter().chain(good).chain(scrap).collect(),
                piece_ms: None,
                needed_ms: None,
            });
        }
    }
    warnings.sort_by(|left, right| {
        (left.conclusion, &left.fields).cmp(&(right.conclusion, &right.fields))
    });
    warnings
}

/// Returns the longest time within which two changes cannot be distinguished, in milliseconds. A
/// rate of several values does not prevent that they follow each other at once.
fn granularity_ms(policy: &DisclosurePolicy) -> u64 {
    let single = policy.rate_limits.iter().filter(|limit| limit.values <= 1);
    let rates = single.map(|limit| limit.period_ms);
    rates.chain(policy.minimum_interval_ms).fold(time_resolution_ms(policy), u64::max)
}

/// Returns the planned time of a piece, in milliseconds.
#[allow(clippy::cast_precision_loss, clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn piece_ms(operation: &Operation) -> Option<u64> {
    let (start, end) = (operation.planned_start?, operation.planned_end?);
    let quantity = operation.planned_quantity.filter(|quantity| *quantity >= 1.0)?;
    let piece = end.since(start).as_millis() as f64 / quantity;
    (piece >= 1.0).then_some(piece as u64)
}

fn is_counter(field: &OpenField<'_>) -> bool {
    let is_count = matches!(
        field.definition.semantic,
        Some(Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity)
    );
    is_count
        || (field.definition.field_type.0.is_integer()
            && field.definition.unit.as_deref() == Some("PIECE"))
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
fn cycle_time(field: &OpenField<'_>) -> Option<LeakWarning> {
    if !is_counter(field) || !field.policy.bands.is_empty() {
        return None;
    }
    let step = field.policy.rounding_step.map_or(1.0, |step| step.decimal().to_f64().max(1.0));
    let known = piece_ms(field.operation);
    // The pieces of a rounding step have one time: the time between two steps is that of so many
    // pieces, which is their mean.
    let needed = (known.unwrap_or(PIECE_MS) as f64 * step) as u64;
    let is_mean = step >= 2.0;
    (granularity_ms(field.policy) < needed).then(|| LeakWarning {
        conclusion: Conclusion::CycleTime,
        text: match known {
            _ if is_mean => {
                "The time between two rounding steps is that of their pieces, which tells the mean cycle time. A \
                     minimum interval or a time step longer than that hides it."
            }
            Some(_) => {
                "Each piece is timed more exactly than it takes by the plan, which tells the cycle time. A minimum \
                     interval or a time step hides it; a rounding step leaves the mean."
            }
            None => {
                "Each piece may be timed as it is made, which tells the cycle time. A minimum interval or a time step \
                     hides it; a rounding step leaves the mean."
            }
        }
        .to_owned(),
        fields: vec![field.key.clone()],
        piece_ms: known,
        needed_ms: Some(needed),
    })
}

fn utilisation(field: &OpenField<'_>) -> Option<LeakWarning> {
    let definition = field.definition;
    let name = definition.name.as_str().to_ascii_lowercase();
    let is_named =
        ["state", "status", "mode", "running", "active"].iter().any(|word| name.contains(word));
    let is_state = definition.semantic == Some(Semantic::OperationState)
        || (definition.semantic.is_none()
            && (definition.field_type.0 == BuiltInType::Boolean || is_named));
    (is_state && granularity_ms(field.policy) < UTILISATION_MS).then(|| LeakWarning {
        conclusion: Conclusion::Utilisation,
        text:
            "A state that is timed within the hour tells how much of the time the machine works, and when it pauses. A \
               time step or window of an hour hides it."
                .to_owned(),
        fields: vec![field.key.clone()],
        piece_ms: None,
        needed_ms: Some(UTILISATION_MS),
    })
}
