//! Information of a single value.

use asi_model::{BuiltInType, network::Semantic};

use super::open_field::OpenField;

/// Returns the most bits that one value can have: the logarithm of the number of different values.
pub(super) fn bits_per_value(field: &OpenField<'_>) -> Option<f64> {
    let (policy, definition) = (field.policy, field.definition);
    let field_type = definition.field_type.0;
    if field_type == BuiltInType::Boolean {
        return Some(1.0);
    }
    let type_bits = match field_type {
        BuiltInType::SByte | BuiltInType::Byte => 8.0_f64,
        BuiltInType::Int16 | BuiltInType::UInt16 => 16.0,
        BuiltInType::Int32 | BuiltInType::UInt32 | BuiltInType::Float => 32.0,
        BuiltInType::Int64 | BuiltInType::UInt64 | BuiltInType::Double | BuiltInType::DateTime => {
            64.0
        }
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
        // Sign, digits, and the decades of the type.
        let decades: f64 = match field_type {
            BuiltInType::Double => 617.0,
            BuiltInType::Float => 77.0,
            _ => type_bits * std::f64::consts::LOG10_2,
        };
        bits = bits.min((2.0 * 9.0 * 10_f64.powi(i32::from(digits) - 1) * decades.max(1.0)).log2());
    }
    Some(bits)
}
