//! The frame order of a course: planned in minutes, and counted by the machines from the start of each order.

use anyhow::Context as _;
use serde_json::{Value, json};
use time::{OffsetDateTime, format_description::well_known::Rfc3339};

use super::{
    decisions::{StoryDecision, decide, decisions, mapped},
    story,
};
use crate::{
    course::{Course, Timing},
    frame_order::{COLLABORATION, HAMBURG, MUNICH, NETWORK, field, operation_network, request},
    harness::Api,
};

/// Puts the network of a round in place: a new plan, and what the buyer asks for where that was never asked. What others
/// have added stays.
///
/// # Errors
/// When the platform refuses it, or a factory does not accept its part.
pub async fn send_round(platform: &Api, course: &Course, round: u32) -> anyhow::Result<String> {
    let path = format!("/api/v1/operation-networks/{NETWORK}");
    let begin = course.begin_of(round);
    let mut network = match platform.get::<Value>(&path).await {
        Ok(mut view) => view["network"].take(),
        Err(_) => operation_network(begin),
    };
    ask(&mut network, &wanted(begin)?)?;
    plan(&mut network, course, round)?;
    let body = json!({ "collaborationId": COLLABORATION, "operationNetwork": network });
    platform.put::<Value>(&path, &body).await?;
    let accepted = story::parts_are_accepted(platform).await?;
    Ok(format!("{accepted}, order {}", course.order_id(round)))
}

/// Plans the round: times of the operations, and of what lies between them.
fn plan(network: &mut Value, course: &Course, round: u32) -> anyhow::Result<()> {
    let begin = course.begin_of(round);
    let pace = course.pace;
    let timings: [(&str, Timing); 4] = [
        ("MakeFrame1", pace.make),
        ("ShipFrame1", pace.ship),
        ("InspectFrame1", pace.inspect),
        ("AssembleFrame1", pace.assemble),
    ];
    for (id, timing) in timings {
        let operation = operation(network, id)?;
        operation["plannedStart"] = json!(at(begin, timing.planned.0)?);
        operation["plannedEnd"] = json!(at(begin, timing.planned.1)?);
        operation["plannedQuantity"] = json!(timing.quantity);
    }
    network["description"] =
        json!(format!("Twelve frames for the final assembly line, {}", course.order_id(round)));
    let relations = network["operationRelationList"].as_array_mut();
    for condition in relations
        .into_iter()
        .flatten()
        .filter_map(|relation| relation.get_mut("conditionList")?.as_array_mut())
        .flatten()
    {
        let seconds =
            if condition["conditionKind"] == "MAXIMUM_GAP" { pace.gaps.0 } else { pace.gaps.1 };
        condition["duration"] = json!(format!("PT{seconds}S"));
    }
    Ok(())
}

fn at(begin: OffsetDateTime, seconds: u32) -> anyhow::Result<String> {
    Ok((begin + time::Duration::seconds(i64::from(seconds))).format(&Rfc3339)?)
}

fn operation<'a>(network: &'a mut Value, id: &str) -> anyhow::Result<&'a mut Value> {
    let operations = network["operationList"].as_array_mut().context("a network of operations")?;
    operations
        .iter_mut()
        .find(|operation| operation["operationId"] == id)
        .with_context(|| format!("the network has no operation {id}"))
}

/// Makes the network with all that the buyer asks of an order: more than [`operation_network`] asks.
fn wanted(begin: OffsetDateTime) -> anyhow::Result<Value> {
    let mut network = operation_network(begin);
    let state = |name| field(name, 12, None, Some("OPERATION_STATE"), "State of the operation");
    let pieces = |name, what| field(name, 9, Some("PIECE"), Some("PRODUCED_QUANTITY"), what);
    let of_making = [
        field("startedAt", 13, None, Some("ACTUAL_START"), "Start of the order"),
        field("expectedEnd", 13, None, Some("EXPECTED_END"), "End that the machine expects"),
        field("interruptedBy", 12, None, None, "Reason why the operation stands still"),
    ];
    let of_shipping =
        [pieces("countedFrames", "Frames that the light barrier counted"), state("shippingState")];
    fields_of(&mut network, "MakeFrame1")?.extend(of_making);
    fields_of(&mut network, "ShipFrame1")?.extend(of_shipping);
    fields_of(&mut network, "InspectFrame1")?.push(state("inspectionState"));
    let of_assembly = [pieces("assembledFuselages", "Fuselages assembled"), state("assemblyState")];
    let why = "Know when the fuselage is ready";
    operation(&mut network, "AssembleFrame1")?["dynamicDataRequestList"] =
        json!([request("ReqAssembly1", why, 60, "AssemblyReport", &of_assembly)]);
    Ok(network)
}

/// Returns the fields of the first request about an operation.
fn fields_of<'a>(network: &'a mut Value, id: &str) -> anyhow::Result<&'a mut Vec<Value>> {
    let fields = "/dynamicDataRequestList/0/reportDataFormat/reportFieldList";
    let fields = operation(network, id)?.pointer_mut(fields).and_then(Value::as_array_mut);
    fields.with_context(|| format!("{id} has no request"))
}

