//! Every kind of fault, with its pointer.

mod at_once;

use serde_json::{Value, json};

use super::*;

fn factory() -> FactoryId {
    "FOR_MUC".parse().expect("valid")
}

/// The example of the contract.
fn request() -> Value {
    serde_json::from_str(include_str!("../../examples/operation-network.json"))
        .expect("the example is JSON")
}

fn faults_of(message: &Value) -> Vec<(String, String)> {
    match parse_platform_message(message.to_string().as_bytes(), &factory()) {
        Ok(_) => Vec::new(),
        Err(rejection) => {
            rejection.faults.into_iter().map(|fault| (fault.pointer, fault.code)).collect()
        }
    }
}

/// The example with one place replaced (or added, or removed by null) yields exactly these faults.
fn check(pointer: &str, replacement: Value, expected: &[(&str, &str)]) {
    let mut message = request();
    let (parent, name) = pointer.rsplit_once('/').expect("not the root");
    let parent = message.pointer_mut(parent).expect("the parent exists");
    match parent {
        Value::Object(members) if replacement.is_null() => {
            members.shift_remove(name);
        }
        Value::Object(members) => {
            members.insert(name.to_owned(), replacement);
        }
        Value::Array(elements) if name == "-" => elements.push(replacement),
        Value::Array(elements) => elements[name.parse::<usize>().expect("an index")] = replacement,
        _ => panic!("{pointer} has no parent"),
    }
    let found = faults_of(&message);
    let found: Vec<(&str, &str)> =
        found.iter().map(|(pointer, code)| (pointer.as_str(), code.as_str())).collect();
    assert_eq!(found, expected, "{pointer}");
}

const NET: &str = "/operationNetwork";
const OP: &str = "/operationNetwork/operationList/0";
const REQ: &str = "/operationNetwork/operationList/0/dynamicDataRequestList/0";
const FIELDS: &str =
    "/operationNetwork/operationList/0/dynamicDataRequestList/0/reportDataFormat/reportFieldList";
const REL: &str = "/operationNetwork/operationRelationList/0";

#[test]
fn the_example_is_accepted() {
    assert_eq!(faults_of(&request()), []);
}

#[test]
fn structure_is_checked() {
    check("/factoryId", json!("OTHER"), &[("/factoryId", "WRONG_FACTORY")]);
    check("/factoryId", json!(7), &[("/factoryId", "WRONG_TYPE")]);
    check("/messageId", Value::Null, &[("/messageId", "MISSING_MEMBER")]);
    check("/messageType", json!("order"), &[("/messageType", "UNKNOWN_MESSAGE_TYPE")]);
    check("/revision", json!("3"), &[("/revision", "WRONG_TYPE")]);
    check("/revision", json!(-1), &[("/revision", "INVALID_VALUE")]);
    check("/revision", json!(u64::MAX), &[("/revision", "INVALID_VALUE")]);
    check(
        &format!("{NET}/operationList"),
        json!([]),
        &[
            (&format!("{NET}/operationList"), "EMPTY_LIST"),
            (&format!("{REL}/predecessorOperationId"), "UNKNOWN_OPERATION"),
            (&format!("{REL}/successorOperationId"), "UNKNOWN_OPERATION"),
        ],
    );
    check(
        &format!("{OP}/operationType"),
        json!("MAKING"),
        &[(&format!("{OP}/operationType"), "INVALID_VALUE")],
    );
    check(
        &format!("{OP}/plannedStart"),
        json!("today"),
        &[(&format!("{OP}/plannedStart"), "INVALID_VALUE")],
    );
    check(
        &format!("{OP}/plannedQuantity"),
        json!(-1),
        &[(&format!("{OP}/plannedQuantity"), "INVALID_VALUE")],
    );
    check(
        &format!("{OP}/operationId"),
        json!("a\u{0}"),
        &[(&format!("{OP}/operationId"), "INVALID_ID")],
    );
    check(
        &format!("{OP}/name"),
        json!("x".repeat(300)),
        &[(&format!("{OP}/name"), "TEXT_TOO_LONG")],
    );
    check(&format!("{OP}/name"), json!("a\u{8}"), &[(&format!("{OP}/name"), "INVALID_VALUE")]);
    check(&format!("{OP}/description"), json!("tab\tline\r\n\u{9f}"), &[]);
    check(
        &format!("{OP}/description"),
        json!("\u{FFFE}"),
        &[(&format!("{OP}/description"), "INVALID_VALUE")],
    );
    check(&format!("{REQ}/purpose"), json!(" "), &[(&format!("{REQ}/purpose"), "INVALID_VALUE")]);
    check(
        &format!("{REQ}/recipientList"),
        json!([]),
        &[(&format!("{REQ}/recipientList"), "EMPTY_LIST")],
    );
    check(
        &format!("{REQ}/recipientList"),
        json!(["a", "a"]),
        &[(&format!("{REQ}/recipientList/1"), "DUPLICATE_ID")],
    );
    check(&format!("{OP}/unknownMember"), json!({ "x": [1] }), &[]);
}

