//! Sight of a network: which part of it, of its requests, faults, comments and events each member
//! has.

use serde_json::{Value, json};

use crate::{
    chain::{self, CARRIER, CARRIER_FACTORY, ids, requests_path, seen},
    connector::Peer,
    harness::{Api, World, event_form, eventually},
    leases,
    story::{self, NETWORK, network_path, planner},
};

#[tokio::test(flavor = "multi_thread")]
async fn a_member_sees_its_own_operations_and_stubs_of_their_neighbours() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let all = ["MakeFrame1", "InspectFrame1", "ShipFrame1"];
    // Each operation is in full (+), a stub (-) or hidden.
    for (organisation, expected, relations) in [
        ("acme-aero", vec!["+MakeFrame1", "+InspectFrame1", "+ShipFrame1"], vec!["rel1", "rel2"]),
        ("frames-munich", vec!["+MakeFrame1", "-InspectFrame1"], vec!["rel1"]),
        (
            "inspect-hamburg",
            vec!["+MakeFrame1", "+InspectFrame1", "-ShipFrame1"],
            vec!["rel1", "rel2"],
        ),
        (CARRIER, vec!["-InspectFrame1", "+ShipFrame1"], vec!["rel2"]),
    ] {
        let api = planner(&world, organisation).await;
        let network = seen(&api).await;
        let operations = network["operationList"].as_array().expect("a list");
        let found: Vec<String> = operations
            .iter()
            .map(|operation| {
                let sign = if operation["stub"] == true { '-' } else { '+' };
                format!("{sign}{}", operation["operationId"].as_str().expect("an id"))
            })
            .collect();
        assert_eq!(found, expected, "{organisation}");
        let relation = &network["operationRelationList"];
        assert_eq!(ids(relation, "operationRelationId"), relations, "{organisation}");
    }
    assert_eq!(ids(&seen(&admin).await["operationList"], "operationId"), all);
    // A stub has plan times and nothing else of the inside.
    let carrier = planner(&world, CARRIER).await;
    assert_eq!(
        seen(&carrier).await["operationList"][0],
        json!({ "operationId": "InspectFrame1", "operationType": "INSPECTION", "name": "Inspect the frame",
            "stub": true, "owningFactoryId": "INS_HAM", "plannedStart": "2026-01-10T06:00:00Z" })
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_member_sees_no_requests_between_others() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    for (organisation, expected) in [
        ("acme-aero", vec!["ReqResponse1", "ShipRequest"]),
        ("frames-munich", vec!["ReqResponse1", "AskedByHamburg"]),
        ("inspect-hamburg", vec!["AskedByHamburg"]),
        (CARRIER, vec!["ShipRequest"]),
    ] {
        let api = planner(&world, organisation).await;
        assert_eq!(requests(&seen(&api).await), expected, "{organisation}");
    }
    let all = ["ReqResponse1", "AskedByHamburg", "ShipRequest"];
    assert_eq!(requests(&seen(&admin).await), all);
}

fn requests(network: &Value) -> Vec<String> {
    let operations = network["operationList"].as_array().expect("a list");
    operations
        .iter()
        .flat_map(|operation| ids(&operation["dynamicDataRequestList"], "dynamicDataRequestId"))
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn faults_of_a_factory_are_for_itself_and_the_drawer() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    let fault = json!({ "pointer": "/operationNetwork", "code": "SECRET_FAULT", "message": "No." });
    let inspector = planner(&world, "inspect-hamburg").await;
    let carrier = planner(&world, CARRIER).await;
    let mut live = inspector.live(None).await;
    munich.answer(&part, "REJECTED", json!([fault]));
    for (organisation, is_shown) in
        [("acme-aero", true), ("frames-munich", true), ("inspect-hamburg", false)]
    {
        let api = planner(&world, organisation).await;
        let part = eventually("the rejection", || async {
            let view = api.get(&network_path()).await.expect_ok();
            let part = part_of(&view, "FOR_MUC");
            if part["state"] == "REJECTED" { Ok(part) } else { Err(part.to_string()) }
        })
        .await;
        assert_eq!(
            part["faultList"][0]["code"] == "SECRET_FAULT",
            is_shown,
            "{organisation}: {part}"
        );
        assert_eq!(part["sentCount"].is_number(), is_shown, "{organisation}: {part}");
    }
    let view = carrier.get(&network_path()).await.expect_ok();
    assert_eq!(part_of(&view, "FOR_MUC"), Value::Null);
    // The event says what the query says.
    let (_, event) = live.next("part").await;
    assert_eq!(event["factoryId"], json!("FOR_MUC"));
    assert_eq!(event["state"], json!("REJECTED"));
    assert_eq!(event["faultList"], json!([]));
    // The list counts what the viewer may know of.
    let summary = carrier.get("/operation-networks").await.expect_ok()["items"][0].clone();
    assert_eq!((&summary["partsRejected"], &summary["partsUnanswered"]), (&json!(0), &json!(2)));
    let summary = inspector.get("/operation-networks").await.expect_ok()["items"][0].clone();
    assert_eq!((&summary["partsRejected"], &summary["partsUnanswered"]), (&json!(1), &json!(2)));
}

