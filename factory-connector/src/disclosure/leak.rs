//! What one partner learns in sum, and what approved fields reveal when they are put together.
//!
//! Pure: a list of open fields goes in, figures and warnings come out. The figures are upper bounds of what can be
//! learned from the values themselves; the warnings name conclusions that an engineer may not have meant to allow.

use asi_model::{
    BuiltInType, FieldKey,
    network::{Operation, ReportField, Semantic},
};
use serde::Serialize;

use super::{
    DisclosurePolicy,
    effects::{time_resolution_ms, values_per_hour_max},
};

/// Times coarser than this do not tell how a machine was used.
const UTILISATION_MS: u64 = 3_600_000;
/// Times coarser than this do not tell single pieces, where the plan does not say how long one takes.
const PIECE_MS: u64 = 15 * 60_000;

/// A field that a partner gets.
#[derive(Debug, Clone, Copy)]
pub struct OpenField<'f> {
    /// Which.
    pub key: &'f FieldKey,
    /// As requested.
    pub definition: &'f ReportField,
    /// The operation that it is about.
    pub operation: &'f Operation,
    /// The precision that holds.
    pub policy: &'f DisclosurePolicy,
    /// What left.
    pub measured: Measured,
}

/// What was counted over a time.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Measured {
    /// Values that came from the source.
    pub candidates: u64,
    /// Values that left.
    pub released: u64,
    /// Over how many hours, at most 24; since the connector started or the field was opened.
    pub hours: f64,
}

impl Measured {
    /// Values that left per hour.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn released_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.released as f64 / self.hours)
    }

    /// Values that came per hour.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn candidates_per_hour(self) -> Option<f64> {
        (self.hours > 0.0).then(|| self.candidates as f64 / self.hours)
    }
}

/// What one field tells.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct FieldLeak {
    /// Which.
    #[schema(value_type = Object)]
    pub key: FieldKey,
    /// Its precision in words.
    pub statement: String,
    /// Values per hour at most; none where only the publishing interval limits them.
    pub values_per_hour_max: Option<f64>,
    /// What was measured.
    pub measured: Measured,
    /// The most that one value can tell, in bits; none for texts and other values without bound.
    pub bits_per_value: Option<f64>,
    /// How exactly changes are timed, in milliseconds; 0: as they happen.
    pub time_resolution_ms: u64,
}

/// What follows from fields that are open together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Conclusion {
    /// How long single pieces took: a counter is timed more exactly than a piece takes.
    CycleTime,
    /// How much of the time a machine works: a state is timed within the hour.
    Utilisation,
    /// How large the whole order is: a share and a count of the same operation.
    OrderQuantity,
    /// How many pieces are scrap: counts of good, bad or all pieces of the same operation.
    Yield,
}

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakWarning {
    /// What can be concluded.
    pub conclusion: Conclusion,
    /// In words, with what would prevent it.
    pub text: String,
    /// From which fields.
    #[schema(value_type = Vec<Object>)]
    pub fields: Vec<FieldKey>,
    /// The time from which on it could not be concluded, in milliseconds, where that helps.
    pub needed_ms: Option<u64>,
}

/// What a partner learns in sum.
#[derive(Debug, Clone, PartialEq, Default, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeakBudget {
    /// Each field.
    pub fields: Vec<FieldLeak>,
    /// Values per hour at most; none where a field has no limit.
    pub values_per_hour_max: Option<f64>,
    /// Values per hour as measured.
    pub values_per_hour_measured: f64,
    /// Bits per hour at most; none where a field has no limit.
    pub bits_per_hour_max: Option<f64>,
    /// What can be concluded.
    pub warnings: Vec<LeakWarning>,
}