#[test]
fn fields_are_checked() {
    let field = |name: &str| json!({ "name": name, "type": 9 });
    check(&format!("{FIELDS}/0/type"), json!(0), &[(&format!("{FIELDS}/0/type"), "UNKNOWN_TYPE")]);
    check(&format!("{FIELDS}/0/type"), json!(26), &[(&format!("{FIELDS}/0/type"), "UNKNOWN_TYPE")]);
    check(
        &format!("{FIELDS}/0/type"),
        json!("Integer"),
        &[(&format!("{FIELDS}/0/type"), "UNKNOWN_TYPE")],
    );
    check(&format!("{FIELDS}/0/type"), json!("UInt64"), &[]);
    check(
        &format!("{FIELDS}/0/unit"),
        json!("SMOOT"),
        &[(&format!("{FIELDS}/0/unit"), "UNKNOWN_UNIT")],
    );
    check(
        &format!("{FIELDS}/0/valueRank"),
        json!(0),
        &[(&format!("{FIELDS}/0/valueRank"), "INVALID_VALUE_RANK")],
    );
    check(
        &format!("{FIELDS}/0/semantic"),
        json!("PROGRESS"),
        &[(&format!("{FIELDS}/0/semantic"), "INVALID_VALUE")],
    );
    check(&format!("{FIELDS}/0/semantic"), json!("urn:x:y"), &[]);
    check(
        &format!("{FIELDS}/0/semantic"),
        json!("ACTUAL_END"),
        &[(&format!("{FIELDS}/0/semantic"), "SEMANTIC_TYPE_MISMATCH")],
    );
    for member in ["operationId", "recipientList"] {
        check(
            &format!("{FIELDS}/0/name"),
            json!(member),
            &[(&format!("{FIELDS}/0/name"), "RESERVED_FIELD_NAME")],
        );
    }
    check(
        &format!("{FIELDS}/0/name"),
        json!("1st"),
        &[(&format!("{FIELDS}/0/name"), "INVALID_ID")],
    );
    check(
        &format!("{FIELDS}/-"),
        field("progressStatus"),
        &[(&format!("{FIELDS}/1/name"), "DUPLICATE_FIELD")],
    );
    check(
        &format!("{FIELDS}/-"),
        field("progressStatusUnit"),
        &[(&format!("{FIELDS}/1/name"), "UNIT_FIELD_COLLISION")],
    );
    check(
        &format!("{REQ}/updateFrequencyUnit"),
        Value::Null,
        &[(&format!("{REQ}/updateFrequencyUnit"), "UPDATE_FREQUENCY_INCOMPLETE")],
    );
    check(
        &format!("{REQ}/validFrom"),
        json!("2020-01-01T00:00:00Z"),
        &[(&format!("{REQ}/validUntil"), "TIME_FRAME_INVERTED")],
    );
}

