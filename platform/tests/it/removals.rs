//! Removals: what is in force ends first, the rest is shown beforehand, and afterwards nobody gets in by
//! what was left.

use asi_model::FactoryId;
use messaging::LogicalAddress;
use serde_json::{Value, json};

use crate::{
    connector::Peer,
    harness::{Api, PASSWORD, World, eventually},
    story::{self, network_path},
};

async fn preview(admin: &Api, path: &str) -> Value {
    admin.delete(&format!("{path}?dryRun=true")).await.expect_ok()
}

#[tokio::test(flavor = "multi_thread")]
async fn nothing_leaves_while_something_of_it_is_in_force() {
    let world = World::start().await;
    let (admin, buyer, _munich, _hamburg) = story::accepted(&world).await;
    let member = "/collaborations/order/members/acme-aero";
    let request = "operation-networks/frame-4711/operations/MakeFrame1/requests/ReqResponse1";
    assert_eq!(
        preview(&admin, member).await["inForce"],
        json!([
            "operation-networks/frame-4711",
            request,
            format!("{request}/recipients/acme-aero")
        ])
    );
    let in_network = json!(["operation-networks/frame-4711"]);
    let factory = "/collaborations/order/factories/FOR_MUC";
    assert_eq!(preview(&admin, factory).await["inForce"], in_network);
    assert_eq!(
        preview(&admin, "/factories/FOR_MUC").await["inForce"],
        json!(["operation-networks/frame-4711", "collaborations/order/factories/FOR_MUC"])
    );
    assert_eq!(
        preview(&admin, "/organisations/frames-munich").await["inForce"],
        json!(["collaborations/order/members/frames-munich", "factories/FOR_MUC"])
    );
    let all =
        [member, factory, "/factories/FOR_MUC", "/organisations/frames-munich", "/users/admin"];
    for path in all {
        admin.delete(path).await.expect_problem(409, "IN_FORCE");
    }
    for path in ["/users/nobody", "/tools/None", "/factories/NONE", "/organisations/none"] {
        admin.delete(path).await.expect_problem(404, "NOT_FOUND");
    }
    assert_eq!(buyer.get(&network_path()).await.status, 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_last_administrator_stays_one() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let put = |role: &str| json!({ "password": PASSWORD, "role": role, "organisationId": null });
    let viewer = json!({ "password": PASSWORD, "role": "VIEWER", "organisationId": "acme-aero" });
    admin.put("/users/admin", viewer.clone()).await.expect_problem(409, "IN_FORCE");
    assert_eq!(admin.get("/users").await.status, 200, "the session of the administrator goes on");
    admin.put("/users/second", put("ADMINISTRATOR")).await.expect_ok();
    admin.put("/users/admin", viewer).await.expect_ok();
    let second = world.sign_in("second", PASSWORD).await;
    second.delete("/users/second").await.expect_problem(409, "IN_FORCE");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_has_left_gets_in_no_more_and_its_id_is_never_given_again() {
    let world = World::start().await;
    let (admin, buyer, _munich, _hamburg) = story::accepted(&world).await;
    buyer.delete(&network_path()).await.expect_ok();
    let maker = story::planner(&world, "frames-munich").await;
    let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
    let token = json!({ "token": token["token"] });
    let credential = world.anonymous().post("/enrolments", token).await.expect_ok();
    let token = admin.post("/factories/FOR_MUC/enrolment-tokens", json!({})).await.expect_ok();
    for path in ["factories/FOR_MUC", "members/frames-munich"] {
        let path = format!("/collaborations/order/{path}");
        assert_eq!(preview(&admin, &path).await["inForce"], json!([]));
        assert_eq!(admin.delete(&path).await.expect_ok()["isDone"], json!(true));
        admin.delete(&path).await.expect_problem(404, "NOT_FOUND");
    }
    maker.get(&network_path()).await.expect_problem(404, "NOT_FOUND");

    let shown = preview(&admin, "/factories/FOR_MUC").await;
    assert_eq!((&shown["credentials"], &shown["isDone"]), (&json!(2), &json!(false)));
    let remains = json!([
        "REPORTS",
        "NETWORKS",
        "COMMENTS",
        "REVOCATIONS",
        "LEDGER_LOGS",
        "ACCESSES",
        "AUDIT"
    ]);
    assert_eq!(shown["remains"], remains);
    assert_eq!(admin.delete("/factories/FOR_MUC").await.expect_ok()["remains"], remains);
    let token = json!({ "token": token["token"] });
    world.anonymous().post("/enrolments", token).await.expect_problem(403, "TOKEN_REFUSED");
    let id: FactoryId = "FOR_MUC".parse().expect("an id");
    let (reads, writes) =
        (LogicalAddress::FactoryRequests(id.clone()), LogicalAddress::FactoryIngress(id));
    let peer = Peer::start(&credential, reads, writes);
    eventually("a refusal", || async {
        let state = peer.link.state().borrow().clone();
        if state.reason.is_some() { Ok(()) } else { Err(format!("{state:?}")) }
    })
    .await;
    let factories = admin.get("/factories").await.expect_ok().to_string();
    assert!(!factories.contains("FOR_MUC"), "{factories}");
    let again = json!({ "factoryId": "FOR_MUC", "organisationId": "stranger", "name": "again" });
    admin.post("/factories", again).await.expect_problem(409, "ALREADY_EXISTS");
    let path = "/factories/FOR_MUC/enrolment-tokens";
    admin.post(path, json!({})).await.expect_problem(404, "NOT_FOUND");

    let shown = preview(&admin, "/organisations/frames-munich").await;
    let people = json!(["frames-munich-planner", "frames-munich-viewer"]);
    assert_eq!((&shown["people"], &shown["sessions"]), (&people, &json!(1)));
    assert_eq!(maker.get("/session").await.status, 200);
    admin.delete("/organisations/frames-munich").await.expect_ok();
    assert_eq!(maker.get("/session").await.status, 401);
    let again = json!({ "organisationId": "frames-munich", "name": "again" });
    admin.post("/organisations", again).await.expect_problem(409, "ALREADY_EXISTS");
}

/// Queues of the embedded broker with their waiting messages.
async fn queues(world: &World) -> Vec<(String, u64)> {
    let broker = world.handle().application.broker_access.broker().expect("a broker");
    let queues = broker.queues().await.expect("it is there");
    queues.into_iter().map(|status| (status.queue.to_string(), status.ready)).collect()
}

/// Sends values to a tool that is not there, and returns the bytes that the broker's database has then.
async fn values_wait(world: &World, credential: &Value) -> u64 {
    let mut platform = credential.clone();
    platform["userName"] = json!("platform");
    platform["password"] = json!(world.handle().application.broker_access.secret());
    let reports = LogicalAddress::ToolReports("Scheduling".parse().expect("an id"));
    let sender = Peer::start(&platform, LogicalAddress::DeadLetters, reports.clone());
    for _ in 0..16 {
        sender.send_bytes("report", None, &[7; 500_000]);
    }
    let expected = (reports.to_string(), 16);
    eventually("values wait", || async {
        let queues = queues(world).await;
        if queues.contains(&expected) { Ok(()) } else { Err(format!("{queues:?}")) }
    })
    .await;
    world.broker_bytes()
}

#[tokio::test(flavor = "multi_thread")]
async fn people_and_tools_are_listed_and_removed() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    let tool =
        json!({ "toolId": "Scheduling", "organisationId": "acme-aero", "name": "Scheduling" });
    admin.post("/tools", tool.clone()).await.expect_ok();
    let mut network = story::network();
    network["operationList"][0]["dynamicDataRequestList"] =
        json!([story::request_of_tool("ReqResponse1", "acme-aero", "Scheduling")]);
    story::put_network(&buyer, network).await;

    let credential = admin.post("/tools/Scheduling/credentials", json!({})).await.expect_ok();
    let waiting = values_wait(&world, &credential).await;

    let shown = preview(&admin, "/tools/Scheduling").await;
    let request = json!(["operation-networks/frame-4711/requests/ReqResponse1"]);
    assert_eq!((&shown["requests"], &shown["credentials"]), (&request, &json!(1)));
    admin.delete("/tools/Scheduling").await.expect_ok();
    assert!(queues(&world).await.iter().all(|(name, _)| !name.starts_with("tool.")));
    eventually("the disk is free again", || async {
        let bytes = world.broker_bytes();
        if bytes < waiting / 4 { Ok(()) } else { Err(format!("{bytes} of {waiting} bytes")) }
    })
    .await;
    assert_eq!(admin.get("/tools").await.expect_ok()["items"], json!([]));
    admin.post("/tools", tool).await.expect_problem(409, "ALREADY_EXISTS");

    let people = admin.get("/users").await.expect_ok().to_string();
    assert!(people.contains("\"acme-aero-planner\"") && !people.contains("password"), "{people}");
    buyer.get("/users").await.expect_problem(403, "FORBIDDEN");
    let shown = preview(&admin, "/users/acme-aero-planner").await;
    assert_eq!((&shown["sessions"], &shown["people"]), (&json!(1), &json!(["acme-aero-planner"])));
    admin.delete("/users/acme-aero-planner").await.expect_ok();
    assert_eq!(buyer.get("/session").await.status, 401);
    let body = json!({ "userName": "acme-aero-planner", "password": PASSWORD });
    assert_eq!(world.anonymous().post("/session", body).await.status, 401);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_collaboration_ends_once_its_networks_are_withdrawn_and_its_members_part() {
    let world = World::start().await;
    let (admin, buyer, _munich, _hamburg) = story::accepted(&world).await;
    let order = "/collaborations/order";
    let in_force = json!(["operation-networks/frame-4711"]);
    assert_eq!(preview(&admin, order).await["inForce"], in_force);
    admin.delete(order).await.expect_problem(409, "IN_FORCE");
    buyer.delete(&network_path()).await.expect_ok();
    buyer.delete(order).await.expect_problem(403, "FORBIDDEN");
    assert_eq!(admin.delete(order).await.expect_ok()["isDone"], json!(true));
    admin.delete(order).await.expect_problem(404, "NOT_FOUND");
    for api in [&admin, &buyer] {
        assert_eq!(api.get("/collaborations").await.expect_ok()["items"], json!([]));
    }
    admin
        .put("/collaborations/order/members/acme-aero", json!({}))
        .await
        .expect_problem(404, "NOT_FOUND");
    let body = json!({ "collaborationId": "order", "name": "Again" });
    admin.post("/collaborations", body).await.expect_problem(409, "ALREADY_EXISTS");
    // Nothing of it is in the way of its members any more.
    let shown = preview(&admin, "/organisations/frames-munich").await;
    assert_eq!(shown["inForce"], json!(["factories/FOR_MUC"]));
}
