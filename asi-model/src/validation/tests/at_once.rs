//! All faults at once, where some hide what others are about.

use serde_json::{Value, json};

use super::{NET, OP, REL, REQ, faults_of, request};
use crate::validation::validate_network;

/// The example with changes yields exactly these faults, in this order.
fn check_changed(change: impl FnOnce(&mut Value), expected: &[(&str, &str)]) {
    let mut message = request();
    change(&mut message["operationNetwork"]);
    let found = faults_of(&message);
    let found: Vec<(&str, &str)> =
        found.iter().map(|(pointer, code)| (pointer.as_str(), code.as_str())).collect();
    assert_eq!(found, expected);
}

fn insert(list: &mut Value, index: usize, element: Value) {
    list.as_array_mut().expect("a list").insert(index, element);
}

#[test]
fn what_is_no_object_hides_no_other_fault() {
    // Pointers are those of the text, and nothing is said to be missing that may be what is there.
    check_changed(
        |network| {
            network["operationList"][0]["quantityUnit"] = json!("SMOOT");
            network["operationRelationList"][0]["successorOperationId"] = json!("Nothing");
            insert(&mut network["operationList"], 0, json!(5));
        },
        &[
            (&format!("{NET}/operationList/0"), "WRONG_TYPE"),
            (&format!("{NET}/operationList/1/quantityUnit"), "UNKNOWN_UNIT"),
        ],
    );
    check_changed(
        |network| {
            let relations = &mut network["operationRelationList"];
            relations[0]["successorOperationId"] = json!("Nothing");
            insert(&mut relations[0]["conditionList"], 0, json!("soon"));
            insert(
                &mut relations[0]["conditionList"],
                2,
                json!({ "conditionId": "c1",
                "conditionKind": "MINIMUM_GAP", "duration": "PT1H" }),
            );
            insert(relations, 0, Value::Null);
            network["operationList"][1]["operationId"] = json!("MakeFrame1");
        },
        &[
            (&format!("{NET}/operationRelationList/0"), "WRONG_TYPE"),
            (&format!("{NET}/operationRelationList/1/conditionList/0"), "WRONG_TYPE"),
            (&format!("{NET}/operationList/1/operationId"), "DUPLICATE_ID"),
            (&format!("{NET}/operationRelationList/1/conditionList/2/conditionId"), "DUPLICATE_ID"),
            (&format!("{NET}/operationRelationList/1/successorOperationId"), "UNKNOWN_OPERATION"),
        ],
    );
    check_changed(
        |network| {
            let operation = &mut network["operationList"][0];
            insert(&mut operation["equipmentRequirementList"], 0, json!([]));
            let requests = &mut operation["dynamicDataRequestList"];
            let fields = &mut requests[0]["reportDataFormat"]["reportFieldList"];
            insert(fields, 0, json!("progress"));
            fields[1]["unit"] = json!("SMOOT");
            insert(requests, 0, json!(true));
        },
        &[
            (&format!("{OP}/equipmentRequirementList/0"), "WRONG_TYPE"),
            (&format!("{OP}/dynamicDataRequestList/0"), "WRONG_TYPE"),
            (
                &format!("{OP}/dynamicDataRequestList/1/reportDataFormat/reportFieldList/0"),
                "WRONG_TYPE",
            ),
            (
                &format!("{OP}/dynamicDataRequestList/1/reportDataFormat/reportFieldList/1/unit"),
                "UNKNOWN_UNIT",
            ),
        ],
    );
    check_changed(
        |network| network["operationList"] = json!({}),
        &[(&format!("{NET}/operationList"), "WRONG_TYPE")],
    );
}

#[test]
fn time_frames_are_judged_beside_faults_of_other_things() {
    let late = json!("2019-04-20T01:00:00Z");
    let infeasible = format!("{REL}/conditionList/0");
    check_changed(
        |network| {
            network["operationList"][0]["quantityUnit"] = json!("SMOOT");
            network["operationList"][0]["dynamicDataRequestList"][0]["purpose"] = json!(7);
            network["operationList"][1]["plannedStart"] = late.clone();
        },
        &[
            (&format!("{REQ}/purpose"), "WRONG_TYPE"),
            (&format!("{OP}/quantityUnit"), "UNKNOWN_UNIT"),
            (&infeasible, "TIME_FRAME_INFEASIBLE"),
        ],
    );
    // A plan that is wrong itself proves nothing about the others.
    check_changed(
        |network| {
            network["operationList"][0]["plannedEnd"] = json!("2019-04-17T00:00:00Z");
            network["operationList"][1]["plannedStart"] = late.clone();
        },
        &[(&format!("{OP}/plannedEnd"), "TIME_FRAME_INVERTED")],
    );
    check_changed(
        |network| {
            network["operationRelationList"][0]["relationType"] = json!("AFTER");
            network["operationList"][1]["plannedStart"] = late.clone();
        },
        &[(&format!("{REL}/relationType"), "INVALID_VALUE")],
    );
}

#[test]
fn networks_that_are_no_text_show_all_faults_too() {
    let message =
        super::parse_platform_message(request().to_string().as_bytes(), &super::factory());
    let Ok(crate::messages::PlatformMessage::OperationNetwork(message)) = message else {
        panic!("the example is a request")
    };
    let mut network = message.operation_network;
    network.operation_list[0].quantity_unit = Some("SMOOT".to_owned());
    network.operation_relation_list[0].condition_list[0].duration = None;
    let faults = validate_network(&network);
    let found: Vec<_> =
        faults.iter().map(|fault| (fault.pointer.as_str(), fault.code.as_str())).collect();
    assert_eq!(
        found,
        [
            ("/operationList/0/quantityUnit", "UNKNOWN_UNIT"),
            ("/operationRelationList/0/conditionList/0/duration", "CONDITION_NEEDS_DURATION"),
        ]
    );
}

#[test]
fn a_member_with_other_capitals_is_named() {
    let mut message = request();
    let kind = message["messageType"].take();
    message.as_object_mut().expect("an object").shift_remove("messageType");
    message["MessageType"] = kind;
    let rejection =
        super::parse_platform_message(message.to_string().as_bytes(), &super::factory())
            .expect_err("no messageType");
    let fault = &rejection.faults[0];
    assert_eq!((fault.pointer.as_str(), fault.code.as_str()), ("/messageType", "MISSING_MEMBER"));
    assert_eq!(
        fault.message,
        "The member messageType is missing; MessageType differs from it in capitals."
    );
}
