//! Partners of the frame order, their operations, and the requests of the buyer.

use serde_json::{Value, json};

/// The buyer, who posts the requests.
pub const BUYER: &str = "acme-aero";
/// The organisation that makes the frames.
pub const MAKER: &str = "frames-munich";
/// The organisation that inspects and assembles them.
pub const INSPECTOR: &str = "inspect-hamburg";
/// The maker's factory.
pub const MUNICH: &str = "FOR_MUC";
/// The inspector's factory.
pub const HAMBURG: &str = "INS_HAM";
/// The collaboration all three signed.
pub const COLLABORATION: &str = "frame-order-4711";
/// The network of operations.
pub const NETWORK: &str = "frame-4711";

/// Makes a report field that the buyer asks for.
pub(crate) fn field(
    name: &str,
    built_in_type: u8,
    unit: Option<&str>,
    semantic: Option<&str>,
    description: &str,
) -> Value {
    let mut field = json!({ "name": name, "type": built_in_type, "description": description });
    if let Some(unit) = unit {
        field["unit"] = json!(unit);
    }
    if let Some(semantic) = semantic {
        field["semantic"] = json!(semantic);
    }
    field
}

/// Makes a request of the buyer, with the reports per minute that it wants.
pub(crate) fn request(
    id: &str,
    purpose: &str,
    per_minute: u32,
    report_name: &str,
    fields: &[Value],
) -> Value {
    json!({
        "dynamicDataRequestId": id, "dynamicDataRequestPublisherId": "ProductionMonitoring", "requesterId": BUYER,
        "recipientList": [BUYER], "purpose": purpose, "updateFrequency": per_minute, "updateFrequencyUnit": "MINUTE",
        "reportDataFormat": { "reportName": report_name, "reportFieldList": fields }
    })
}

/// The whole network as the platform stores it: every operation with the factory that owns it.
/// `start` is the planned start of the first operation.
#[must_use]
pub fn operation_network(start: time::OffsetDateTime) -> Value {
    let at = |hours: i64| {
        let time = (start + time::Duration::hours(hours)).replace_nanosecond(0).unwrap_or(start);
        time.format(&time::format_description::well_known::Rfc3339).unwrap_or_default()
    };
    let progress = request(
        "ReqResponse1",
        "Plan the final assembly",
        60,
        "ProgressReport",
        &[
            field(
                "progressStatus",
                9,
                Some("PIECE"),
                Some("PRODUCED_QUANTITY"),
                "Frames finished so far",
            ),
            field("operationState", 12, None, Some("OPERATION_STATE"), "State of the operation"),
            field("spindlePower", 11, Some("KWT"), None, "Power drawn by the spindle"),
            field("note", 12, None, None, "A note of the shift"),
            field("machineProgram", 12, None, None, "The NC program that runs"),
        ],
    );
    let transport = request(
        "ReqTransport1",
        "Order the truck",
        1,
        "TransportReport",
        &[
            field(
                "loadedFrames",
                7,
                Some("PIECE"),
                Some("PRODUCED_QUANTITY"),
                "Frames on the truck",
            ),
            field("beltSpeed", 11, Some("2X"), None, "Speed of the loading belt"),
        ],
    );
    let inspection = request(
        "ReqInspection1",
        "Release the frames for assembly",
        60,
        "InspectionReport",
        &[
            field("goodFrames", 9, Some("PIECE"), Some("GOOD_QUANTITY"), "Frames that passed"),
            field("scrapFrames", 9, Some("PIECE"), Some("SCRAP_QUANTITY"), "Frames that failed"),
            field("stationTemperature", 11, Some("CEL"), None, "Temperature at the station"),
        ],
    );
    json!({
        "operationNetworkId": NETWORK, "name": "Frame order 4711",
        "description": "Twelve frames for the final assembly line",
        "operationList": [
            { "operationId": "MakeFrame1", "operationType": "PRODUCTION", "name": "Make frame 1", "productId": "FRAME-A",
              "owningFactoryId": MUNICH, "plannedStart": at(0), "plannedEnd": at(34), "plannedQuantity": 12,
              "quantityUnit": "PIECE",
              "equipmentRequirementList": [ { "equipmentRequirementId": "r1", "equipmentType": "ROBOT", "quantity": 1,
                "assetId": "GRU_Robot_eDO_1" } ],
              "dynamicDataRequestList": [progress] },
            { "operationId": "ShipFrame1", "operationType": "TRANSPORTATION", "name": "Ship frame 1",
              "owningFactoryId": MUNICH, "origin": "Munich", "destination": "Hamburg", "plannedStart": at(36),
              "plannedEnd": at(46), "plannedQuantity": 12, "quantityUnit": "PIECE",
              "dynamicDataRequestList": [transport] },
            { "operationId": "InspectFrame1", "operationType": "INSPECTION", "name": "Inspect frame 1",
              "owningFactoryId": HAMBURG, "inspectedOperationId": "MakeFrame1", "characteristic": "Hole positions",
              "plannedStart": at(48), "plannedEnd": at(54), "plannedQuantity": 12, "quantityUnit": "PIECE",
              "dynamicDataRequestList": [inspection] },
            { "operationId": "AssembleFrame1", "operationType": "PRODUCTION", "name": "Assemble frame 1",
              "owningFactoryId": HAMBURG, "productId": "FUSELAGE-7", "plannedStart": at(56), "plannedEnd": at(80),
              "plannedQuantity": 1, "quantityUnit": "PIECE" }
        ],
        "operationRelationList": relations()
    })
}

fn relations() -> Value {
    json!([
            { "operationRelationId": "rel1", "relationType": "FINISH_TO_START",
              "predecessorOperationId": "MakeFrame1", "successorOperationId": "ShipFrame1" },
            { "operationRelationId": "rel2", "relationType": "FINISH_TO_START",
              "predecessorOperationId": "ShipFrame1", "successorOperationId": "InspectFrame1",
              "conditionList": [ { "conditionId": "c1", "conditionKind": "MAXIMUM_GAP", "duration": "PT8H" } ] },
            { "operationRelationId": "rel3", "relationType": "FINISH_TO_START",
              "predecessorOperationId": "InspectFrame1", "successorOperationId": "AssembleFrame1",
              "conditionList": [ { "conditionId": "c2", "conditionKind": "MINIMUM_GAP", "duration": "PT1H" } ] }
    ])
}
