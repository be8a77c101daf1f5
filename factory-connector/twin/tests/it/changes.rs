//! Notifications of subscribers: values, removals, model changes, the audit trail.

use opcua_stack::opcua::{
    client::EventCallback,
    types::{
        AttributeId, ContentFilter, EventFilter, ExtensionObject, ModelChangeStructureDataType,
        MonitoredItemCreateRequest, MonitoringMode, MonitoringParameters, NodeId, ObjectId,
        ObjectTypeId, ReadValueId, SimpleAttributeOperand, StatusCode, TimestampsToReturn, Variant,
    },
};
use tokio::sync::mpsc;
use twin::FieldRecord;

use crate::harness::{
    Client, TestTwin, document, external, field, field_id, good, instance, message, next,
};

#[tokio::test]
async fn values_are_pushed_in_order_and_none_is_lost() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let client = twin.client("vera").await;
    let mut changes = client.subscribe(&[instance(&field_id("net", "progressStatus"))]).await;
    assert_eq!(next(&mut changes).await.1.status(), StatusCode::BadWaitingForInitialData);
    for value in 1..=500_u64 {
        twin.handle.publish_values(vec![(field("net", "progressStatus"), good(value))]);
        if value % 50 == 0 {
            // The queue holds 100 values.
            for expected in value - 49..=value {
                assert_eq!(next(&mut changes).await.1.value, Some(expected.into()));
            }
        }
    }
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn a_revision_changes_only_nodes_that_differ() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let nodes = [
        "net#Revision",
        "net/op/MakeFrame1#PlannedQuantity",
        "net/op/MakeFrame1#OperationId",
        "net/op/MakeFrame1/req/ReqResponse1/percent#IsMapped",
        "net/op/MakeFrame1/req/ReqResponse1/temperatures#Semantic",
        "net/op/MakeFrame1/req/ReqResponse1#ReportDataFormat#NodeVersion",
        "net/op/MakeFrame1#NodeVersion",
        "net/op/MakeFrame1/req/ReqResponse1/progressStatus",
    ];
    let mut revised = message("net", 1);
    let fields = |m: &mut asi_model::messages::OperationNetworkMessage| {
        std::mem::take(
            &mut m.operation_network.operation_list[0].dynamic_data_request_list[0]
                .report_data_format
                .report_field_list,
        )
    };
    // The first state has a semantic on `temperatures`, so that the second can take it away.
    let mut list = fields(&mut revised);
    list[2].semantic = Some("urn:example:temperature".parse().unwrap());
    revised.operation_network.operation_list[0].dynamic_data_request_list[0]
        .report_data_format
        .report_field_list = list;
    let mut document_with_value = document(revised);
    let record = FieldRecord { value: Some(good(7)), ..external() };
    document_with_value.fields.insert(field("net", "progressStatus"), record);
    twin.handle.apply(document_with_value);
    let ids: Vec<NodeId> = nodes.iter().map(|n| instance(n)).collect();
    let mut changes = client.subscribe(&ids).await;
    for _ in &nodes {
        next(&mut changes).await;
    }

    let mut second = message("net", 2);
    second.operation_network.operation_list[0].planned_quantity = Some(20.0);
    let mut list = fields(&mut second);
    let mut removed = list.remove(0);
    removed.name = "another".parse().unwrap();
    list.push(removed);
    second.operation_network.operation_list[0].dynamic_data_request_list[0]
        .report_data_format
        .report_field_list = list;
    let applied = twin.handle.apply(document(second));
    assert_eq!((applied.nodes_added, applied.nodes_removed), (1, 1));

    let mut heard = std::collections::BTreeMap::new();
    while heard.len() < 5 {
        let (handle, value) = next(&mut changes).await;
        heard.insert(handle, value);
    }
    assert_eq!(heard[&0].value, Some(2_u64.into()));
    assert_eq!(heard[&1].value, Some(20.0.into()));
    assert_eq!(heard[&4].status(), StatusCode::BadNodeIdUnknown, "a property that is gone");
    assert_eq!(heard[&5].value, Some("2".into()), "the version of the container that changed");
    assert_eq!(heard[&7].status(), StatusCode::BadNodeIdUnknown, "a field that is gone");
    // Untouched ones stay silent: the next change is the first that they hear of.
    twin.handle.publish_decision(&field("net", "percent"), external());
    let (handle, value) = next(&mut changes).await;
    assert_eq!((handle, value.value), (3, Some(true.into())));
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn a_changed_status_alone_is_notified() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let id = field_id("net", "progressStatus");
    let mut changes = client.subscribe(&[instance(&id)]).await;
    assert_eq!(next(&mut changes).await.1.status(), StatusCode::BadWaitingForInitialData);
    let refused = FieldRecord {
        mapping_state: asi_model::messages::MappingState::Refused,
        ..FieldRecord::default()
    };
    twin.handle.publish_decision(&field("net", "progressStatus"), refused);
    assert_eq!(next(&mut changes).await.1.status(), StatusCode::BadNotSupported);
    twin.handle.remove(&"net".parse().unwrap());
    assert_eq!(next(&mut changes).await.1.status(), StatusCode::BadNodeIdUnknown);
    client.close().await;
    twin.stop().await;
}

