//! Writes and method calls.

use asi_model::{StatusCode as ModelStatus, messages::MappingState};
use opcua_stack::opcua::types::{CallMethodRequest, NodeId, StatusCode, Variant};
use twin::Role;

use crate::harness::{
    Client, TYPES, TestTwin, document, external, field, field_id, instance, message,
};

#[tokio::test]
async fn only_external_fields_are_written_and_only_by_roles_with_the_right() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let (viewer, operator) = (twin.client("vera").await, twin.client("otto").await);
    let id = field_id("net", "progressStatus");

    assert_eq!(operator.write(&id, 5_u64).await, StatusCode::BadNotWritable, "undecided");
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    assert_eq!(viewer.write(&id, 5_u64).await, StatusCode::BadUserAccessDenied);
    assert_eq!(operator.write(&id, 5_u64).await, StatusCode::Good);
    assert_eq!(operator.read(&id).await.value, Some(5_u64.into()));
    assert_eq!(operator.write(&format!("{id}#IsMapped"), true).await, StatusCode::BadNotWritable);
    assert_eq!(operator.write("net/op/nothing", 1).await, StatusCode::BadNodeIdUnknown);
    assert_eq!(operator.write("net", 1).await, StatusCode::BadAttributeIdInvalid, "an object");
    {
        let writes = twin.connector.writes.lock();
        assert_eq!(writes.len(), 1, "what is refused never reaches the connector");
        assert_eq!((writes[0].2.name.as_ref(), writes[0].2.role), ("otto", Role::Operator));
        assert!(writes[0].1.source_timestamp.is_some());
    }
    *twin.connector.answer.lock() = Some(ModelStatus::GOOD_CLAMPED);
    assert_eq!(
        operator.write(&id, 6_u64).await,
        StatusCode::GoodClamped,
        "the connector's answer is passed on"
    );
    viewer.close().await;
    operator.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn values_must_fit_the_field() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    for name in ["progressStatus", "percent", "temperatures", "state"] {
        twin.handle.publish_decision(&field("net", name), external());
    }
    let client = twin.client("otto").await;
    let checks: Vec<(&str, Variant, StatusCode)> = vec![
        ("progressStatus", 5_i32.into(), StatusCode::BadTypeMismatch),
        ("progressStatus", Variant::Empty, StatusCode::BadTypeMismatch),
        ("progressStatus", vec![5_u64].into(), StatusCode::BadTypeMismatch),
        ("progressStatus", 5_000_u64.into(), StatusCode::Good),
        ("percent", 101.0.into(), StatusCode::BadOutOfRange),
        ("percent", f64::NAN.into(), StatusCode::BadOutOfRange),
        ("percent", 100.0.into(), StatusCode::Good),
        ("temperatures", 20.5_f32.into(), StatusCode::BadTypeMismatch),
        ("temperatures", vec![20.5_f32, 21.0].into(), StatusCode::Good),
        ("temperatures", vec![20.5_f64].into(), StatusCode::BadTypeMismatch),
        ("state", "Sleeping".into(), StatusCode::BadOutOfRange),
        ("state", "Running".into(), StatusCode::Good),
    ];
    for (name, value, expected) in checks {
        let shown = format!("{name} = {value:?}");
        assert_eq!(client.write(&field_id("net", name), value).await, expected, "{shown}");
    }
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn an_interface_is_exported_as_a_node_set() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let request = CallMethodRequest {
        object_id: instance("net"),
        method_id: instance("net#ExportNodeSet"),
        input_arguments: None,
    };
    let result = client.session.call_one(request).await.unwrap();
    assert_eq!(result.status_code, StatusCode::Good);
    let Some(Variant::ByteString(document)) = result.output_arguments.unwrap().pop() else {
        panic!("the document is a byte string")
    };
    let read = asi_model::node_set::read(document.as_ref()).unwrap();
    let json = asi_model::instance::to_json(&read, "again").unwrap();
    let again = asi_model::validation::parse_platform_message(
        json.to_string().as_bytes(),
        &"FOR_MUC".parse().unwrap(),
    );
    let Ok(asi_model::messages::PlatformMessage::OperationNetwork(again)) = again else {
        panic!("what was exported can be read: {again:?}")
    };
    assert_eq!(again.operation_network, message("net", 1).operation_network);
    client.close().await;
    twin.stop().await;
}

async fn decide(
    client: &Client,
    method: NodeId,
    arguments: Vec<Variant>,
) -> (StatusCode, Vec<StatusCode>) {
    let request = CallMethodRequest {
        object_id: instance("net/op/MakeFrame1/req/ReqResponse1"),
        method_id: method,
        input_arguments: Some(arguments),
    };
    let result = client.session.call_one(request).await.unwrap();
    (result.status_code, result.input_argument_results.unwrap_or_default())
}

#[tokio::test]
async fn an_engineer_decides_through_the_method() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let (engineer, operator) = (twin.client("anna").await, twin.client("otto").await);
    let own = || instance("net/op/MakeFrame1/req/ReqResponse1#Decide");
    let refuse = |reason: Variant| vec!["percent".into(), 2_i32.into(), reason];

    let denied = decide(&operator, own(), refuse("no".into())).await.0;
    assert_eq!(denied, StatusCode::BadUserAccessDenied);
    let missing = decide(&engineer, own(), vec!["percent".into()]).await.0;
    assert_eq!(missing, StatusCode::BadArgumentsMissing);
    let (status, arguments) = decide(&engineer, own(), refuse(Variant::Empty)).await;
    assert_eq!(status, StatusCode::BadInvalidArgument);
    assert_eq!(arguments, [StatusCode::Good, StatusCode::Good, StatusCode::BadInvalidArgument]);
    let (_, arguments) =
        decide(&engineer, own(), vec!["nothing".into(), 7_i32.into(), "x".into()]).await;
    assert_eq!(arguments, [StatusCode::BadNotFound, StatusCode::BadOutOfRange, StatusCode::Good]);

    assert_eq!(decide(&engineer, own(), refuse("too revealing".into())).await.0, StatusCode::Good);
    let id = field_id("net", "percent");
    assert_eq!(engineer.read(&format!("{id}#MappingState")).await.value, Some(Variant::Int32(2)));
    assert_eq!(engineer.read(&format!("{id}#DecidedBy")).await.value, Some("anna".into()));
    // Called as the type's method; now clients may write.
    let of_type = NodeId::new(TYPES, 101_015_u32);
    let accepted =
        decide(&engineer, of_type, vec!["percent".into(), 1_i32.into(), Variant::Empty]).await;
    assert_eq!(accepted.0, StatusCode::Good);
    assert_eq!(operator.write(&id, 50.0).await, StatusCode::Good);
    let states: Vec<_> =
        twin.connector.decisions.lock().iter().map(|d| d.1.mapping_state).collect();
    assert_eq!(states, [MappingState::Refused, MappingState::Mapped]);
    engineer.close().await;
    operator.close().await;
    twin.stop().await;
}