#[test]
fn the_network_is_checked() {
    check(
        &format!("{REL}/predecessorOperationId"),
        json!("Nothing"),
        &[(&format!("{REL}/predecessorOperationId"), "UNKNOWN_OPERATION")],
    );
    check(
        &format!("{REL}/predecessorOperationId"),
        json!("InspectFrame1"),
        &[(&format!("{REL}/successorOperationId"), "SELF_REFERENCE")],
    );
    check(
        &format!("{NET}/operationRelationList/-"),
        json!({ "operationRelationId": "rel2", "relationType": "START_TO_START",
            "predecessorOperationId": "InspectFrame1", "successorOperationId": "MakeFrame1" }),
        &[("/operationNetwork/operationRelationList/1", "CYCLE")],
    );
    check(
        &format!("{NET}/operationList/1/operationId"),
        json!("MakeFrame1"),
        &[
            (&format!("{NET}/operationList/1/operationId"), "DUPLICATE_ID"),
            (&format!("{REL}/successorOperationId"), "UNKNOWN_OPERATION"),
        ],
    );
    check(
        &format!("{NET}/operationList/1/owningFactoryId"),
        Value::Null,
        &[(&format!("{NET}/operationList/1/owningFactoryId"), "OWNER_MISSING")],
    );
    check(
        &format!("{NET}/operationList/1/stub"),
        Value::Null,
        &[(&format!("{NET}/operationList/1/owningFactoryId"), "WRONG_OWNER")],
    );
    check(
        &format!("{OP}/plannedEnd"),
        json!("2019-04-17T00:00:00Z"),
        &[(&format!("{OP}/plannedEnd"), "TIME_FRAME_INVERTED")],
    );
    check(
        &format!("{REL}/conditionList/0/duration"),
        Value::Null,
        &[(&format!("{REL}/conditionList/0/duration"), "CONDITION_NEEDS_DURATION")],
    );
    check(
        &format!("{REL}/conditionList/0/duration"),
        json!("P1M"),
        &[(&format!("{REL}/conditionList/0/duration"), "INVALID_VALUE")],
    );
    check(
        &format!("{REL}/conditionList/0/time"),
        json!("2019-04-17T00:00:00Z"),
        &[(&format!("{REL}/conditionList/0/time"), "CONDITION_NEEDS_DURATION")],
    );
    check(
        &format!("{REL}/conditionList/-"),
        json!({ "conditionId": "c2", "conditionKind": "MINIMUM_GAP", "duration": "PT9H" }),
        &[(&format!("{REL}/conditionList"), "CONDITIONS_CONTRADICT")],
    );
    check(
        &format!("{NET}/operationList/1/plannedStart"),
        json!("2019-04-19T15:00:00Z"),
        &[(&format!("{NET}/operationList/1/plannedStart"), "TIME_FRAME_INFEASIBLE")],
    );
    check(
        &format!("{NET}/operationList/1/plannedStart"),
        json!("2019-04-20T01:00:00Z"),
        &[(&format!("{REL}/conditionList/0"), "TIME_FRAME_INFEASIBLE")],
    );
}

#[test]
fn all_faults_come_at_once() {
    let mut message = request();
    message["factoryId"] = json!("OTHER");
    message["operationNetwork"]["operationList"][0]["plannedStart"] = json!("soon");
    message["operationNetwork"]["operationRelationList"][0]["successorOperationId"] =
        json!("Nothing");
    assert_eq!(faults_of(&message).len(), 3);
    let rejection = parse_platform_message(message.to_string().as_bytes(), &factory())
        .expect_err("three faults");
    assert_eq!(
        rejection.message_id.as_ref().map(|id| id.as_str()),
        Some("0190c0de-0000-7000-8000-000000000001")
    );
    assert_eq!(rejection.operation_network_id.as_ref().map(|id| id.as_str()), Some("frame-4711"));
    assert_eq!(rejection.revision, Some(3));
}

#[test]
fn rubbish_is_named() {
    for (body, code) in [
        (b"frames!".to_vec(), "NOT_JSON"),
        (b"\xff\xfe".to_vec(), "NOT_JSON"),
        (b"[]".to_vec(), "WRONG_TYPE"),
        (b"{}".to_vec(), "MISSING_MEMBER"),
        ("[".repeat(200_000).into_bytes(), "TOO_DEEP"),
        (vec![b' '; REQUEST_BYTES_MAX + 1], "TOO_LARGE"),
        (format!("[{}0]", "0,".repeat(400_000)).into_bytes(), "TOO_MANY_VALUES"),
        (br#"{"messageType":"withdraw","messageType":"withdraw"}"#.to_vec(), "DUPLICATE_MEMBER"),
    ] {
        let rejection = parse_platform_message(&body, &factory()).expect_err(code);
        assert_eq!(rejection.faults[0].code, code);
    }
}

#[test]
fn faults_are_bounded() {
    let mut message = request();
    let broken: Vec<Value> =
        (0..400).map(|_| json!({ "name": 5, "type": "x".repeat(900) })).collect();
    message["operationNetwork"]["operationList"][0]["dynamicDataRequestList"][0]["reportDataFormat"]
        ["reportFieldList"] = json!(broken);
    let faults = faults_of(&message);
    assert_eq!(faults.len(), FAULTS_MAX + 1);
    assert_eq!(faults[FAULTS_MAX].1, "TOO_MANY_FAULTS");
}