/// The sum of what open fields tell.
#[must_use]
pub fn leak_budget(open: &[OpenField<'_>]) -> LeakBudget {
    let fields: Vec<FieldLeak> = open
        .iter()
        .map(|field| FieldLeak {
            key: field.key.clone(),
            statement: field.policy.statement(field.definition.unit.as_deref()).description,
            values_per_hour_max: values_per_hour_max(field.policy),
            measured: field.measured,
            bits_per_value: bits_per_value(field),
            time_resolution_ms: time_resolution_ms(field.policy),
        })
        .collect();
    let bits = |field: &FieldLeak| Some(field.values_per_hour_max? * field.bits_per_value?);
    LeakBudget {
        values_per_hour_max: fields.iter().map(|field| field.values_per_hour_max).sum(),
        values_per_hour_measured: fields.iter().filter_map(|field| field.measured.released_per_hour()).sum(),
        bits_per_hour_max: fields.iter().map(bits).sum(),
        warnings: warnings(open),
        fields,
    }
}

/// Everything that can be concluded from open fields together.
fn warnings(open: &[OpenField<'_>]) -> Vec<LeakWarning> {
    let mut warnings = Vec::new();
    for field in open {
        warnings.extend(cycle_time(field));
        warnings.extend(utilisation(field));
    }
    let mut operations: Vec<(&FieldKey, Vec<&OpenField<'_>>)> = Vec::new();
    for field in open {
        let is_same = |key: &FieldKey| {
            key.request.operation_network_id == field.key.request.operation_network_id
                && key.request.operation_id == field.key.request.operation_id
        };
        match operations.iter_mut().find(|(key, _)| is_same(key)) {
            Some((_, fields)) => fields.push(field),
            None => operations.push((field.key, vec![field])),
        }
    }
    for (_, fields) in operations {
        let of = |wanted: &[Semantic]| -> Vec<FieldKey> {
            let means =
                |field: &&&OpenField<'_>| field.definition.semantic.as_ref().is_some_and(|s| wanted.contains(s));
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
                needed_ms: None,
            });
        }
    }
    warnings.sort_by(|left, right| (left.conclusion, &left.fields).cmp(&(right.conclusion, &right.fields)));
    warnings
}

/// The longest of what keeps two changes from being told apart, in milliseconds.
fn granularity_ms(policy: &DisclosurePolicy) -> u64 {
    let rates = policy.rate_limits.iter().map(|limit| limit.period_ms / u64::from(limit.values.max(1)));
    rates.chain(policy.minimum_interval_ms).fold(time_resolution_ms(policy), u64::max)
}

/// How long one piece takes by the plan, in milliseconds.
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
    is_count || (field.definition.field_type.0.is_integer() && field.definition.unit.as_deref() == Some("PIECE"))
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
fn cycle_time(field: &OpenField<'_>) -> Option<LeakWarning> {
    if !is_counter(field) || !field.policy.bands.is_empty() {
        return None;
    }
    let step = field.policy.rounding_step.map_or(1.0, |step| step.decimal().to_f64().max(1.0));
    let known = piece_ms(field.operation);
    // With a rounding step the pieces of a whole step are timed together: only their mean is told.
    let needed = known.unwrap_or(PIECE_MS);
    let is_single = step < 2.0 && granularity_ms(field.policy) < needed;
    is_single.then(|| LeakWarning {
        conclusion: Conclusion::CycleTime,
        text: match known {
            Some(_) => "Each piece is timed more exactly than it takes by the plan, which tells the cycle time. A \
                        minimum interval, a time step or a rounding step of several pieces hides it."
                .to_owned(),
            None => {
                "Each piece may be timed as it is made, which tells the cycle time. A minimum interval, a time step \
                     or a rounding step of several pieces hides it."
                    .to_owned()
            }
        },
        fields: vec![field.key.clone()],
        needed_ms: Some(needed),
    })
}

fn utilisation(field: &OpenField<'_>) -> Option<LeakWarning> {
    let definition = field.definition;
    let name = definition.name.as_str().to_ascii_lowercase();
    let is_named = ["state", "status", "mode", "running", "active"].iter().any(|word| name.contains(word));
    let is_state = definition.semantic == Some(Semantic::OperationState)
        || (definition.semantic.is_none() && (definition.field_type.0 == BuiltInType::Boolean || is_named));
    (is_state && granularity_ms(field.policy) < UTILISATION_MS).then(|| LeakWarning {
        conclusion: Conclusion::Utilisation,
        text:
            "A state that is timed within the hour tells how much of the time the machine works, and when it pauses. A \
               time step or window of an hour hides it."
                .to_owned(),
        fields: vec![field.key.clone()],
        needed_ms: Some(UTILISATION_MS),
    })
}

/// The most that one value can tell: the logarithm of how many different values there can be.
fn bits_per_value(field: &OpenField<'_>) -> Option<f64> {
    let (policy, definition) = (field.policy, field.definition);
    let field_type = definition.field_type.0;
    if field_type == BuiltInType::Boolean {
        return Some(1.0);
    }
    let type_bits = match field_type {
        BuiltInType::SByte | BuiltInType::Byte => 8.0_f64,
        BuiltInType::Int16 | BuiltInType::UInt16 => 16.0,
        BuiltInType::Int32 | BuiltInType::UInt32 | BuiltInType::Float => 32.0,
        BuiltInType::Int64 | BuiltInType::UInt64 | BuiltInType::Double | BuiltInType::DateTime => 64.0,
        _ => return None,
    };
    if definition.value_rank >= 0 {
        return None;
    }
    let mut bits = type_bits;
    if !policy.bands.is_empty() {
        bits = bits.min(f64::from(u32::try_from(policy.bands.len()).unwrap_or(u32::MAX)).log2());
    }
    let range = match definition.semantic {
        Some(Semantic::PercentComplete) => Some(100.0),
        Some(Semantic::ProducedQuantity | Semantic::GoodQuantity | Semantic::ScrapQuantity) => {
            field.operation.planned_quantity
        }
        _ if field_type.is_integer() => Some(type_bits.exp2()),
        _ => None,
    };
    let step = policy.rounding_step.map(|step| step.decimal().to_f64());
    let step = step.or_else(|| field_type.is_integer().then_some(1.0));
    if let Some((range, step)) = range.zip(step) {
        bits = bits.min((range / step + 1.0).max(1.0).log2());
    }
    if let Some(digits) = policy.significant_digits {
        // Sign, digits, and the decades that the type has.
        let decades: f64 = match field_type {
            BuiltInType::Double => 617.0,
            BuiltInType::Float => 77.0,
            _ => type_bits * std::f64::consts::LOG10_2,
        };
        bits = bits.min((2.0 * 9.0 * 10_f64.powi(i32::from(digits) - 1) * decades.max(1.0)).log2());
    }
    Some(bits)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn operation() -> Operation {
        serde_json::from_value(json!({ "operationId": "op", "operationType": "PRODUCTION", "plannedQuantity": 100,
            "plannedStart": "2026-11-21T06:00:00Z", "plannedEnd": "2026-11-21T16:00:00Z" }))
        .expect("an operation")
    }

    /// The budget of fields, each a definition with its policy.
    fn budget(fields: &[(Value, Value)]) -> LeakBudget {
        let operation = operation();
        let owned: Vec<(FieldKey, ReportField, DisclosurePolicy)> = fields
            .iter()
            .map(|(definition, policy)| {
                let definition: ReportField = serde_json::from_value(definition.clone()).expect("a field");
                let key = json!({ "operationNetworkId": "n", "operationId": "op", "dynamicDataRequestId": "R",
                    "fieldName": definition.name });
                let key = serde_json::from_value(key).expect("a key");
                (key, definition, serde_json::from_value(policy.clone()).expect("a policy"))
            })
            .collect();
        let measured = Measured { candidates: 100, released: 10, hours: 2.0 };
        let open: Vec<OpenField<'_>> = owned
            .iter()
            .map(|(key, definition, policy)| OpenField { key, definition, operation: &operation, policy, measured })
            .collect();
        leak_budget(&open)
    }

    fn conclusions(fields: &[(Value, Value)]) -> Vec<Conclusion> {
        budget(fields).warnings.into_iter().map(|warning| warning.conclusion).collect()
    }

    #[test]
    fn conclusions_follow_from_what_is_open_together() {
        use Conclusion as C;
        let made = || json!({ "name": "made", "type": 9, "semantic": "PRODUCED_QUANTITY" });
        let scrap = || json!({ "name": "scrap", "type": 9, "semantic": "SCRAP_QUANTITY" });
        let share = || json!({ "name": "share", "type": 11, "semantic": "PERCENT_COMPLETE" });
        let state = || json!({ "name": "robotState", "type": 12 });
        let hourly = || json!({ "timeStepMs": 3_600_000 });
        // A hundred pieces in ten hours: one takes six minutes.
        assert_eq!(conclusions(&[(made(), json!({}))]), [C::CycleTime]);
        assert_eq!(conclusions(&[(made(), json!({ "minimumIntervalMs": 300_000 }))]), [C::CycleTime]);
        assert_eq!(conclusions(&[(made(), json!({ "minimumIntervalMs": 360_000 }))]), []);
        assert_eq!(conclusions(&[(made(), json!({ "roundingStep": 10 }))]), []);
        assert_eq!(conclusions(&[(state(), json!({}))]), [C::Utilisation]);
        assert_eq!(conclusions(&[(state(), hourly())]), []);
        assert_eq!(conclusions(&[(made(), hourly()), (share(), hourly())]), [C::OrderQuantity]);
        assert_eq!(conclusions(&[(made(), hourly()), (scrap(), hourly())]), [C::Yield]);
        assert_eq!(conclusions(&[(share(), json!({}))]), []);
    }

    #[test]
    fn figures_add_up() {
        let temperature = json!({ "name": "temperature", "type": 11 });
        let share = json!({ "name": "share", "type": 11, "semantic": "PERCENT_COMPLETE" });
        let found = budget(&[
            (share.clone(), json!({ "roundingStep": 25, "minimumIntervalMs": 3_600_000 })),
            (
                temperature.clone(),
                json!({ "bands": [0, 20, 40, 60], "rateLimits": [{ "values": 3, "periodMs": 3_600_000 }] }),
            ),
        ]);
        assert_eq!(found.values_per_hour_max, Some(4.0));
        assert_eq!(found.values_per_hour_measured, 10.0);
        let bits = found.bits_per_hour_max.expect("both are limited");
        assert!((bits - (5_f64.log2() + 3.0 * 2.0)).abs() < 1e-9, "{bits}");
        let found = budget(&[(share, json!({})), (temperature, json!({ "timeStepMs": 60_000 }))]);
        assert_eq!((found.values_per_hour_max, found.bits_per_hour_max), (None, None));
        let text = budget(&[(json!({ "name": "note", "type": 12 }), json!({ "timeStepMs": 3_600_000 }))]);
        assert_eq!(text.fields[0].bits_per_value, None);
    }
}
