//! Stored form of a gate's state: a JSON document with data values in the compact encoding of
//! OPC UA JSON (OPC 10000-6, 5.4).

use std::collections::{BTreeMap, VecDeque};

use asi_model::{DataValue, DateTime, FieldName, Scalar, Variant};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::stored_value::{data_value_from_json, data_value_to_json};
use crate::{Aggregation, GateState, OpenWindow, Released, Sum};

/// A gate's state as stored: data values in the compact encoding of OPC UA JSON.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct StoredGate {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    last_released_at: Option<DateTime>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    disclosed: Option<Box<RawValue>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    waiting: Vec<(DateTime, Box<RawValue>)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    released: Vec<DateTime>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    held: Option<Box<RawValue>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    window: Option<StoredWindow>,
    /// Absent in documents of former versions, and where every window counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    covered_from: Option<DateTime>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    is_in_withheld_state: bool,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    withheld_by: BTreeMap<FieldName, bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    opened_at: Option<DateTime>,
}

/// An aggregate's open window as stored. Numbers that JSON could round are texts.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct StoredWindow {
    from: DateTime,
    weighed_until: DateTime,
    weighted: String,
    weight: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    exact_sum: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sum: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    minimum: Option<Box<RawValue>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    maximum: Option<Box<RawValue>>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    has_doubtful: bool,
}

/// Stored text of an exact sum that overflowed.
const OVERFLOW: &str = "overflow";

impl StoredWindow {
    fn new(window: &OpenWindow) -> Self {
        let (exact_sum, sum) = match window.sum {
            Sum::Exact(sum) => {
                (Some(sum.map_or_else(|| OVERFLOW.to_owned(), |sum| sum.to_string())), None)
            }
            Sum::Float(sum) => (None, Some(sum.to_string())),
        };
        let scalar = |scalar: &Scalar| {
            data_value_to_json(&DataValue {
                value: Variant::Scalar(scalar.clone()),
                ..DataValue::default()
            })
        };
        Self {
            from: window.from,
            weighed_until: window.weighed_until,
            weighted: window.weighted.to_string(),
            weight: window.weight.to_string(),
            exact_sum,
            sum,
            minimum: window.minimum.as_ref().map(scalar),
            maximum: window.maximum.as_ref().map(scalar),
            has_doubtful: window.has_doubtful,
        }
    }

    fn read(&self) -> Result<OpenWindow, String> {
        let number = |text: &str| text.parse::<f64>().map_err(|error| error.to_string());
        let scalar = |json: &RawValue| match data_value_from_json(json.get())?.value {
            Variant::Scalar(scalar) => Ok(scalar),
            _ => Err("a window's extremes are single values".to_owned()),
        };
        Ok(OpenWindow {
            from: self.from,
            weighed_until: self.weighed_until,
            weighted: number(&self.weighted)?,
            weight: number(&self.weight)?,
            sum: match (&self.exact_sum, &self.sum) {
                (Some(text), _) if text == OVERFLOW => Sum::Exact(None),
                (Some(text), _) => {
                    Sum::Exact(Some(text.parse::<i128>().map_err(|error| error.to_string())?))
                }
                (None, Some(text)) => Sum::Float(number(text)?),
                (None, None) => Sum::Float(0.0),
            },
            minimum: self.minimum.as_deref().map(scalar).transpose()?,
            maximum: self.maximum.as_deref().map(scalar).transpose()?,
            has_doubtful: self.has_doubtful,
        })
    }
}

/// Encodes a gate's state as a JSON document.
#[must_use]
pub fn gate_to_json(state: &GateState) -> String {
    let stored = StoredGate {
        last_released_at: state.last_released_at,
        disclosed: state.disclosed.as_deref().map(data_value_to_json),
        waiting: state.waiting.iter().map(|(at, value)| (*at, data_value_to_json(value))).collect(),
        released: state.released.iter().copied().collect(),
        held: state.aggregation.held.as_ref().map(data_value_to_json),
        window: state.aggregation.open.as_deref().map(StoredWindow::new),
        covered_from: state.aggregation.covered_from,
        is_in_withheld_state: state.is_in_withheld_state,
        withheld_by: state.withheld_by.clone(),
        opened_at: state.opened_at,
    };
    serde_json::to_string(&stored).expect("times and JSON texts serialise")
}

