//! The HTTP control interface, JSON throughout:
//!
//! | | |
//! |---|---|
//! | `GET /machines` | the machines with their endpoints |
//! | `GET /machines/{machine}/variables` | all variables: key, node id, type, value, status, source time |
//! | `POST /machines/{machine}/variables/{key}` `{"value": 7, "status": 0}` | sets a variable at once and holds it; answers `{"sourceTimestamp": ...}` |
//! | `DELETE /machines/{machine}/variables/{key}` | lets it run again |
//! | `POST /machines/{machine}/events` `{"message": "Door open", "severity": 500}` | raises an event, see [`MachineEvent`] |
//! | `POST /machines/{machine}/conditions/{name}` `{"message": "Oil low", "severity": 700, "isActive": true}` | sets the state of a condition, see [`MachineCondition`] |
//! | `POST /machines/{machine}/faults` `{"fault": "dropConnections"}` | makes the machine fail, see [`MachineFault`] |
//!
//! Keys are the browse names below the machine, as `Spindle.Temperature`. There is no access
//! control.

use asi_model::{DataValue, Scalar, StatusCode, Variant, values::BuiltInType};
use axum::{
    Json, Router,
    extract::{Path, State},
    http::StatusCode as HttpStatus,
    response::{IntoResponse, Response},
    routing::{get, post},
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    MachineCondition, MachineEvent, MachineFault, MachineHandle, SimulatorError, SimulatorHandle,
};

/// The interface to a simulation.
pub fn router(simulator: SimulatorHandle) -> Router {
    Router::new()
        .route("/machines", get(machines))
        .route("/machines/{machine}/variables", get(variables))
        .route("/machines/{machine}/variables/{key}", post(set).delete(release))
        .route("/machines/{machine}/events", post(raise))
        .route("/machines/{machine}/conditions/{name}", post(set_condition))
        .route("/machines/{machine}/faults", post(inject))
        .with_state(simulator)
}

struct ControlProblem(SimulatorError);

impl From<SimulatorError> for ControlProblem {
    fn from(error: SimulatorError) -> Self {
        Self(error)
    }
}

impl IntoResponse for ControlProblem {
    fn into_response(self) -> Response {
        let status = match self.0 {
            SimulatorError::UnknownMachine(_) | SimulatorError::UnknownVariable(_) => {
                HttpStatus::NOT_FOUND
            }
            SimulatorError::WrongType { .. }
            | SimulatorError::NoRelay
            | SimulatorError::Config(_) => HttpStatus::UNPROCESSABLE_ENTITY,
            SimulatorError::Down | SimulatorError::Stopped => HttpStatus::SERVICE_UNAVAILABLE,
            SimulatorError::Listen { .. } | SimulatorError::Server { .. } => {
                HttpStatus::INTERNAL_SERVER_ERROR
            }
        };
        let body = json!({ "title": self.0.to_string(), "status": status.as_u16() });
        (status, [("content-type", "application/problem+json")], body.to_string()).into_response()
    }
}

fn machine<'a>(
    simulator: &'a SimulatorHandle,
    name: &str,
) -> Result<&'a MachineHandle, ControlProblem> {
    Ok(simulator.machine(name).ok_or_else(|| SimulatorError::UnknownMachine(name.to_owned()))?)
}

async fn machines(State(simulator): State<SimulatorHandle>) -> Json<Value> {
    let machines = simulator.machines().map(|machine| {
        json!({
            "name": machine.name(),
            "kind": machine.config().kind,
            "endpointUrl": machine.endpoint_url(),
            "namespaceUri": machine.config().namespace_uri(),
        })
    });
    Json(machines.collect())
}