/// Adds the requests and fields that a network lacks of those wanted.
fn ask(network: &mut Value, wanted: &Value) -> anyhow::Result<()> {
    for wanted in items(&wanted["operationList"]) {
        let id = wanted["operationId"].as_str().unwrap_or_default();
        let operation = operation(network, id)?;
        for request in items(&wanted["dynamicDataRequestList"]) {
            let known = operation["dynamicDataRequestList"].as_array().and_then(|requests| {
                let id = &request["dynamicDataRequestId"];
                requests.iter().position(|known| known["dynamicDataRequestId"] == *id)
            });
            let fields = known.and_then(|place| {
                let fields =
                    format!("/dynamicDataRequestList/{place}/reportDataFormat/reportFieldList");
                operation.pointer_mut(&fields)?.as_array_mut()
            });
            if let Some(fields) = fields {
                for field in items(&request["reportDataFormat"]["reportFieldList"]) {
                    if fields.iter().all(|known| known["name"] != field["name"]) {
                        fields.push(field.clone());
                    }
                }
            } else if let Some(requests) = operation["dynamicDataRequestList"].as_array_mut() {
                requests.push(request.clone());
            } else {
                operation["dynamicDataRequestList"] = json!([request]);
            }
        }
    }
    Ok(())
}

fn items(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}

/// Decisions of the two engineers about an order: those of [`decisions`], but with a quantity that begins with each order,
/// and those about what the buyer asks beside.
#[must_use]
pub fn order_decisions() -> Vec<StoryDecision> {
    let counted = "progressStatus";
    let mut all = decisions();
    all.retain(|decision| decision.field != counted && decision.field != "operationState");
    let open = json!({});
    let state = "const STATES = ['NotAllowedToStart', 'Running', 'Interrupted', 'Ended'];\n\
                 (value, ctx) => STATES[Number(value)] ?? 'NotAllowedToStart'";
    let mut add = |factory, operation, request, name, (machine, key, from), steps: Value| {
        let decision = mapped(machine, key, from, None, steps, open.clone());
        all.push(decide(factory, operation, request, name, decision));
    };
    let (make, ship) = ("ReqResponse1", "ReqTransport1");
    let (inspect, assemble) = ("ReqInspection1", "ReqAssembly1");
    let as_counter = || json!([{ "function": "convert", "to": "UInt64" }]);
    let as_state = || json!([{ "function": "script", "source": state }]);
    let cell = |key, from| ("MillingCell1", key, from);
    let as_is = || json!([]);
    add(
        MUNICH,
        "MakeFrame1",
        make,
        counted,
        cell("Production.PartCounter", "UInt32"),
        as_counter(),
    );
    let shown = cell("Production.OrderState", "Int32");
    add(MUNICH, "MakeFrame1", make, "operationState", shown, as_state());
    let shown = cell("Production.OrderStart", "DateTime");
    add(MUNICH, "MakeFrame1", make, "startedAt", shown, as_is());
    let shown = cell("Production.OrderEnd", "DateTime");
    add(MUNICH, "MakeFrame1", make, "expectedEnd", shown, as_is());
    let shown = cell("Production.InterruptedBy", "String");
    add(MUNICH, "MakeFrame1", make, "interruptedBy", shown, as_is());
    let belt = |key, from| ("Conveyor1", key, from);
    add(MUNICH, "ShipFrame1", ship, "countedFrames", belt("Items.ItemCount", "UInt64"), as_is());
    add(MUNICH, "ShipFrame1", ship, "shippingState", belt("Items.OrderState", "Int32"), as_state());
    let shown = ("Press1", "Production.OrderState", "Int32");
    add(HAMBURG, "InspectFrame1", inspect, "inspectionState", shown, as_state());
    let line = |key, from| ("Conveyor2", key, from);
    let shown = line("Items.ItemCount", "UInt64");
    add(HAMBURG, "AssembleFrame1", assemble, "assembledFuselages", shown, as_is());
    let shown = line("Items.OrderState", "Int32");
    add(HAMBURG, "AssembleFrame1", assemble, "assemblyState", shown, as_state());
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::course::UNHURRIED;

    fn course() -> (Course, tempfile::TempDir) {
        let folder = tempfile::tempdir().expect("a folder");
        let course = Course::begin(&UNHURRIED, folder.path(), OffsetDateTime::UNIX_EPOCH);
        (course.expect("a course"), folder)
    }

    #[test]
    fn every_round_asks_the_same_and_plans_later() {
        let (course, _folder) = course();
        let mut network = operation_network(course.begin_of(0));
        let mut rounds = (0..2).map(|round| {
            ask(&mut network, &wanted(course.begin_of(round)).expect("a network"))
                .expect("it asks");
            plan(&mut network, &course, round).expect("it plans");
            network.clone()
        });
        let (first, second) = (rounds.next().expect("one"), rounds.next().expect("another"));
        let asked = |network: &Value| {
            let operations = network["operationList"].as_array().expect("operations").iter();
            operations
                .map(|operation| operation["dynamicDataRequestList"].clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(asked(&first), asked(&second));
        let start = |network: &Value| network["operationList"][0]["plannedStart"].clone();
        assert_eq!(
            (start(&first), start(&second)),
            (json!("1970-01-01T00:00:20Z"), json!("1970-01-01T00:20:20Z"))
        );
    }

    #[test]
    fn every_decision_is_about_a_field_that_is_asked_for() {
        let (course, _folder) = course();
        let text = wanted(course.begin_of(0)).expect("a network").to_string();
        let decisions = order_decisions();
        for decision in &decisions {
            let (request, field) = (json!(decision.request), json!(decision.field));
            assert!(text.contains(&format!("\"dynamicDataRequestId\":{request}")), "{decision:?}");
            assert!(text.contains(&format!("\"name\":{field}")), "{decision:?}");
            let same = decisions.iter().filter(|other| other.field == decision.field);
            assert_eq!(same.count(), 1, "{}", decision.field);
        }
    }
}