fn part_of(view: &Value, factory: &str) -> Value {
    let parts = view["parts"].as_array().expect("parts");
    parts.iter().find(|part| part["factoryId"] == factory).cloned().unwrap_or_default()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_comment_of_a_factory_is_shown_as_the_factory_s_and_not_as_its_author_s() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let munich = chain::munich(&world, &admin).await;
    let path = format!("{}/comments", network_path());
    let buyer = planner(&world, "acme-aero").await;
    let mine = json!({ "factoryId": "FOR_MUC", "text": "of the buyer" });
    buyer.post(&path, mine).await.expect_ok();
    munich.send(
        "comment",
        &json!({ "messageType": "comment", "messageId": "c1", "factoryId": "FOR_MUC",
            "operationNetworkId": NETWORK, "authorId": "\u{202e}acme-aero\u{200b}-planner",
            "text": "as if of the buyer" }),
    );
    let page = eventually("both", || async {
        let page = buyer.get(&path).await.expect_ok();
        if texts(&page).len() == 2 { Ok(page) } else { Err(page.to_string()) }
    })
    .await;
    let said = |index: usize| {
        let comment = &page["items"][index];
        (comment["authorId"].clone(), comment["isFromFactory"].clone())
    };
    assert_eq!(said(0), (json!("acme-aero-planner"), json!(false)));
    assert_eq!(said(1), (json!("acme-aero-planner@FOR_MUC"), json!(true)));
}

#[tokio::test(flavor = "multi_thread")]
async fn comments_are_for_those_who_talk() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let munich = chain::munich(&world, &admin).await;
    let path = format!("{}/comments", network_path());
    let buyer = planner(&world, "acme-aero").await;
    let inspector = planner(&world, "inspect-hamburg").await;
    let about = |request: &str, text: &str| json!({ "factoryId": "FOR_MUC", "dynamicDataRequestId": request, "text": text });
    let mut live = inspector.live(None).await;
    buyer.post(&path, about("ReqResponse1", "of the buyer")).await.expect_ok();
    inspector.post(&path, about("AskedByHamburg", "of Hamburg")).await.expect_ok();
    buyer.post(&path, json!({ "factoryId": "FOR_MUC", "text": "to all" })).await.expect_ok();
    munich.send(
        "comment",
        &json!({ "messageType": "comment", "messageId": "c9", "factoryId": "FOR_MUC",
            "operationNetworkId": NETWORK, "dynamicDataRequestId": "AskedByHamburg",
            "authorId": "engineer", "text": "to Hamburg" }),
    );
    let maker = planner(&world, "frames-munich").await;
    eventually("the answer", || async {
        let list = texts(&maker.get(&path).await.expect_ok());
        if list.len() == 4 { Ok(()) } else { Err(format!("{list:?}")) }
    })
    .await;
    let carrier = planner(&world, CARRIER).await;
    assert_eq!(texts(&buyer.get(&path).await.expect_ok()), ["of the buyer", "to all"]);
    assert_eq!(texts(&inspector.get(&path).await.expect_ok()), ["of Hamburg", "to Hamburg"]);
    assert!(texts(&carrier.get(&path).await.expect_ok()).is_empty());
    assert!(texts(&admin.get(&path).await.expect_ok()).is_empty(), "structure, not words");
    // Events go to those who can read the comment.
    let (_, first) = live.next("comment").await;
    let (_, second) = live.next("comment").await;
    let page = inspector.get(&path).await.expect_ok();
    let readable = [&page["items"][0]["commentId"], &page["items"][1]["commentId"]];
    assert_eq!([&first["commentId"], &second["commentId"]], readable);
    // Who may not read it, may not write it.
    let answer = inspector.post(&path, about("ReqResponse1", "listening")).await;
    answer.expect_problem(422, "UNKNOWN_REFERENCE");
    let answer = inspector.post(&path, json!({ "factoryId": "FOR_MUC", "text": "psst" })).await;
    answer.expect_problem(403, "FORBIDDEN");
    let answer = carrier.post(&path, json!({ "factoryId": "FOR_MUC", "text": "psst" })).await;
    answer.expect_problem(422, "UNKNOWN_REFERENCE");
}