async fn variables(
    State(simulator): State<SimulatorHandle>,
    Path(name): Path<String>,
) -> Result<Json<Value>, ControlProblem> {
    let machine = machine(&simulator, &name)?;
    let values = machine.values().await?;
    let variables = values.into_iter().map(|(key, built_in, value)| {
        json!({
            "key": key,
            "nodeId": machine.node_id(&key).map(|id| id.to_string()),
            "type": built_in.name(),
            "value": to_json(&value),
            "status": value.status.0,
            "sourceTimestamp": value.source_timestamp,
        })
    });
    Ok(Json(variables.collect()))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NewValue {
    value: Value,
    #[serde(default)]
    status: u32,
}

async fn set(
    State(simulator): State<SimulatorHandle>,
    Path((name, key)): Path<(String, String)>,
    Json(new): Json<NewValue>,
) -> Result<Json<Value>, ControlProblem> {
    let machine = machine(&simulator, &name)?;
    let known = machine.values().await?;
    let built_in =
        known.into_iter().find(|(known, ..)| *known == key).map(|(_, built_in, _)| built_in);
    let built_in = built_in.ok_or_else(|| SimulatorError::UnknownVariable(key.clone()))?;
    let value =
        from_json(&new.value, built_in).ok_or(SimulatorError::WrongType { expected: built_in })?;
    let at = machine.set_with_status(&key, value, StatusCode(new.status)).await?;
    Ok(Json(json!({ "sourceTimestamp": at })))
}

async fn release(
    State(simulator): State<SimulatorHandle>,
    Path((name, key)): Path<(String, String)>,
) -> Result<HttpStatus, ControlProblem> {
    machine(&simulator, &name)?.release(&key).await?;
    Ok(HttpStatus::NO_CONTENT)
}

async fn raise(
    State(simulator): State<SimulatorHandle>,
    Path(name): Path<String>,
    Json(event): Json<MachineEvent>,
) -> Result<Json<Value>, ControlProblem> {
    let at = machine(&simulator, &name)?.raise(&event.message, event.severity).await?;
    Ok(Json(json!({ "time": at })))
}

async fn set_condition(
    State(simulator): State<SimulatorHandle>,
    Path((name, condition)): Path<(String, String)>,
    Json(state): Json<MachineCondition>,
) -> Result<Json<Value>, ControlProblem> {
    let at = machine(&simulator, &name)?.set_condition(&condition, state).await?;
    Ok(Json(json!({ "time": at })))
}

async fn inject(
    State(simulator): State<SimulatorHandle>,
    Path(name): Path<String>,
    Json(fault): Json<MachineFault>,
) -> Result<HttpStatus, ControlProblem> {
    machine(&simulator, &name)?.inject(fault).await?;
    Ok(HttpStatus::NO_CONTENT)
}

/// Plain JSON for people and tests: numbers as numbers, 64-bit integers as texts.
fn to_json(value: &DataValue) -> Value {
    let scalar = |scalar: &Scalar| match scalar {
        Scalar::Boolean(value) => json!(value),
        Scalar::Int64(value) => json!(value.to_string()),
        Scalar::UInt64(value) => json!(value.to_string()),
        Scalar::String(text) => json!(text),
        Scalar::LocalizedText(text) => json!(text.text),
        Scalar::DateTime(time) => json!(time),
        number if number.built_in_type().is_integer() => {
            json!(number.as_i128().and_then(|n| i64::try_from(n).ok()))
        }
        number if number.built_in_type().is_numeric() => json!(number.as_f64()),
        other => json!(format!("{other:?}")),
    };
    match &value.value {
        Variant::Null => Value::Null,
        Variant::Scalar(value) => scalar(value),
        Variant::Array(array) => array.elements.iter().map(scalar).collect(),
    }
}

/// JSON as a scalar of a type, if it fits.
fn from_json(value: &Value, wanted: BuiltInType) -> Option<Variant> {
    let scalar = match wanted {
        BuiltInType::Boolean => Scalar::Boolean(value.as_bool()?),
        BuiltInType::String => Scalar::String(Some(value.as_str()?.into())),
        BuiltInType::LocalizedText => {
            let text = asi_model::values::LocalizedText {
                locale: None,
                text: Some(value.as_str()?.into()),
            };
            Scalar::LocalizedText(Box::new(text))
        }
        BuiltInType::DateTime => Scalar::DateTime(value.as_str()?.parse().ok()?),
        BuiltInType::Float => Scalar::Float(value.as_f64()? as f32),
        BuiltInType::Double => Scalar::Double(value.as_f64()?),
        integer if integer.is_integer() => {
            let number = match value {
                Value::String(text) => text.parse().ok()?,
                Value::Number(number) => number.to_string().parse().ok()?,
                _ => return None,
            };
            Scalar::from_i128(number, integer)?
        }
        _ => return None,
    };
    Some(scalar.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_becomes_the_variables_type_or_nothing() {
        for (json, wanted, expected) in [
            (json!(7), BuiltInType::UInt32, Some(Variant::from(7_u32))),
            (
                json!("9007199254740993"),
                BuiltInType::UInt64,
                Some(Variant::from(9_007_199_254_740_993_u64)),
            ),
            (json!(1), BuiltInType::Double, Some(Variant::from(1.0))),
            (json!(-1), BuiltInType::UInt32, None),
            (json!(1.5), BuiltInType::Int32, None),
            (json!("x"), BuiltInType::Boolean, None),
        ] {
            assert_eq!(from_json(&json, wanted), expected, "{json} as {wanted}");
        }
    }
}
