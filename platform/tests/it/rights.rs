//! Rights over a network by owner: what a planner of one member may do to the things of another.

use serde_json::{Value, json};

use crate::{
    chain::{self, CARRIER, CARRIER_FACTORY, body, faults, operation, requests_path, seen},
    harness::{Answer, Api, World},
    story::{self, network_path, planner},
};

/// Puts what a change makes of the member's own view.
async fn put(api: &Api, change: impl FnOnce(&mut Value)) -> Answer {
    let mut network = seen(api).await;
    change(&mut network);
    api.put(&network_path(), body(network)).await
}

fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
    expected.iter().map(|(code, at)| ((*code).to_owned(), (*at).to_owned())).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_planner_takes_over_no_request_of_another_member() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let before = seen(&admin).await;
    let maker = planner(&world, "frames-munich").await;
    let answer = put(&maker, |network| {
        let request = &mut operation(network, "MakeFrame1")["dynamicDataRequestList"][0];
        request["requesterId"] = json!("frames-munich");
        request["recipientList"] = json!(["frames-munich"]);
    })
    .await;
    let at = "/operationList/0/dynamicDataRequestList/0";
    assert_eq!(
        faults(answer),
        pairs(&[
            ("ID_TAKEN", &format!("{at}/dynamicDataRequestId")),
            ("FOREIGN_REQUEST", &format!("{at}/recipientList")),
            ("FOREIGN_REQUEST", &format!("{at}/requesterId")),
        ])
    );
    // Nor by the whole document, as a member writes it who sees less.
    let carrier = planner(&world, CARRIER).await;
    let mut network = chain::network();
    operation(&mut network, "MakeFrame1")["dynamicDataRequestList"][0]["requesterId"] =
        json!(CARRIER);
    operation(&mut network, "MakeFrame1")["dynamicDataRequestList"][0]["recipientList"] =
        json!([CARRIER]);
    let refused = faults(carrier.put(&network_path(), body(network)).await);
    assert!(refused.contains(&("ID_TAKEN".into(), "/operationList/0/operationId".into())));
    assert_eq!(seen(&admin).await, before);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_member_withdraws_no_network_that_another_drew() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let maker = planner(&world, "frames-munich").await;
    maker.delete(&network_path()).await.expect_problem(403, "FORBIDDEN");
    assert!(admin.get(&network_path()).await.expect_ok()["withdrawnAt"].is_null());
    let buyer = planner(&world, "acme-aero").await;
    buyer.delete(&network_path()).await.expect_ok();
    // Nor does it draw it again afterwards.
    let answer = maker.put(&network_path(), body(chain::network())).await;
    answer.expect_problem(403, "FORBIDDEN");
    story::put_network(&buyer, chain::network()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_revision_neither_leaves_out_nor_changes_what_is_of_others() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let before = seen(&admin).await;
    let inspector = planner(&world, "inspect-hamburg").await;
    // Hamburg sees its neighbours' operations as stubs, and in full the one it asks about.
    for (change, expected) in [
        (
            Box::new(|network: &mut Value| network["name"] = json!("Mine"))
                as Box<dyn Fn(&mut Value)>,
            [("FOREIGN_NETWORK", "/name")],
        ),
        (
            Box::new(|network| {
                operation(network, "MakeFrame1")["plannedEnd"] = json!("2026-01-09T15:00:00Z")
            }),
            [("FOREIGN_OPERATION", "/operationList/0/plannedEnd")],
        ),
        (
            Box::new(|network| {
                operation(network, "MakeFrame1")["owningFactoryId"] = json!("INS_HAM")
            }),
            [("FOREIGN_OPERATION", "/operationList/0/owningFactoryId")],
        ),
        (
            Box::new(|network| operation(network, "ShipFrame1")["name"] = json!("Ship it")),
            [("FOREIGN_OPERATION", "/operationList/2/name")],
        ),
        (
            Box::new(|network| {
                network["operationList"].as_array_mut().expect("a list").remove(0);
                network["operationRelationList"].as_array_mut().expect("a list").remove(0);
            }),
            [("FOREIGN_OPERATION", "/operationList")],
        ),
        (
            Box::new(|network| {
                network["operationRelationList"][0]["relationType"] = json!("START_TO_START")
            }),
            [("FOREIGN_RELATION", "/operationRelationList/0/relationType")],
        ),
        (
            Box::new(|network| {
                let stolen =
                    network["operationRelationList"].as_array_mut().expect("a list").remove(0);
                assert_eq!(stolen["operationRelationId"], "rel1");
            }),
            [("FOREIGN_RELATION", "/operationRelationList")],
        ),
    ] {
        let found = faults(put(&inspector, change).await);
        for fault in pairs(&expected) {
            assert!(found.contains(&fault), "{fault:?} is not among {found:?}");
        }
    }
    assert_eq!(seen(&admin).await, before);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_operation_with_requests_of_others_neither_vanishes_nor_changes_its_factory() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let second = json!({ "factoryId": "FRE_KIEL", "organisationId": CARRIER, "name": "Kiel" });
    admin.post("/factories", second).await.expect_ok();
    admin.put("/collaborations/order/factories/FRE_KIEL", json!({})).await.expect_ok();
    let carrier = planner(&world, CARRIER).await;
    let answer = put(&carrier, |network| {
        operation(network, "ShipFrame1")["owningFactoryId"] = json!("FRE_KIEL");
    })
    .await;
    let moved = pairs(&[("FOREIGN_REQUEST", "/operationList/1/owningFactoryId")]);
    assert_eq!(faults(answer), moved);
    let answer = put(&carrier, |network| {
        network["operationList"].as_array_mut().expect("a list").pop();
        network["operationRelationList"] = json!([]);
    })
    .await;
    let found = faults(answer);
    assert!(found.contains(&("FOREIGN_REQUEST".into(), "/operationList".into())), "{found:?}");
    // Without the request, it may move to another factory of its own, and to nobody else's.
    let buyer = planner(&world, "acme-aero").await;
    buyer.delete(&format!("{}/ShipRequest", requests_path("ShipFrame1"))).await.expect_ok();
    let answer = put(&carrier, |network| {
        operation(network, "ShipFrame1")["owningFactoryId"] = json!("INS_HAM");
    })
    .await;
    let moved = pairs(&[("FOREIGN_FACTORY", "/operationList/1/owningFactoryId")]);
    assert_eq!(faults(answer), moved);
    let answer = put(&carrier, |network| {
        operation(network, "ShipFrame1")["owningFactoryId"] = json!("FRE_KIEL");
    })
    .await;
    answer.expect_ok();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_request_id_is_never_used_by_another_member_again() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let buyer = planner(&world, "acme-aero").await;
    let path = requests_path("MakeFrame1");
    buyer.delete(&format!("{path}/ReqResponse1")).await.expect_ok();
    let inspector = planner(&world, "inspect-hamburg").await;
    let sneaky = story::request("ReqResponse1", "inspect-hamburg");
    let found = faults(inspector.post(&path, sneaky.clone()).await);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, "ID_TAKEN");
    // Not even after a withdrawal, nor by an administrator in its name.
    let mut network = seen(&admin).await;
    operation(&mut network, "MakeFrame1")["dynamicDataRequestList"] = json!([sneaky]);
    let found = faults(admin.put(&network_path(), body(network.clone())).await);
    assert!(found.iter().any(|(code, _)| code == "ID_TAKEN"), "{found:?}");
    buyer.delete(&network_path()).await.expect_ok();
    let found = faults(admin.put(&network_path(), body(network)).await);
    assert!(found.iter().any(|(code, _)| code == "ID_TAKEN"), "{found:?}");
    // The former requester may use it again.
    story::put_network(&buyer, chain::network()).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_network_of_another_collaboration_is_taken_and_no_more_is_said() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let before = seen(&admin).await;
    let ships = json!({ "collaborationId": "ships", "name": "Ships", "members": ["stranger"] });
    admin.post("/collaborations", ships).await.expect_ok();
    let stranger = planner(&world, "stranger").await;
    let body = json!({ "collaborationId": "ships", "operationNetwork": chain::network() });
    let answer = stranger.put(&network_path(), body).await;
    let problem = answer.expect_problem(409, "ALREADY_EXISTS");
    assert_eq!(problem["detail"], "There is a network with this id already.");
    assert_eq!(seen(&admin).await, before);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_id_of_an_organisation_is_for_it_alone_and_nobody_learns_whether_it_is_in_use() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let ships = json!({ "collaborationId": "ships", "name": "Ships", "members": ["stranger"] });
    admin.post("/collaborations", ships).await.expect_ok();
    let (buyer, stranger) = (planner(&world, "acme-aero").await, planner(&world, "stranger").await);
    let put = async |api: &Api, collaboration: &str, id: &str| {
        let mut network = chain::network();
        network["operationNetworkId"] = json!(id);
        for operation in network["operationList"].as_array_mut().expect("a list") {
            operation["dynamicDataRequestList"] = json!([]);
        }
        let body = json!({ "collaborationId": collaboration, "operationNetwork": network });
        api.put(&format!("/operation-networks/{}", id.replace('@', "%40")), body).await
    };
    put(&buyer, "order", "1@acme-aero").await.expect_ok();
    let used = put(&stranger, "ships", "1@acme-aero").await.expect_problem(409, "ID_RESERVED");
    let free = put(&stranger, "ships", "2@acme-aero").await.expect_problem(409, "ID_RESERVED");
    let nobody = put(&stranger, "ships", "2@nobody-at-all").await;
    let nobody = nobody.expect_problem(409, "ID_RESERVED");
    assert_eq!((&used["detail"], &used["detail"]), (&free["detail"], &nobody["detail"]));
    put(&buyer, "order", "2@acme-aero").await.expect_ok();
    put(&buyer, "order", "1@acme-aero").await.expect_ok();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_id_that_collides_with_something_hidden_is_refused_plainly() {
    let world = World::start().await;
    chain::drawn(&world).await;
    let carrier = planner(&world, CARRIER).await;
    let new = |id: &str, requests: Value| {
        json!({ "operationId": id, "operationType": "PRODUCTION", "owningFactoryId": CARRIER_FACTORY,
            "dynamicDataRequestList": requests })
    };
    for (added, at) in [
        (new("MakeFrame1", json!([])), "/operationList/2/operationId"),
        (
            new("Pack", json!([story::request("ReqResponse1", CARRIER)])),
            "/operationList/2/dynamicDataRequestList/0/dynamicDataRequestId",
        ),
    ] {
        let answer = put(&carrier, |network| {
            network["operationList"].as_array_mut().expect("a list").push(added);
        })
        .await;
        assert_eq!(faults(answer), pairs(&[("ID_TAKEN", at)]));
    }
    // A network that one does not see is there for nobody to draw over.
    let stranger = planner(&world, "stranger").await;
    let admin = world.admin().await;
    admin.put("/collaborations/order/members/stranger", json!({})).await.expect_ok();
    stranger.get(&network_path()).await.expect_problem(404, "NOT_FOUND");
    let answer = stranger.put(&network_path(), body(chain::network())).await;
    answer.expect_problem(409, "ALREADY_EXISTS");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_member_adds_what_is_its_own_and_proposes_what_others_shall_do() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let carrier = planner(&world, CARRIER).await;
    let answer = put(&carrier, |network| {
        operation(network, "ShipFrame1")["plannedStart"] = json!("2026-01-12T06:00:00Z");
        operation(network, "ShipFrame1")["name"] = json!("Ship by barge");
        let list = network["operationList"].as_array_mut().expect("a list");
        for (id, factory) in [("Load", CARRIER_FACTORY), ("Pack", "FOR_MUC")] {
            list.push(json!({ "operationId": id, "operationType": "PRODUCTION", "owningFactoryId": factory }));
        }
    })
    .await
    .expect_ok();
    // It is not told which factories beyond its sight were sent something.
    assert_eq!(answer["sentTo"], json!(["FOR_MUC", CARRIER_FACTORY, "INS_HAM"]));
    let mut whole = seen(&admin).await;
    let order = ["MakeFrame1", "InspectFrame1", "ShipFrame1", "Load", "Pack"];
    assert_eq!(chain::ids(&whole["operationList"], "operationId"), order);
    assert_eq!(operation(&mut whole, "ShipFrame1")["name"], "Ship by barge");
    let requests = &operation(&mut whole, "MakeFrame1")["dynamicDataRequestList"];
    assert_eq!(chain::ids(requests, "dynamicDataRequestId"), ["ReqResponse1", "AskedByHamburg"]);

    // The drawer proposes a plan, and does not see what others ask of each other.
    let buyer = planner(&world, "acme-aero").await;
    let mut view = seen(&buyer).await;
    let requests = &operation(&mut view, "MakeFrame1")["dynamicDataRequestList"];
    assert_eq!(chain::ids(requests, "dynamicDataRequestId"), ["ReqResponse1"]);
    let planned = put(&buyer, |network| {
        operation(network, "MakeFrame1")["plannedEnd"] = json!("2026-01-08T14:00:00Z");
        operation(network, "MakeFrame1")["plannedQuantity"] = json!(11);
    })
    .await;
    planned.expect_ok();
    let mut whole = seen(&admin).await;
    assert_eq!(operation(&mut whole, "MakeFrame1")["plannedQuantity"], 11.0);
    let requests = &operation(&mut whole, "MakeFrame1")["dynamicDataRequestList"];
    assert_eq!(chain::ids(requests, "dynamicDataRequestId"), ["ReqResponse1", "AskedByHamburg"]);
    let answer = put(&buyer, |network| {
        operation(network, "MakeFrame1")["name"] = json!("Build");
    })
    .await;
    assert_eq!(faults(answer), pairs(&[("FOREIGN_OPERATION", "/operationList/0/name")]));
    // Its own view, put again, changes nothing.
    let again = put(&carrier, |_| {}).await.expect_ok();
    assert_eq!(again["isChanged"], false);
}