fn texts(page: &Value) -> Vec<String> {
    ids(&page["items"], "text")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_member_without_a_part_knows_nothing_of_the_network() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    admin.put("/collaborations/order/members/stranger", json!({})).await.expect_ok();
    let stranger = planner(&world, "stranger").await;
    let mut live = stranger.live(None).await;
    assert_eq!(stranger.get("/operation-networks").await.expect_ok()["items"], json!([]));
    stranger.get(&network_path()).await.expect_problem(404, "NOT_FOUND");
    // From when it is asked to do something, it sees that, and hears of it.
    let body = json!({ "factoryId": "STR", "organisationId": "stranger", "name": "STR" });
    admin.post("/factories", body).await.expect_ok();
    admin.put("/collaborations/order/factories/STR", json!({})).await.expect_ok();
    let buyer = planner(&world, "acme-aero").await;
    let mut network = seen(&buyer).await;
    network["operationList"].as_array_mut().expect("a list").push(
        json!({ "operationId": "Polish", "operationType": "PRODUCTION", "owningFactoryId": "STR" }),
    );
    story::put_network(&buyer, network).await;
    let (_, event) = live.next("network").await;
    assert_eq!(event["revision"], 3);
    assert_eq!(ids(&seen(&stranger).await["operationList"], "operationId"), ["Polish"]);
}

#[tokio::test(flavor = "multi_thread")]
async fn asking_about_an_operation_shows_its_inside_only_once_the_factory_opens_a_field() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let carrier = planner(&world, CARRIER).await;
    let mut network = seen(&carrier).await;
    network["operationList"].as_array_mut().expect("a list").push(json!({
        "operationId": "Pack", "operationType": "PRODUCTION", "owningFactoryId": "FOR_MUC", "productId": "crate" }));
    story::put_network(&carrier, network).await;
    let shown = seen(&carrier).await;
    assert_eq!(shown["operationList"][2]["productId"], "crate");
    // It asks about its neighbour, of which it sees a stub.
    let mut asking = shown.clone();
    asking["operationList"][0].as_object_mut().expect("an operation").remove("stub");
    asking["operationList"][0]["dynamicDataRequestList"] =
        json!([story::request("AskedByCarrier", CARRIER)]);
    let path = requests_path("InspectFrame1");
    carrier.post(&path, story::request("AskedByCarrier", CARRIER)).await.expect_ok();
    let asked = seen(&carrier).await["operationList"][0].clone();
    let requests = ids(&asked["dynamicDataRequestList"], "dynamicDataRequestId");
    assert_eq!(requests, ["AskedByCarrier"]);
    assert_eq!(asked["plannedStart"], "2026-01-10T06:00:00Z");
    assert_eq!((&asked["plannedQuantity"], &asked["quantityUnit"]), (&Value::Null, &Value::Null));
    // That the factory takes the request opens nothing yet; a field that it opens does, as long as it
    // is open.
    let hamburg = Peer::enrolled(&world, &admin, "INS_HAM").await;
    let is_newest = |part: &Value| part.to_string().contains("AskedByCarrier");
    hamburg.accept(&hamburg.receive("operation-network", is_newest).await);
    story::part_is(&carrier, "INS_HAM", "ACCEPTED").await;
    assert_eq!(seen(&carrier).await["operationList"][0], asked);
    for (hour, state, is_shown) in
        [(18, "REFUSED", false), (19, "MAPPED", true), (20, "PENDING", false)]
    {
        let time = format!("2019-04-18T{hour}:00:00Z");
        let mut decision = story::decision_at(&time, state, None);
        decision["factoryId"] = json!("INS_HAM");
        decision["operationId"] = json!("InspectFrame1");
        decision["dynamicDataRequestId"] = json!("AskedByCarrier");
        hamburg.send("decision", &decision);
        let view = eventually(state, || async {
            let view = carrier.get(&network_path()).await.expect_ok();
            let fields = view["fields"].as_array().expect("fields").clone();
            let is_decided = fields
                .iter()
                .any(|field| field["mappingState"] == state && field["decidedAt"] == time.as_str());
            if is_decided { Ok(view) } else { Err(json!(fields).to_string()) }
        })
        .await;
        let operation = &view["network"]["operationList"][0];
        assert_eq!(operation["plannedQuantity"] == 12.0, is_shown, "{state}: {operation}");
        // The document of before changes nothing, whatever is shown by now.
        assert_eq!(story::put_network(&carrier, asking.clone()).await["isChanged"], json!(false));
        let whole = seen(&admin).await["operationList"][1].clone();
        assert_eq!(whole["plannedQuantity"], 12.0);
    }
    let path = requests_path("MakeFrame1");
    let hidden = carrier.post(&path, story::request("AskedByCarrier2", CARRIER)).await;
    hidden.expect_problem(404, "NOT_FOUND");
    let parts = carrier.get(&network_path()).await.expect_ok()["parts"].clone();
    assert_eq!(ids(&parts, "factoryId"), ["FOR_MUC", CARRIER_FACTORY, "INS_HAM"]);
}