/// Subscribes to the fields of an event type at the Server object.
pub async fn events(
    client: &Client,
    of: ObjectTypeId,
    fields: &[&str],
) -> mpsc::UnboundedReceiver<Vec<Variant>> {
    let (sender, receiver) = mpsc::unbounded_channel();
    let callback = EventCallback::new(move |fields, _| {
        let _ = sender.send(fields.unwrap_or_default());
    });
    let interval = std::time::Duration::from_millis(10);
    let subscription = client
        .session
        .create_subscription(interval, 1000, 100, 0, 0, true, callback)
        .await
        .unwrap();
    let operand = |name: &&str| SimpleAttributeOperand {
        type_definition_id: ObjectTypeId::BaseEventType.into(),
        browse_path: Some(vec![(*name).into()]),
        attribute_id: AttributeId::Value as u32,
        index_range: opcua_stack::opcua::types::NumericRange::None,
    };
    let filter = EventFilter {
        select_clauses: Some(fields.iter().map(operand).collect()),
        where_clause: of_type(of),
    };
    let request = MonitoredItemCreateRequest {
        item_to_monitor: ReadValueId {
            node_id: ObjectId::Server.into(),
            attribute_id: AttributeId::EventNotifier as u32,
            ..ReadValueId::default()
        },
        monitoring_mode: MonitoringMode::Reporting,
        requested_parameters: MonitoringParameters {
            client_handle: 1,
            queue_size: 100,
            discard_oldest: true,
            filter: ExtensionObject::from_message(filter),
            ..MonitoringParameters::default()
        },
    };
    let created = client
        .session
        .create_monitored_items(subscription, TimestampsToReturn::Both, vec![request])
        .await
        .unwrap();
    assert!(created[0].result.status_code.is_good(), "{}", created[0].result.status_code);
    receiver
}

fn of_type(event_type: ObjectTypeId) -> ContentFilter {
    use opcua_stack::opcua::types::{ContentFilterElement, FilterOperator, LiteralOperand};
    ContentFilter {
        elements: Some(vec![ContentFilterElement {
            filter_operator: FilterOperator::OfType,
            filter_operands: Some(vec![ExtensionObject::from_message(LiteralOperand {
                value: NodeId::from(event_type).into(),
            })]),
        }]),
    }
}

fn changed_nodes(changes: &Variant) -> Vec<(String, u8)> {
    let Variant::Array(array) = changes else { panic!("Changes is an array, but is {changes:?}") };
    let one = |value: &Variant| match value {
        Variant::ExtensionObject(object) => {
            let change = object.inner_as::<ModelChangeStructureDataType>().unwrap();
            (change.affected.identifier.to_string(), change.verb)
        }
        other => panic!("a structure, but is {other:?}"),
    };
    array.values.iter().map(one).collect()
}

