//! States in which values are withheld.

use asi_model::{DataValue, FieldName, Scalar, Variant};
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
    /// Returns whether a value is in one of the states; `None` when the value is Bad or null.
    #[must_use]
    pub fn is_met_by(&self, value: &DataValue) -> Option<bool> {
        if value.status.is_bad() {
            return None;
        }
        let is_state = |scalar: &Scalar| self.states.iter().any(|state| state.is(scalar));
        match &value.value {
            Variant::Null => None,
            Variant::Scalar(scalar) => Some(is_state(scalar)),
            Variant::Array(array) => Some(array.elements.iter().any(is_state)),
        }
    }
}

impl StateValue {
    #[allow(clippy::float_cmp)]
    fn is(&self, scalar: &Scalar) -> bool {
        match (self, scalar) {
            (Self::Truth(state), Scalar::Boolean(value)) => state == value,
            (_, Scalar::Boolean(_)) => false,
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
        check("[1]", true.into(), Some(false));
        check(r#"["18446744073709551615"]"#, u64::MAX.into(), Some(true));
        check("[3]", Variant::Null, None);
        let condition = WithholdCondition { field: None, states: vec![StateValue::Integer(1)] };
        let lost = DataValue::status_only(StatusCode::BAD_NO_DATA, None);
        assert_eq!(condition.is_met_by(&lost), None);
    }
}
