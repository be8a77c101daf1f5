use serde_json::json;

use super::*;

fn id<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> T {
    text.parse().expect("valid")
}

/// A chain of A, B and C; D inspects what A made, and E receives what B is asked.
fn network() -> OperationNetwork {
    let operation = |id: &str, kind: &str, requests: serde_json::Value| {
        json!({ "operationId": id, "operationType": kind, "owningFactoryId": format!("F-{id}"),
            "plannedStart": "2026-01-05T06:00:00Z", "plannedQuantity": 3,
            "dynamicDataRequestList": requests })
    };
    let request = |id: &str, requester: &str, recipients: &[&str]| {
        json!({ "dynamicDataRequestId": id, "requesterId": requester, "recipientList": recipients,
            "purpose": "p", "reportDataFormat": { "reportName": "r", "reportFieldList": [
                { "name": "f", "type": 9 } ] } })
    };
    let relation = |id: &str, from: &str, to: &str| {
        json!({ "operationRelationId": id, "relationType": "FINISH_TO_START",
            "predecessorOperationId": from, "successorOperationId": to })
    };
    let mut inspect = operation("d", "INSPECTION", json!([request("of-c", "org-c", &["org-c"])]));
    inspect["inspectedOperationId"] = json!("a");
    serde_json::from_value(json!({
        "operationNetworkId": "n",
        "operationList": [operation("a", "PRODUCTION", json!([])),
            operation("b", "PRODUCTION", json!([request("of-e", "org-a", &["org-e"])])),
            operation("c", "PRODUCTION", json!([])), inspect],
        "operationRelationList": [relation("ab", "a", "b"), relation("bc", "b", "c")]
    }))
    .expect("a network")
}

fn owners() -> NetworkOwners {
    NetworkOwners {
        drawn_by: Some(id("drawer")),
        factories: ["a", "b", "c", "d"]
            .map(|name| (id(&format!("F-{name}")), id(&format!("org-{name}"))))
            .into(),
        drawers: [(id("c"), id("org-x"))].into(),
        // The requester of the first request, and nobody of the second.
        consents: [(id("of-e"), id("org-a"))].into(),
    }
}

/// Summary of what is seen of the network: operations in full, as stubs (*), with their requests; relations.
fn seen(scope: &Scope) -> String {
    let (network, owners) = (network(), owners());
    let shown = Visibility::new(&network, &owners, scope).project();
    let operations = shown.operation_list.iter().map(|operation| {
        let requests = operation.dynamic_data_request_list.iter();
        let requests: String =
            requests.map(|r| format!("?{}", r.dynamic_data_request_id)).collect();
        let sign = if operation.stub { "*" } else { "" };
        format!("{}{sign}{requests}", operation.operation_id)
    });
    let relations =
        shown.operation_relation_list.iter().map(|r| r.operation_relation_id.to_string());
    operations.chain(relations).collect::<Vec<_>>().join(" ")
}

#[test]
fn each_viewer_sees_what_concerns_it() {
    for (viewer, expected) in [
        ("drawer", "a b c d ab bc"),
        ("org-a", "a b?of-e ab"),
        ("org-b", "a* b?of-e c* ab bc"),
        ("org-c", "b* c d?of-c bc"),
        ("org-d", "a* d?of-c"),
        ("org-e", "b?of-e"),
        ("org-x", "c"),
        ("org-y", ""),
    ] {
        assert_eq!(seen(&Scope::Organisation(id(viewer))), expected, "{viewer}");
    }
    let all = "a b?of-e c d?of-c ab bc";
    assert_eq!(seen(&Scope::Administration { looking_for: Some(id("org-y")) }), all);
    assert_eq!(seen(&Scope::Platform), all);
    assert_eq!(seen(&Scope::Nothing), "");
}

#[test]
fn asking_shows_the_inside_only_where_the_factory_opened_something() {
    let (network, mut owners) = (network(), owners());
    for (viewer, request, operation) in [("org-e", "of-e", 1), ("org-c", "of-c", 3)] {
        let viewer = id(viewer);
        let shown = |owners: &NetworkOwners| {
            let shown = Visibility::of(&network, owners, &viewer).project();
            let wanted = &network.operation_list[operation].operation_id;
            shown.operation_list.into_iter().find(|o| o.operation_id == *wanted).expect("seen")
        };
        let asked = shown(&owners);
        assert_eq!((asked.stub, asked.planned_quantity), (false, None), "{viewer}");
        assert!(asked.planned_start.is_some(), "{viewer}");
        assert_eq!(asked.dynamic_data_request_list.len(), 1, "{viewer}");
        owners.consents.insert((id(request), viewer.clone()));
        let opened = shown(&owners);
        assert_eq!(opened.planned_quantity, Some(3.0), "{viewer}");
    }
}

#[test]
fn a_stub_has_plan_times_and_a_hidden_inspected_operation_is_not_named() {
    let (network, owners) = (network(), owners());
    let viewer = id("org-d");
    let shown = Visibility::of(&network, &owners, &viewer).project();
    let stub = &shown.operation_list[0];
    assert!(stub.planned_start.is_some() && stub.planned_quantity.is_none());
    assert_eq!(shown.operation_list[1].kind, network.operation_list[3].kind);
    let viewer = id("org-c");
    let shown = Visibility::of(&network, &owners, &viewer).project();
    let kind = OperationKind::Inspection { inspected_operation_id: None, characteristic: None };
    assert_eq!(shown.operation_list[2].kind, kind);
    assert_eq!(asi_model::validation::validate_network(&shown), []);
}

#[test]
fn viewers_are_all_but_the_drawer() {
    let listed: Vec<String> = viewers(&network(), &owners())
        .into_iter()
        .map(|(organisation, factory)| format!("{organisation} {factory}"))
        .collect();
    assert_eq!(
        listed,
        [
            "org-a F-a",
            "org-a F-b",
            "org-b F-a",
            "org-b F-b",
            "org-b F-c",
            "org-c F-b",
            "org-c F-c",
            "org-c F-d",
            "org-d F-a",
            "org-d F-d",
            "org-e F-b",
            "org-x F-c"
        ]
    );
}