#[tokio::test]
async fn model_changes_are_events() {
    let twin = TestTwin::start().await;
    let client = twin.client("vera").await;
    let of = ObjectTypeId::GeneralModelChangeEventType;
    let mut heard = events(&client, of, &["Changes", "SourceName"]).await;

    twin.handle.apply(document(message("net", 1)));
    let added = changed_nodes(&next(&mut heard).await[0]);
    assert_eq!(added[0], ("s=#CollaborativeProcessTwin".to_owned(), 4));
    assert!(added.contains(&("s=net/op/MakeFrame1/req/ReqResponse1/percent".to_owned(), 1)));

    let mut second = message("net", 2);
    second.operation_network.operation_relation_list.clear();
    second.operation_network.operation_list.truncate(1);
    twin.handle.apply(document(second));
    let changed = changed_nodes(&next(&mut heard).await[0]);
    let expected = [
        ("s=net#OperationNetwork", 8),
        ("s=net/op/InspectFrame1", 2),
        ("s=net/op/MakeFrame1", 8),
        ("s=net/rel/rel1", 2),
        ("s=net/rel/rel1/cond/c1", 2),
    ];
    assert_eq!(changed, expected.map(|(id, verbs)| (id.to_owned(), verbs)));

    twin.handle.remove(&"net".parse().unwrap());
    let removed = changed_nodes(&next(&mut heard).await[0]);
    assert_eq!(removed[0], ("s=#CollaborativeProcessTwin".to_owned(), 8));
    assert!(removed.contains(&("s=net".to_owned(), 2)));
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn the_audit_trail_tells_user_and_change_and_no_value_that_the_gate_coarsened() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("anna").await;
    let fields = ["EventType", "SourceNode", "ClientUserId", "Status", "OldValue", "NewValue"];
    let mut heard = events(&client, ObjectTypeId::AuditEventType, &fields).await;

    let id = field_id("net", "progressStatus");
    client.write(&id, 5_u64).await;
    let refused = next(&mut heard).await;
    assert_eq!(refused[5], Variant::Empty, "a refused value was never disclosed");
    assert_eq!(refused[0], NodeId::from(ObjectTypeId::AuditWriteUpdateEventType).into());
    assert_eq!(refused[1], instance(&id).into());
    assert_eq!((&refused[2], &refused[3]), (&"anna".into(), &false.into()));

    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let decided = next(&mut heard).await;
    assert_eq!(decided[1], instance(&format!("{id}#MappingState")).into());
    assert_eq!((&decided[4], &decided[5]), (&Variant::Int32(0), &Variant::Int32(1)));

    client.write(&id, 6_u64).await;
    let accepted = next(&mut heard).await;
    assert_eq!((&accepted[3], &accepted[5]), (&true.into(), &6_u64.into()));

    // The engine's own updates are no audit events: the next is the sign-in.
    twin.handle.publish_values(vec![(field("net", "progressStatus"), good(7))]);
    assert!(
        twin.connect("otto", "wrong", opcua_stack::opcua::crypto::SecurityPolicy::Basic256Sha256)
            .await
            .is_err()
    );
    let sign_in = loop {
        // Before it come the channel and the session.
        let event = next(&mut heard).await;
        assert_ne!(event[0], NodeId::from(ObjectTypeId::AuditWriteUpdateEventType).into());
        if event[0] == NodeId::from(ObjectTypeId::AuditActivateSessionEventType).into() {
            break event;
        }
    };
    assert_eq!((&sign_in[2], &sign_in[3]), (&"otto".into(), &false.into()));

    twin.handle.remove(&"net".parse().unwrap());
    let deleted = next(&mut heard).await;
    assert_eq!(deleted[0], NodeId::from(ObjectTypeId::AuditDeleteNodesEventType).into());
    client.close().await;
    twin.stop().await;
}
