//! Differences below a policy: another value of which the policy makes the same. Computed without
//! the gate's code.

use asi_model::{
    BuiltInType, Scalar, Variant,
    values::{Array, DiagnosticInfo, ExtensionBody, ExtensionObject, StructureValue},
};
use disclosure::{AggregateFunction, DisclosurePolicy, GateOutcome, StatusCodes};

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
    // A window keeps the codes of its values, for the policy at its end.
    if policy.aggregate.is_none() || outcome.is_none() {
        other.status = another_status(candidate.status, policy.status_codes);
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

/// Returns a value that differs from a candidate which `later` ones of its field replace before it can leave:
/// of a window's values only its function is shown.
pub(super) fn superseded(
    field: usize,
    candidate: &DataValue,
    policy: &DisclosurePolicy,
    later: &[(usize, DataValue)],
) -> DataValue {
    let of = &FIELDS[field];
    let number = |value: &DataValue| {
        let is_usable = !value.status.is_bad()
            && !of.is_array
            && value.value.built_in_type() == Some(of.field_type);
        value.value.as_f64().filter(|_| is_usable && of.field_type.is_numeric())
    };
    let mut others = later.iter().filter(|(other, _)| *other == field);
    let mut others = others.by_ref().filter_map(|(_, value)| number(value));
    let shifted = |by: i128| {
        let scalar = candidate.value.as_scalar()?;
        let whole = Scalar::from_i128(scalar.as_f64()? as i128 + by, of.field_type)?;
        Some(Variant::Scalar(whole))
    };
    let function = policy.aggregate.map(|aggregate| aggregate.function);
    let value = match (function, number(candidate)) {
        // It counts for no time, and whether it is usable is told by the window's status.
        (None | Some(AggregateFunction::Last | AggregateFunction::Mean), _) => {
            Some(another(of, candidate))
        }
        (Some(AggregateFunction::Maximum), Some(number)) => {
            others.any(|other| other > number).then(|| shifted(-1)).flatten()
        }
        (Some(AggregateFunction::Minimum), Some(number)) => {
            others.any(|other| other < number).then(|| shifted(1)).flatten()
        }
        _ => None,
    };
    DataValue { value: value.unwrap_or_else(|| candidate.value.clone()), ..candidate.clone() }
}

/// Returns any other value of the same type. A state stays what it is to a condition.
fn another(field: &FieldOf, candidate: &DataValue) -> Variant {
    let is_state = candidate.value.as_f64() == Some(f64::from(WITHHELD_STATE));
    let is_own_type = candidate.value.built_in_type() == Some(field.field_type);
    match candidate.value.as_scalar() {
        None if is_own_type => field.value(4_003),
        Some(_) if is_state => candidate.value.clone(),
        Some(Scalar::Boolean(value)) => Variant::from(!value),
        Some(scalar) if scalar.built_in_type() == field.field_type => {
            let other = Scalar::from_i128(4_003, field.field_type);
            Variant::Scalar(other.unwrap_or_else(|| field.scalar(4_003)))
        }
        _ => candidate.value.clone(),
    }
}

/// Returns another code of the same severity that a policy does not tell from this one.
fn another_status(status: StatusCode, resolution: StatusCodes) -> StatusCode {
    let is_common = |code: u32| COMMON.contains(&code);
    // Causes within the plant, two of each severity.
    let causes: [[u32; 2]; 3] =
        [[0x0096_0000, 0x00A2_0000], [0x4094_0000, 0x4095_0000], [0x808C_0000, 0x8089_0000]];
    let of_severity = causes[(status.0 >> 30).min(2) as usize];
    let other = of_severity.into_iter().find(|code| *code != status.0).unwrap_or(status.0);
    match resolution {
        StatusCodes::Full => status,
        StatusCodes::Common if is_common(status.0) => status,
        StatusCodes::Common | StatusCodes::Severity => StatusCode(other | INFO_BITS),
    }
}

/// Returns another value of which the policy makes the same one.
fn nearby(value: &Variant, policy: &DisclosurePolicy) -> Variant {
    match value {
        Variant::Null => Variant::Null,
        Variant::Scalar(scalar) => Variant::Scalar(nearby_scalar(scalar, policy)),
        Variant::Array(array) => Variant::Array(Arc::new(Array {
            elements: array.elements.iter().map(|scalar| nearby_scalar(scalar, policy)).collect(),
            ..Array::clone(array)
        })),
    }
}

fn is_coarse(policy: &DisclosurePolicy) -> bool {
    let is_of_numbers = policy.rounding_step.is_some() || policy.significant_digits.is_some();
    is_of_numbers || !policy.bands.is_empty() || !policy.time_step().is_zero()
}

/// A text beside coarse numbers is not shown at all.
fn nearby_held(held: &Variant, policy: &DisclosurePolicy) -> Variant {
    let is_text = held.built_in_type() == Some(BuiltInType::String);
    if is_text && is_coarse(policy) {
        return Variant::from("another text");
    }
    nearby(held, policy)
}

fn nearby_object(object: &ExtensionObject, policy: &DisclosurePolicy) -> ExtensionObject {
    let ExtensionBody::Structure(structure) = &object.body else { return object.clone() };
    let fields = structure.fields.iter();
    let fields = fields.map(|(name, value)| (Arc::clone(name), nearby_held(value, policy)));
    let body = ExtensionBody::Structure(StructureValue { fields: fields.collect(), ..*structure });
    ExtensionObject { body, ..object.clone() }
}

/// Returns other diagnostics: but for the codes they are not shown unless a policy lets everything through.
fn nearby_diagnostics(info: &DiagnosticInfo, policy: &DisclosurePolicy) -> DiagnosticInfo {
    let code = info.inner_status_code.map(|code| another_status(code, policy.status_codes));
    let is_whole = !is_coarse(policy) && policy.status_codes == StatusCodes::Full;
    let additional_info = Some("another text".into());
    let other = DiagnosticInfo { symbolic_id: Some(4_003), additional_info, ..info.clone() };
    DiagnosticInfo { inner_status_code: code, ..if is_whole { info.clone() } else { other } }
}

#[allow(clippy::cast_possible_truncation)]
fn nearby_scalar(scalar: &Scalar, policy: &DisclosurePolicy) -> Scalar {
    match scalar {
        Scalar::DateTime(at) => return Scalar::DateTime(at.floor_to(policy.time_step())),
        Scalar::StatusCode(code) => {
            return Scalar::StatusCode(another_status(*code, policy.status_codes));
        }
        Scalar::Variant(held) => return Scalar::Variant(Box::new(nearby_held(held, policy))),
        Scalar::ExtensionObject(object) => {
            return Scalar::ExtensionObject(Box::new(nearby_object(object, policy)));
        }
        Scalar::DiagnosticInfo(info) => {
            return Scalar::DiagnosticInfo(Box::new(nearby_diagnostics(info, policy)));
        }
        Scalar::DataValue(held) => {
            return Scalar::DataValue(Box::new(DataValue {
                value: nearby(&held.value, policy),
                status: another_status(held.status, policy.status_codes),
                source_timestamp: held.source_timestamp.map(|at| at.floor_to(policy.time_step())),
                source_picoseconds: 7,
                ..DataValue::default()
            }));
        }
        _ => {}
    }
    let field_type = scalar.built_in_type();
    let number = scalar.as_f64().filter(|_| field_type.is_numeric());
    let other = number.and_then(|number| nearby_number(number, policy));
    let state = f64::from(WITHHELD_STATE);
    // What is a state to a condition stays one, and nothing becomes one.
    let other = other.filter(|other| *other != state && number != Some(state));
    let other = other.and_then(|other| match scalar {
        Scalar::Double(_) => Some(Scalar::Double(other)),
        Scalar::Float(_) => Some(Scalar::Float(other as f32)),
        // Beyond the limits of its type a number is rounded towards zero.
        _ => Scalar::from_i128(other as i128, field_type),
    });
    other.unwrap_or_else(|| scalar.clone())
}

/// Returns another number in the same band, or that rounds to the same one; none if each is told.
fn nearby_number(number: f64, policy: &DisclosurePolicy) -> Option<f64> {
    if !policy.bands.is_empty() {
        let below = policy.bands.iter().rev().find(|bound| **bound <= number);
        let bound = *below.unwrap_or(&policy.bands[0]);
        return Some(if below.is_none() { number - 4.0 } else { bound + 3.0 });
    }
    let step = policy.rounding_step.and_then(|step| step.to_string().parse::<f64>().ok());
    if let Some(step) = step {
        // Ties are rounded away from zero: a third of a step is on the same side for sure.
        let nearest = (number / step + 0.5 * number.signum()).trunc() * step;
        let third = (step / 3.0).floor();
        return Some(if number > nearest { nearest - third } else { nearest + third });
    }
    let digits = i32::from(policy.significant_digits.filter(|_| number != 0.0)?);
    let magnitude = |number: f64| 10_f64.powi(number.abs().log10().floor() as i32 + 1 - digits);
    let unit = magnitude(number);
    let nearest = (number / unit + 0.5 * number.signum()).trunc() * unit;
    // Away from zero: towards it a power of ten would have smaller units.
    let other = nearest + (magnitude(nearest) / 4.0).floor() * nearest.signum();
    (unit >= 4.0).then_some(other)
}
