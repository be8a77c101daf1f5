//! Decisions of the two engineers in the frame order, and the machines behind them.

use serde_json::{Value, json};

use crate::frame_order::{HAMBURG, MUNICH};

/// Returns the local servers of a factory, by name and kind.
#[must_use]
pub fn machines(factory_id: &str) -> [&'static str; 3] {
    if factory_id == MUNICH {
        ["MillingCell1", "Conveyor1", "Robot1"]
    } else {
        ["Press1", "Conveyor2", "Robot2"]
    }
}

/// Returns the node of a machine's variable, by its key.
#[must_use]
pub fn node(machine: &str, key: &str) -> String {
    format!("nsu=urn:verbund:simulator:{machine};s={key}")
}

/// Answer of an engineer to one requested field.
#[derive(Debug, Clone)]
pub struct StoryDecision {
    /// The factory whose engineer decides.
    pub factory_id: &'static str,
    pub operation: &'static str,
    pub request: &'static str,
    pub field: &'static str,
    /// Body of the decision in the connector's API.
    pub decision: Value,
}

pub(super) fn mapped(
    machine: &str,
    key: &str,
    value_type: &str,
    unit: Option<&str>,
    steps: Value,
    disclosure: Value,
) -> Value {
    let mut input = json!({ "name": "input", "sourceId": machine, "nodeId": node(machine, key), "valueType": value_type });
    if let Some(unit) = unit {
        input["unit"] = json!(unit);
    }
    json!({ "mappingState": "MAPPED", "valueSource": "MAPPING", "mapping": { "inputs": [input], "steps": steps },
            "disclosure": disclosure })
}

/// Decisions of the two engineers: a built-in function, a unit conversion, a script, a field left to
/// OPC UA clients, one for the operator, and one refused.
#[must_use]
pub fn decisions() -> Vec<StoryDecision> {
    let mut decisions = decisions_in_munich();
    decisions.extend(decisions_in_hamburg());
    decisions
}

pub(super) fn decide(
    factory_id: &'static str,
    operation: &'static str,
    request: &'static str,
    field: &'static str,
    decision: Value,
) -> StoryDecision {
    StoryDecision { factory_id, operation, request, field, decision }
}

fn decisions_in_munich() -> Vec<StoryDecision> {
    let state_script = "const STATES = ['AllowedToStart', 'Running', 'Interrupted', 'Interrupted'];\n\
                        (value, ctx) => STATES[Number(value)] ?? 'NotAllowedToStart'";
    vec![
        decide(
            MUNICH,
            "MakeFrame1",
            "ReqResponse1",
            "progressStatus",
            mapped(
                "MillingCell1",
                "Production.PartCounter",
                "UInt32",
                None,
                json!([{ "function": "counter" }, { "function": "convert", "to": "UInt64" }]),
                json!({}),
            ),
        ),
        decide(
            MUNICH,
            "MakeFrame1",
            "ReqResponse1",
            "operationState",
            mapped(
                "MillingCell1",
                "Status.MachineState",
                "Int32",
                None,
                json!([{ "function": "script", "source": state_script }]),
                json!({}),
            ),
        ),
        decide(
            MUNICH,
            "MakeFrame1",
            "ReqResponse1",
            "spindlePower",
            mapped(
                "MillingCell1",
                "Spindle.Power",
                "Double",
                Some("WTT"),
                json!([{ "function": "unitConversion", "from": "WTT", "to": "KWT" }]),
                json!({ "roundingStep": 0.5, "minimumIntervalMs": 1000 }),
            ),
        ),
        decide(
            MUNICH,
            "MakeFrame1",
            "ReqResponse1",
            "note",
            json!({ "mappingState": "MAPPED", "valueSource": "EXTERNAL", "disclosure": {} }),
        ),
        decide(
            MUNICH,
            "MakeFrame1",
            "ReqResponse1",
            "machineProgram",
            json!({ "mappingState": "REFUSED", "reason": "The program is our trade secret." }),
        ),
        decide(
            MUNICH,
            "ShipFrame1",
            "ReqTransport1",
            "loadedFrames",
            json!({ "mappingState": "MAPPED", "valueSource": "MANUAL", "disclosure": {} }),
        ),
    ]
}

fn decisions_in_hamburg() -> Vec<StoryDecision> {
    vec![
        decide(
            HAMBURG,
            "InspectFrame1",
            "ReqInspection1",
            "goodFrames",
            mapped(
                "Press1",
                "Production.GoodCounter",
                "UInt32",
                None,
                json!([{ "function": "convert", "to": "UInt64" }]),
                json!({}),
            ),
        ),
        decide(
            HAMBURG,
            "InspectFrame1",
            "ReqInspection1",
            "scrapFrames",
            mapped(
                "Press1",
                "Production.ScrapCounter",
                "UInt32",
                None,
                json!([{ "function": "convert", "to": "UInt64" }]),
                json!({}),
            ),
        ),
        decide(
            HAMBURG,
            "InspectFrame1",
            "ReqInspection1",
            "stationTemperature",
            mapped(
                "Press1",
                "Ram.DieTemperature",
                "Float",
                Some("CEL"),
                json!([{ "function": "convert", "to": "Double" }]),
                json!({ "roundingStep": 1.0 }),
            ),
        ),
    ]
}
