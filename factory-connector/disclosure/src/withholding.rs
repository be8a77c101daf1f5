//! States in which values are withheld.

use asi_model::{BuiltInType, DataValue, FieldName, Scalar, Variant};
use serde::{Deserialize, Serialize};

/// Most states that one condition lists.
pub(super) const STATES_MAX: usize = 32;
/// Most conditions of one policy.
pub(super) const CONDITIONS_MAX: usize = 8;
/// Longest text of a state, in characters.
pub(super) const STATE_CHARS_MAX: usize = 256;

/// Condition that withholds a field: while a value is in one of these states, no value of the field
/// is released, and candidates of that time never are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct WithholdCondition {
    /// Another field of the same request; absent for the field's own value. While the other field's
    /// state is not known, the condition counts as met.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub field: Option<FieldName>,
    /// The states: texts, numbers or truth values.
    pub states: Vec<StateValue>,
}

/// A state as a JSON value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(untagged)]
pub enum StateValue {
    /// Of a Boolean.
    Truth(bool),
    /// Of an integer or a number.
    Integer(i64),
    /// Of a number with a fraction.
    Number(f64),
    /// Of a text, or an integer beyond 64 bits with sign.
    Text(String),
}

impl WithholdCondition {
    /// Returns whether a value is in one of the states; `None` when that is not known: it is Bad, null or
    /// empty, or of a type that none of the states has. Variants and data values are looked into.
    #[must_use]
    pub fn is_met_by(&self, value: &DataValue) -> Option<bool> {
        if value.status.is_bad() {
            return None;
        }
        self.is_met_by_variant(&value.value)
    }

    fn is_met_by_variant(&self, value: &Variant) -> Option<bool> {
        match value {
            Variant::Null => None,
            Variant::Scalar(scalar) => self.is_met_by_scalar(scalar),
            Variant::Array(array) => {
                let mut elements = array.elements.iter();
                let first = self.is_met_by_scalar(elements.next()?);
                elements.map(|scalar| self.is_met_by_scalar(scalar)).fold(first, either)
            }
        }
    }

    fn is_met_by_scalar(&self, scalar: &Scalar) -> Option<bool> {
        match scalar {
            Scalar::Variant(held) => self.is_met_by_variant(held),
            Scalar::DataValue(held) => self.is_met_by(held),
            scalar => {
                let kind = scalar.built_in_type();
                let mut comparable =
                    self.states.iter().filter(|state| state.is_of(kind)).peekable();
                comparable.peek()?;
                Some(comparable.any(|state| state.is(scalar)))
            }
        }
    }

    /// Returns whether values of a type can be in one of the states.
    #[must_use]
    pub fn fits(&self, field_type: BuiltInType) -> bool {
        let is_looked_into = matches!(field_type, BuiltInType::Variant | BuiltInType::DataValue);
        is_looked_into || self.states.iter().any(|state| state.is_of(field_type))
    }
}

impl StateValue {
    /// Returns whether values of a type are compared with this state.
    fn is_of(&self, field_type: BuiltInType) -> bool {
        match self {
            Self::Truth(_) => field_type == BuiltInType::Boolean,
            Self::Integer(_) | Self::Number(_) => field_type.is_numeric(),
            // A text may be a whole number beyond 64 bits with sign.
            Self::Text(text) => {
                matches!(field_type, BuiltInType::String | BuiltInType::LocalizedText)
                    || (field_type.is_integer() && text.parse::<i128>().is_ok())
            }
        }
    }

    #[allow(clippy::float_cmp)]
    fn is(&self, scalar: &Scalar) -> bool {
        match (self, scalar) {
            (Self::Truth(state), Scalar::Boolean(value)) => state == value,
            (Self::Integer(state), scalar) => match scalar.as_i128() {
                Some(value) => value == i128::from(*state),
                None => scalar.as_f64().is_some_and(|value| value == i64_as_f64(*state)),
            },
            (Self::Number(state), scalar) => scalar.as_f64().is_some_and(|value| value == *state),
            (Self::Text(state), Scalar::LocalizedText(text)) => {
                text.text.as_deref() == Some(state.as_str())
            }
            (Self::Text(state), scalar) => match scalar.as_i128() {
                Some(value) => state.parse() == Ok(value),
                None => scalar.as_str() == Some(state.as_str()),
            },
            (Self::Truth(_), _) => false,
        }
    }
}

/// Returns whether one of two is met: one that is known to be, whatever the other; none where one is not
/// known and the other is not met.
const fn either(one: Option<bool>, other: Option<bool>) -> Option<bool> {
    match (one, other) {
        (Some(true), _) | (_, Some(true)) => Some(true),
        (Some(false), Some(false)) => Some(false),
        _ => None,
    }
}

#[allow(clippy::cast_precision_loss)]
const fn i64_as_f64(number: i64) -> f64 {
    number as f64
}

#[cfg(test)]
mod tests {
    use asi_model::{DateTime, StatusCode};

    use super::*;

    #[test]
    fn states_are_compared_by_value() {
        let check = |states: &str, value: Variant, expected| {
            let condition: WithholdCondition =
                serde_json::from_str(&format!(r#"{{"states":{states}}}"#)).expect("a condition");
            assert_eq!(
                condition.is_met_by(&DataValue::good(value.clone(), DateTime::MIN)),
                expected,
                "{value:?}"
            );
        };
        check(r#"["SETUP","IDLE"]"#, "SETUP".into(), Some(true));
        check(r#"["SETUP","IDLE"]"#, "setup".into(), Some(false));
        check("[3]", 3_u16.into(), Some(true));
        check("[3]", 3.0_f64.into(), Some(true));
        check("[0.5]", 0.5_f32.into(), Some(true));
        check("[true]", true.into(), Some(true));
        check("[1]", true.into(), None);
        check(r#"["7"]"#, 7_i32.into(), Some(true));
        check(r#"["SETUP"]"#, 7_i32.into(), None);
        check("[7]", "7".into(), None);
        check(r#"[7,"SETUP"]"#, "IDLE".into(), Some(false));
        let held = |value: Variant| Variant::Scalar(Scalar::Variant(Box::new(value)));
        check("[7]", held(7_i32.into()), Some(true));
        check("[7]", held("7".into()), None);
        let value = DataValue::good(7_i32, DateTime::MIN);
        check("[7]", Variant::Scalar(Scalar::DataValue(Box::new(value.clone()))), Some(true));
        let bad = DataValue { status: StatusCode::BAD_NO_DATA, ..value };
        check("[7]", Variant::Scalar(Scalar::DataValue(Box::new(bad))), None);
        check("[7]", Variant::Scalar(Scalar::DateTime(DateTime::MIN)), None);
        check(r#"["18446744073709551615"]"#, u64::MAX.into(), Some(true));
        check("[3]", Variant::Null, None);
        let condition = WithholdCondition { field: None, states: vec![StateValue::Integer(1)] };
        let lost = DataValue::status_only(StatusCode::BAD_NO_DATA, None);
        assert_eq!(condition.is_met_by(&lost), None);
    }
}
