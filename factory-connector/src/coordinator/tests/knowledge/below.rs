//! Differences below a policy: another value of which the policy makes the same. Computed without
//! the gate's code.

use asi_model::{BuiltInType, Scalar, Variant};
use disclosure::{DisclosurePolicy, GateOutcome, StatusCodes};

use super::{
    fields::{FIELDS, FieldOf, WITHHELD_STATE},
    *,
};

/// Bits of a status code that tell nothing in the small set: a limit and an overflow.
const INFO_BITS: u32 = 0x0000_0483;
/// Codes of the small set of status codes, beside which there is none.
pub(super) const COMMON: [u32; 9] = [
    0,
    0x4000_0000,
    0x4090_0000,
    0x408F_0000,
    0x8000_0000,
    0x809B_0000,
    0x808A_0000,
    0x808D_0000,
    0x8074_0000,
];

/// Returns a value that differs from a candidate where nobody outside may see it. `outcome` is what
/// the field's gate said of the candidate, under this policy.
pub(super) fn differing(
    field: usize,
    candidate: &DataValue,
    policy: &DisclosurePolicy,
    outcome: Option<GateOutcome>,
) -> DataValue {
    let field = &FIELDS[field];
    let step = policy.time_step();
    let server_timestamp = candidate.source_timestamp.map(|at| at.after(Duration::from_millis(3)));
    let mut other = DataValue { server_timestamp, ..candidate.clone() };
    if policy.aggregate.is_some() || outcome.is_none() {
        // The time of an aggregate is that of its window.
        other.source_timestamp = candidate.source_timestamp.map(|at| at.after(step));
    } else if !step.is_zero() {
        other.source_timestamp = candidate.source_timestamp.map(|at| at.floor_to(step));
    }
    let is_common = COMMON.contains(&candidate.status.0);
    match policy.status_codes {
        // A window keeps the codes of its values, for the policy at its end.
        _ if policy.aggregate.is_some() && outcome.is_some() => {}
        StatusCodes::Full => {}
        StatusCodes::Common if is_common => {}
        _ => other.status = StatusCode(candidate.status.0 | INFO_BITS),
    }
    let is_hidden = matches!(outcome, None | Some(GateOutcome::Suppressed));
    let is_other_type = candidate.value.built_in_type() != Some(field.field_type);
    if candidate.status.is_bad() || is_hidden || is_other_type {
        other.value = another(field, candidate);
    } else if policy.aggregate.is_none() {
        other.value = nearby(&candidate.value, policy);
    }
    other
}

/// Returns any other value of the same type. A state stays what it is to a condition.
fn another(field: &FieldOf, candidate: &DataValue) -> Variant {
    let is_state = candidate.value.as_f64() == Some(f64::from(WITHHELD_STATE));
    match candidate.value.as_scalar() {
        Some(_) if is_state => candidate.value.clone(),
        Some(Scalar::Boolean(value)) => Variant::from(!value),
        Some(scalar) if scalar.built_in_type() == field.field_type => {
            let other = Scalar::from_i128(4_003, field.field_type);
            Variant::Scalar(other.unwrap_or_else(|| field.scalar(4_003)))
        }
        _ => candidate.value.clone(),
    }
}

/// Returns another value that rounds to the same one.
fn nearby(value: &Variant, policy: &DisclosurePolicy) -> Variant {
    if let Some(Scalar::DateTime(at)) = value.as_scalar() {
        return Variant::from(at.floor_to(policy.time_step()));
    }
    let step = policy.rounding_step.and_then(|step| step.to_string().parse::<f64>().ok());
    let (Some(number), Some(step)) = (value.as_f64(), step) else { return value.clone() };
    if value.built_in_type() == Some(BuiltInType::Boolean) || number == f64::from(WITHHELD_STATE) {
        return value.clone();
    }
    // Ties are rounded away from zero: a third of a step is on the same side for sure.
    let nearest = (number / step + 0.5 * number.signum()).trunc() * step;
    let other = if number > nearest {
        nearest - (step / 3.0).floor()
    } else {
        nearest + (step / 3.0).floor()
    };
    #[allow(clippy::cast_possible_truncation)]
    match value.as_scalar() {
        Some(Scalar::UInt64(_) | Scalar::Int64(_) | Scalar::Int32(_)) => {
            let field_type = value.built_in_type().expect("a number has a type");
            let other = Scalar::from_i128(other as i128, field_type);
            other.map_or_else(|| value.clone(), Variant::Scalar)
        }
        Some(Scalar::Double(_)) => Variant::from(other),
        Some(Scalar::Float(_)) => Variant::from(other as f32),
        _ => value.clone(),
    }
}