/// Decodes a gate's state from a JSON document, as the store has it: what it says was released
/// counts as released.
///
/// # Errors
/// A description of the fault in the document.
pub fn gate_from_json(text: &str) -> Result<GateState, String> {
    let stored: StoredGate = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let value = |json: &RawValue| data_value_from_json(json.get());
    Ok(GateState {
        last_released_at: stored.last_released_at,
        disclosed: stored.disclosed.as_deref().map(value).transpose()?.map(Released::by_gate),
        waiting: stored
            .waiting
            .iter()
            .map(|(at, json)| value(json).map(|value| (*at, value)))
            .collect::<Result<VecDeque<_>, _>>()?,
        released: stored.released.into(),
        aggregation: Aggregation {
            held: stored.held.as_deref().map(value).transpose()?,
            open: stored.window.as_ref().map(StoredWindow::read).transpose()?.map(Box::new),
            covered_from: stored.covered_from,
        },
        is_in_withheld_state: stored.is_in_withheld_state,
        withheld_by: stored.withheld_by,
        opened_at: stored.opened_at,
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asi_model::{
        BuiltInType, NodeId, StatusCode,
        values::{Array, ExtensionBody, ExtensionObject, StructureValue},
    };

    use super::*;

    #[test]
    fn a_gates_state_survives() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let state = GateState {
            last_released_at: Some(at),
            disclosed: Some(Released::by_gate(DataValue::good(u64::MAX, at))),
            waiting: [
                (at, DataValue::good(2.5_f64, at)),
                (at, DataValue::status_only(StatusCode::BAD_NO_DATA, None)),
            ]
            .into(),
            ..GateState::default()
        };
        let json = gate_to_json(&state);
        insta::assert_snapshot!(json, @r#"{"lastReleasedAt":"2027-01-15T08:00:00Z","disclosed":{"UaType":9,"Value":"18446744073709551615","SourceTimestamp":"2027-01-15T08:00:00Z"},"waiting":[["2027-01-15T08:00:00Z",{"UaType":11,"Value":2.5,"SourceTimestamp":"2027-01-15T08:00:00Z"}],["2027-01-15T08:00:00Z",{"Status":{"Code":2157641728}}]]}"#);
        assert_eq!(gate_from_json(&json), Ok(state));
        assert_eq!(gate_from_json("{}"), Ok(GateState::default()));
    }

    #[test]
    fn values_without_content_survive() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let timed = DataValue { source_timestamp: Some(at), ..DataValue::default() };
        let waiting = [(at, DataValue::default()), (at, timed)].into();
        let state = GateState { waiting, ..GateState::default() };
        assert_eq!(gate_from_json(&gate_to_json(&state)), Ok(state));
    }

    #[test]
    fn structures_survive_with_the_types_of_their_fields() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let structure = |fields: Vec<(&str, Variant)>, switch_field, encoding_mask| {
            let fields = fields.into_iter().map(|(name, value)| (name.into(), value)).collect();
            let structure = StructureValue { fields, switch_field, encoding_mask };
            let body = ExtensionBody::Structure(structure);
            Scalar::ExtensionObject(Box::new(ExtensionObject {
                type_id: NodeId::ua(884).into(),
                body,
            }))
        };
        let range = structure(vec![("Low", 1_i64.into()), ("High", Variant::Null)], None, Some(1));
        let numbers = Array {
            element_type: BuiltInType::UInt64,
            elements: vec![Scalar::UInt64(u64::MAX)],
            dimensions: None,
        };
        let outer = structure(
            vec![
                ("Range", Variant::Scalar(range)),
                ("Numbers", Variant::Array(Arc::new(numbers))),
                ("At", Variant::Scalar(Scalar::DateTime(at))),
                ("Held", Variant::Scalar(Scalar::DataValue(Box::new(DataValue::good(1_u8, at))))),
                ("Code", Variant::Scalar(Scalar::StatusCode(StatusCode::BAD_NO_DATA))),
            ],
            Some(2),
            None,
        );
        let held = Scalar::Variant(Box::new(Variant::Scalar(outer.clone())));
        let array = Array {
            element_type: BuiltInType::Variant,
            elements: vec![held, Scalar::Variant(Box::new(Variant::from(3_i64)))],
            dimensions: None,
        };
        let code = Variant::Scalar(Scalar::StatusCode(StatusCode::BAD_NO_DATA));
        let with_times = [Variant::Scalar(outer), Variant::Array(Arc::new(array)), code.clone()];
        let with_times = with_times.map(|value| DataValue::good(value, at));
        let without = DataValue { value: code, ..DataValue::default() };
        for value in with_times.into_iter().chain([without]) {
            let state = GateState {
                disclosed: Some(Released::by_gate(value.clone())),
                waiting: [(at, value)].into(),
                ..GateState::default()
            };
            assert_eq!(gate_from_json(&gate_to_json(&state)), Ok(state));
        }
    }

    #[test]
    fn an_open_window_survives() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let window = OpenWindow {
            from: at,
            weighed_until: at,
            weighted: 0.1 + 0.2,
            weight: 3.0,
            sum: Sum::Exact(Some(i128::from(u64::MAX) * 3)),
            minimum: Some(Scalar::UInt64(u64::MAX)),
            maximum: Some(Scalar::Double(0.1)),
            has_doubtful: true,
        };
        let state = GateState {
            released: [at].into(),
            aggregation: Aggregation {
                held: Some(DataValue::good(7_u64, at)),
                open: Some(Box::new(window)),
                covered_from: Some(at),
            },
            is_in_withheld_state: true,
            withheld_by: [("state".parse().expect("a name"), false)].into(),
            ..GateState::default()
        };
        let json = gate_to_json(&state);
        insta::assert_snapshot!(json, @r#"{"released":["2027-01-15T08:00:00Z"],"held":{"UaType":9,"Value":"7","SourceTimestamp":"2027-01-15T08:00:00Z"},"window":{"from":"2027-01-15T08:00:00Z","weighedUntil":"2027-01-15T08:00:00Z","weighted":"0.30000000000000004","weight":"3","exactSum":"55340232221128654845","minimum":{"UaType":9,"Value":"18446744073709551615"},"maximum":{"UaType":11,"Value":0.1},"hasDoubtful":true},"coveredFrom":"2027-01-15T08:00:00Z","isInWithheldState":true,"withheldBy":{"state":false}}"#);
        assert_eq!(gate_from_json(&json), Ok(state.clone()));
        // As a former version stored it.
        let former = json.replace(r#""coveredFrom":"2027-01-15T08:00:00Z","#, "");
        let aggregation = Aggregation { covered_from: None, ..state.aggregation };
        assert_eq!(gate_from_json(&former), Ok(GateState { aggregation, ..state }));
    }

    #[test]
    fn a_window_of_values_without_an_order_can_be_read_again() {
        let at = DateTime::from_unix_micros(1_800_000_000_000_000);
        let policy = r#"{"aggregate":{"function":"LAST","windowMs":60000}}"#;
        let policy = std::sync::Arc::new(serde_json::from_str(policy).expect("a policy"));
        let (field_type, state) = (BuiltInType::StatusCode, GateState::default());
        let mut gate = crate::Gate::new(policy, field_type, state, at);
        let code = Variant::Scalar(Scalar::StatusCode(StatusCode::BAD_NO_DATA));
        gate.on(at, DataValue::good(code, at));
        let read = gate_from_json(&gate_to_json(&gate.state())).expect("it can be read");
        assert!(read.aggregation.open.is_some(), "the window is open still");
    }
}