/// Everything that a member reads of a factory and of the network. Of the id at which the live stream
/// goes on, which differs from answer to answer, its form.
async fn read_by(api: &Api) -> String {
    let mut view = api.get(&network_path()).await.expect_ok();
    view["lastEventId"] = json!(event_form(&view["lastEventId"]));
    let mut status = api.get("/status").await.expect_ok();
    status.as_object_mut().expect("an object").remove("now");
    let mut read = format!("{view}{status}");
    let [comments, receipts] =
        ["comments", "revocations"].map(|of| format!("{}/{of}", network_path()));
    let paths = ["/factories", "/operation-networks", "/factories/FOR_MUC/writers", "/reports"];
    for path in paths.into_iter().chain(["/audit-entries", &comments, &receipts]) {
        read.push_str(&api.get(path).await.expect_ok().to_string());
    }
    read
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_factory_sends_to_others_shows_nowhere() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let inspector = planner(&world, "inspect-hamburg").await;
    let maker = planner(&world, "frames-munich").await;
    let mut live = inspector.live(None).await;
    leases::with_leases(&munich);
    leases::ask(&munich, "a1", "here").await;
    // A sign of life that does not follow values, by the minute.
    let heard = loop {
        let (_, event) = live.next("factory").await;
        if event["factoryId"] == "FOR_MUC" {
            break event["lastSeenAt"].as_str().expect("a time").to_owned();
        }
    };
    assert!(heard.ends_with(":00Z"), "{heard}");
    let before = read_by(&inspector).await;
    assert_eq!(before.matches(&format!("\"lastSeenAt\":\"{heard}\"")).count(), 2, "{before}");

    for sequence in 0..3 {
        let id = format!("m{sequence}");
        munich.send("ua-data", &story::report(&id, sequence, sequence.into()));
    }
    story::value_is(&buyer, "2").await;
    let own = maker.get("/factories").await.expect_ok()["items"][0].clone();
    assert!(own["lastReportAt"].is_string() && own["lastSeenAt"] != heard, "{own}");
    assert_eq!(read_by(&inspector).await, before);
    // The next event that it hears is about something else.
    let mut network = story::network();
    network["name"] = json!("Another name");
    story::put_network(&buyer, network).await;
    assert_eq!(live.any().await.1, "network");
}

/// Revision and author of the network as a member sees them.
async fn author_shown(api: &Api) -> (Value, Value) {
    let view = api.get(&network_path()).await.expect_ok();
    (view["revision"].clone(), view["updatedBy"].clone())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_change_that_is_hidden_shows_nowhere() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let carrier = planner(&world, CARRIER).await;
    // The inspector asked the maker in revision 2: the drawer and the carrier see nothing of it.
    let inspector = planner(&world, "inspect-hamburg").await;
    for (api, revision, author) in [
        (&admin, 2, "inspect-hamburg-planner"),
        (&inspector, 2, "inspect-hamburg-planner"),
        (&planner(&world, "frames-munich").await, 2, "inspect-hamburg"),
        (&planner(&world, "acme-aero").await, 1, "acme-aero-planner"),
        (&carrier, 1, "acme-aero"),
    ] {
        assert_eq!(author_shown(api).await, (json!(revision), json!(author)));
    }
    // Parts that nobody answers are sent again and again.
    let mut peers = Vec::new();
    for factory in ["INS_HAM", CARRIER_FACTORY] {
        let peer = Peer::enrolled(&world, &admin, factory).await;
        peer.accept(&peer.receive("operation-network", |_| true).await);
        story::part_is(&carrier, factory, "ACCEPTED").await;
        peers.push(peer);
    }
    let mut live = carrier.live(None).await;
    let before = read_by(&carrier).await;
    let path = requests_path("MakeFrame1");
    inspector.post(&path, story::request("Again", "inspect-hamburg")).await.expect_ok();
    assert_eq!(author_shown(&admin).await.0, 3);
    assert_eq!(read_by(&carrier).await, before);
    // What is hidden is no conflict with what the carrier changes.
    let path = requests_path("InspectFrame1");
    carrier.post(&path, story::request("AskedByCarrier", CARRIER)).await.expect_ok();
    assert_eq!(live.next("network").await.1["revision"], 4);
    assert_eq!(author_shown(&carrier).await, (json!(4), json!(format!("{CARRIER}-planner"))));
}
