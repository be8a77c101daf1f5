//! Information of values, statuses and times: upper bounds for any behaviour of machine, script or
//! client. `docs/leak-budget.md` states the formulas and their sources.

use asi_model::{BuiltInType, DateTime, network::ReportField};

use crate::{
    DisclosurePolicy, StatusCodes,
    effects::{time_resolution_ms, values_per_hour_max},
    status_codes::COMMON,
};

/// Resolution of the times of releases without a time step, in milliseconds: messages tell no finer
/// one.
const RELEASE_RESOLUTION_MS: u64 = 1;
const HOUR_MS: f64 = 3_600_000.0;
const TICKS_PER_MS: f64 = 10_000.0;

/// Returns the most bits of one value with its status and its source time: the logarithm of the
/// number of different ones. `None` for texts and arrays, which have no bound.
pub(super) fn bits_per_value(definition: &ReportField, policy: &DisclosurePolicy) -> Option<f64> {
    let values = number_of_values(definition, policy)? + 1.0;
    let (usable, bad) = numbers_of_statuses(policy.status_codes);
    // With a usable status there is a value or none, with a bad one there is none.
    Some((values * usable + bad).log2() + source_time_bits(policy))
}

/// Returns the most bits per hour in the long run; `None` where the number or the size of values
/// has no limit.
#[must_use]
pub fn bits_per_hour(definition: &ReportField, policy: &DisclosurePolicy) -> Option<f64> {
    let values = values_per_hour_max(policy)?;
    Some(values * bits_per_value(definition, policy)? + release_bits(values, policy))
}

/// Returns the number of different values that a policy lets through.
fn number_of_values(definition: &ReportField, policy: &DisclosurePolicy) -> Option<f64> {
    let field_type = definition.field_type.0;
    if definition.value_rank != asi_model::network::VALUE_RANK_SCALAR {
        return None;
    }
    if field_type == BuiltInType::Boolean {
        return Some(2.0);
    }
    let type_bits: f64 = match field_type {
        BuiltInType::SByte | BuiltInType::Byte => 8.0,
        BuiltInType::Int16 | BuiltInType::UInt16 => 16.0,
        BuiltInType::Int32 | BuiltInType::UInt32 | BuiltInType::Float => 32.0,
        BuiltInType::Int64 | BuiltInType::UInt64 | BuiltInType::Double => 64.0,
        BuiltInType::DateTime => return Some(instants(policy)),
        _ => return None,
    };
    // "Not a number" and the infinities pass rounding, and the first of them bands.
    let (beside_bands, beside_numbers) =
        if field_type.is_integer() { (0.0, 0.0) } else { (1.0, 3.0) };
    let mut count = type_bits.exp2();
    if !policy.bands.is_empty() {
        count = count
            .min(f64::from(u32::try_from(policy.bands.len()).unwrap_or(u32::MAX)) + beside_bands);
    }
    // Only an integer's type bounds the number of steps: a meaning such as a percentage does not.
    let step = policy.rounding_step.map(|step| step.decimal().to_f64());
    if let Some(step) = step.filter(|step| field_type.is_integer() && *step >= 1.0) {
        count = count.min(type_bits.exp2() / step + 2.0);
    }
    if let Some(digits) = policy.significant_digits {
        // Signs, digits and the decades of the type; zero.
        let decades: f64 = match field_type {
            BuiltInType::Double => 633.0,
            BuiltInType::Float => 84.0,
            _ => (type_bits * std::f64::consts::LOG10_2).ceil(),
        };
        let numbers = 2.0 * 9.0 * 10_f64.powi(i32::from(digits) - 1) * decades;
        count = count.min(numbers + 1.0 + beside_numbers);
    }
    Some(count)
}

/// Returns the numbers of status codes with which a value can be, and of those without one.
fn numbers_of_statuses(resolution: StatusCodes) -> (f64, f64) {
    match resolution {
        StatusCodes::Full => (31_f64.exp2(), 31_f64.exp2()),
        StatusCodes::Common => {
            let bad = COMMON.iter().filter(|status| status.is_bad()).count();
            let count = |count: usize| f64::from(u32::try_from(count).unwrap_or(u32::MAX));
            (count(COMMON.len() - bad), count(bad))
        }
        StatusCodes::Severity => (2.0, 1.0),
    }
}

/// Returns the bits of a source time, which a machine or client can choose freely. That of a window
/// follows from the time of the release.
fn source_time_bits(policy: &DisclosurePolicy) -> f64 {
    if policy.aggregate.is_some() { 0.0 } else { instants(policy).log2() }
}

/// Returns the number of instants on the time step.
#[allow(clippy::cast_precision_loss)]
fn instants(policy: &DisclosurePolicy) -> f64 {
    let step = policy.time_step_ms.map_or(1.0, |ms| ms as f64 * TICKS_PER_MS);
    DateTime::MAX.ticks() as f64 / step + 2.0
}

/// Returns the bits in the times of so many releases per hour: each is in one of the hour's slots,
/// and no two are in the same.
#[allow(clippy::cast_precision_loss)]
fn release_bits(releases: f64, policy: &DisclosurePolicy) -> f64 {
    let resolution = time_resolution_ms(policy).max(RELEASE_RESOLUTION_MS);
    let slots = HOUR_MS / resolution as f64;
    let chosen = releases.min(slots);
    if chosen > 0.0 {
        slots.min(chosen * (std::f64::consts::E * slots / chosen).log2())
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
