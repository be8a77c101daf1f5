//! Browse, Read and TranslateBrowsePaths.

use asi_model::messages::MappingState;
use opcua_stack::opcua::types::{
    AttributeId, BrowseDirection, BrowsePath, NodeClass, NodeId, ObjectId, QualifiedName,
    ReferenceTypeId, RelativePath, RelativePathElement, StatusCode, UAString, VariableTypeId,
    Variant,
};
use twin::FieldRecord;

use crate::harness::{
    INSTANCES, TYPES, TestTwin, document, external, field, field_id, instance, message,
};

#[tokio::test]
async fn an_interface_is_browsed_from_the_objects_folder_to_the_field() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("frame-4711", 3)));
    let client = twin.client("vera").await;

    assert!(
        client
            .children(ObjectId::ObjectsFolder)
            .await
            .contains(&"CollaborativeProcessTwin".to_owned())
    );
    let folder = client.children(instance("#CollaborativeProcessTwin")).await;
    assert_eq!(folder, ["NodeVersion", "frame-4711", "FolderType"]);
    let interface = client.children(instance("frame-4711")).await;
    assert_eq!(
        interface,
        [
            "ActivityStatusInterfaceType",
            "CollaborationId",
            "Revision",
            "ReceivedTime",
            "NodeVersion",
            "ExportNodeSet",
            "OperationNetwork"
        ]
    );
    let network = client.children(instance("frame-4711#OperationNetwork")).await;
    assert_eq!(
        &network[1..],
        ["OperationNetworkId", "Name", "NodeVersion", "MakeFrame1", "InspectFrame1", "rel1"]
    );
    let report = client
        .children(instance("frame-4711/op/MakeFrame1/req/ReqResponse1#ReportDataFormat"))
        .await;
    assert_eq!(
        &report[1..],
        ["ReportName", "NodeVersion", "progressStatus", "percent", "temperatures", "state"]
    );
    let properties = client.children(instance(&field_id("frame-4711", "progressStatus"))).await;
    assert_eq!(
        properties,
        [
            "EngineeringUnits",
            "EURange",
            "IsMapped",
            "MappingState",
            "ValueSource",
            "Semantic",
            "Disclosure",
            "DecisionReason",
            "DecidedBy",
            "DecisionTime",
            "AnalogUnitType"
        ]
    );
    // The stub of a neighbour has its identity and nothing else.
    let stub = client.children(instance("frame-4711/op/InspectFrame1")).await;
    assert_eq!(
        stub,
        ["InspectionOperationType", "OperationId", "Name", "OwningFactoryId", "NodeVersion"]
    );
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn every_reference_is_known_from_both_ends() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("frame-4711", 3)));
    let client = twin.client("vera").await;
    let mut open = vec![instance("#CollaborativeProcessTwin")];
    let mut seen = std::collections::HashSet::new();
    while let Some(node_id) = open.pop() {
        if !seen.insert(node_id.to_string()) {
            continue;
        }
        for forward in client.browse(node_id.clone(), BrowseDirection::Forward).await {
            let target = forward.node_id.node_id;
            assert_ne!(forward.node_class, NodeClass::Unspecified, "{target} exists");
            if target.namespace != INSTANCES {
                continue;
            }
            let back = client.browse(target.clone(), BrowseDirection::Inverse).await;
            let is_known = back.iter().any(|r| {
                r.node_id.node_id == node_id && r.reference_type_id == forward.reference_type_id
            });
            assert!(is_known, "{target} knows that {node_id} refers to it");
            open.push(target);
        }
    }
    assert!(seen.len() > 80, "{} nodes were found", seen.len());
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn relations_are_objects_and_references() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("frame-4711", 3)));
    let client = twin.client("vera").await;
    let arrows = |references: Vec<opcua_stack::opcua::types::ReferenceDescription>| {
        let finish_to_start = NodeId::new(TYPES, 2003_u32);
        let arrows: Vec<_> =
            references.into_iter().filter(|r| r.reference_type_id == finish_to_start).collect();
        arrows.into_iter().map(|r| (r.is_forward, r.node_id.node_id)).collect::<Vec<_>>()
    };
    let (make, inspect) =
        (instance("frame-4711/op/MakeFrame1"), instance("frame-4711/op/InspectFrame1"));
    assert_eq!(
        arrows(client.browse(make.clone(), BrowseDirection::Both).await),
        [(true, inspect.clone())]
    );
    assert_eq!(arrows(client.browse(inspect, BrowseDirection::Both).await), [(false, make)]);
    let relation = client.read("frame-4711/rel/rel1#PredecessorOperationId").await.value;
    assert_eq!(relation, Some("MakeFrame1".into()));
    assert_eq!(
        client.read("frame-4711/rel/rel1#RelationType").await.value,
        Some(Variant::Int32(0))
    );
    assert_eq!(
        client.read("frame-4711/rel/rel1/cond/c1#Duration").await.value,
        Some(Variant::Double(28_800_000.0))
    );
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn the_status_shows_the_state_of_a_field() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let (own, id) = (field("net", "progressStatus"), field_id("net", "progressStatus"));
    let is_mapped = format!("{id}#IsMapped");

    assert_eq!(client.read(&id).await.status(), StatusCode::BadWaitingForInitialData);
    assert_eq!(client.read(&is_mapped).await.status(), StatusCode::UncertainInitialValue);
    let refused = FieldRecord {
        mapping_state: MappingState::Refused,
        reason: Some("not our business".into()),
        ..FieldRecord::default()
    };
    assert!(twin.handle.publish_decision(&own, refused));
    assert_eq!(client.read(&id).await.status(), StatusCode::BadNotSupported);
    let shown = client.read(&is_mapped).await;
    assert_eq!((shown.status(), shown.value), (StatusCode::Good, Some(false.into())));
    assert_eq!(
        client.read(&format!("{id}#DecisionReason")).await.value,
        Some("not our business".into())
    );

    assert!(twin.handle.publish_decision(&own, external()));
    let measured = "2019-04-18T18:20:05Z".parse().unwrap();
    let value = asi_model::DataValue::good(7_u64, measured);
    assert_eq!(twin.handle.publish_values(vec![(own, crate::harness::released(value))]), 1);
    let shown = client.read(&id).await;
    assert_eq!((shown.status(), shown.value), (StatusCode::Good, Some(7_u64.into())));
    assert_eq!(
        shown.source_timestamp.unwrap().ticks(),
        measured.ticks(),
        "the source's time is kept"
    );
    assert_eq!(client.read(&is_mapped).await.value, Some(true.into()));
    assert_eq!(client.read(&format!("{id}#ValueSource")).await.value, Some(Variant::Int32(2)));
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn attributes_are_those_of_the_class() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    twin.handle.publish_decision(&field("net", "progressStatus"), external());
    let (viewer, operator) = (twin.client("vera").await, twin.client("otto").await);
    let id = instance(&field_id("net", "progressStatus"));
    let checks = [
        (AttributeId::DataType, Variant::from(NodeId::new(0, 9_u32))),
        (AttributeId::ValueRank, Variant::Int32(-1)),
        (AttributeId::AccessLevel, Variant::Byte(3)),
        (AttributeId::UserAccessLevel, Variant::Byte(1)),
        (AttributeId::Historizing, false.into()),
        (AttributeId::BrowseName, QualifiedName::new(INSTANCES, "progressStatus").into()),
    ];
    for (attribute, expected) in checks {
        assert_eq!(viewer.attribute(&id, attribute).await.value, Some(expected), "{attribute:?}");
    }
    assert_eq!(
        operator.attribute(&id, AttributeId::UserAccessLevel).await.value,
        Some(Variant::Byte(3))
    );
    let absent = viewer.attribute(&id, AttributeId::EventNotifier).await;
    assert_eq!(absent.status(), StatusCode::BadAttributeIdInvalid);
    let array = instance(&field_id("net", "temperatures"));
    assert_eq!(
        viewer.attribute(&array, AttributeId::ArrayDimensions).await.value,
        Some(vec![0_u32].into())
    );
    for unknown in
        ["nowhere", "net/op/nothing", "net#Nothing", "net/op/MakeFrame1/req/ReqResponse1/x", "a%zz"]
    {
        let read = viewer.attribute(&instance(unknown), AttributeId::DisplayName).await;
        assert_eq!(read.status(), StatusCode::BadNodeIdUnknown, "{unknown}");
    }
    viewer.close().await;
    operator.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn types_are_browsed_under_the_standard_ones() {
    let twin = TestTwin::start().await;
    let client = twin.client("vera").await;
    let types = client.children(opcua_stack::opcua::types::ObjectTypeId::BaseObjectType).await;
    assert!(types.contains(&"OperationType".to_owned()));
    let subtypes = client.children(NodeId::new(TYPES, 1003_u32)).await;
    for name in [
        "ProductionOperationType",
        "InspectionOperationType",
        "TransportationOperationType",
        "OperationId",
    ] {
        assert!(subtypes.contains(&name.to_owned()), "{name}");
    }
    let is_abstract =
        client.attribute(&NodeId::new(TYPES, 1003_u32), AttributeId::IsAbstract).await.value;
    assert_eq!(is_abstract, Some(true.into()));
    let states =
        client.attribute(&NodeId::new(TYPES, 300_101_u32), AttributeId::Value).await.value.unwrap();
    let Variant::Array(states) = states else { panic!("EnumStrings is an array") };
    assert_eq!(states.values.len(), 3);
    let namespaces = client.session.read_namespace_array().await.unwrap();
    assert_eq!(namespaces.get_index("urn:verbund:UA:ASI"), Some(TYPES));
    assert_eq!(namespaces.get_index("urn:verbund:cpt:FOR_MUC"), Some(INSTANCES));
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn paths_lead_through_standard_nodes_to_the_twins() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("a/b#c", 1)));
    let client = twin.client("vera").await;
    let element = |name: QualifiedName| RelativePathElement {
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        is_inverse: false,
        include_subtypes: true,
        target_name: name,
    };
    let path = BrowsePath {
        starting_node: ObjectId::ObjectsFolder.into(),
        relative_path: RelativePath {
            elements: Some(vec![
                element(QualifiedName::new(INSTANCES, "CollaborativeProcessTwin")),
                element(QualifiedName::new(INSTANCES, "a/b#c")),
                element(QualifiedName::new(TYPES, "OperationNetwork")),
                element(QualifiedName::new(INSTANCES, "MakeFrame1")),
                element(QualifiedName::new(TYPES, "PlannedQuantity")),
                element(QualifiedName::new(0, "EngineeringUnits")),
            ]),
        },
    };
    let mut found = client.session.translate_browse_paths_to_node_ids(&[path]).await.unwrap();
    let targets = found.remove(0).targets.unwrap();
    let expected = instance("a%2Fb%23c/op/MakeFrame1#PlannedQuantity#EngineeringUnits");
    assert_eq!(targets.len(), 1);
    assert_eq!(targets[0].target_id.node_id, expected);
    assert!(client.attribute(&expected, AttributeId::Value).await.status().is_good());
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn many_interfaces_are_browsed_in_pages() {
    let twin = TestTwin::start().await;
    for number in 0..25 {
        twin.handle.apply(document(message(&format!("net-{number:02}"), 1)));
    }
    twin.handle.remove(&"net-07".parse().unwrap());
    let client = twin.client("vera").await;
    let wanted = opcua_stack::opcua::types::BrowseDescription {
        node_id: instance("#CollaborativeProcessTwin"),
        browse_direction: BrowseDirection::Forward,
        reference_type_id: ReferenceTypeId::Organizes.into(),
        include_subtypes: true,
        node_class_mask: 0,
        result_mask: 63,
    };
    let mut result = client.session.browse(&[wanted], 7, None).await.unwrap().remove(0);
    let mut names: Vec<UAString> = Vec::new();
    let mut pages = 1;
    loop {
        let page = result.references.take().unwrap_or_default();
        assert!(page.len() <= 7);
        names.extend(page.into_iter().map(|r| r.browse_name.name));
        if result.continuation_point.is_null_or_empty() {
            break;
        }
        pages += 1;
        result = client
            .session
            .browse_next(false, &[result.continuation_point])
            .await
            .unwrap()
            .remove(0);
    }
    let expected: Vec<UAString> =
        (0..25).filter(|n| *n != 7).map(|n| UAString::from(format!("net-{n:02}"))).collect();
    assert_eq!(names, expected);
    assert_eq!(pages, 4);
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn the_operations_state_follows_its_field() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let state = "net/op/MakeFrame1#State";
    assert_eq!(client.read(state).await.status(), StatusCode::BadWaitingForInitialData);
    twin.handle.publish_decision(&field("net", "state"), external());
    let value = asi_model::DataValue::good("RUNNING", crate::harness::now());
    twin.handle.publish_values(vec![(field("net", "state"), crate::harness::released(value))]);
    assert_eq!(client.read(state).await.value, Some(Variant::Int32(2)));
    let definition = client.browse(instance(state), BrowseDirection::Forward).await;
    assert_eq!(definition[0].node_id.node_id, VariableTypeId::BaseDataVariableType);
    client.close().await;
    twin.stop().await;
}
