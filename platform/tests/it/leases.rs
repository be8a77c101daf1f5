//! Leases: of several connectors with one credential one sends for its factory, and a copy beside
//! it is refused by name.

use messaging::LogicalAddress;
use serde_json::{Value, json};

use crate::{
    audit_facts::newest,
    connector::Peer,
    harness::{Api, World, eventually},
    story,
};

/// The same credential, also reading what is said about the lease.
pub fn with_leases(peer: &Peer) {
    let factory: asi_model::FactoryId = "FOR_MUC".parse().expect("valid");
    let addresses =
        [LogicalAddress::FactoryRequests(factory.clone()), LogicalAddress::FactoryLeases(factory)];
    peer.link.set_consumed(addresses.to_vec());
}

/// A connector asks for the lease; the answer.
pub async fn ask(peer: &Peer, instance: &str, place: &str) -> Value {
    let id = platform::clock::new_message_id();
    let request = json!({ "messageType": "lease-request", "messageId": id, "factoryId": "FOR_MUC",
        "instanceId": instance, "place": place, "host": format!("machine of {place}"),
        "startedAt": "2019-04-18T05:58:12Z" });
    peer.send("lease-request", &request);
    peer.receive("lease", |answer| answer["correlationId"] == id.as_str()).await
}

async fn dead_letters(admin: &Api, count: usize) -> Vec<Value> {
    eventually("dead letters", || async {
        let letters = admin.get("/dead-letters").await.expect_ok()["items"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        if letters.len() == count { Ok(letters) } else { Err(format!("{letters:?}")) }
    })
    .await
}

/// The lease is shown to the factory's own organisation and to administrators, to nobody else.
async fn assert_shown_to_its_own(world: &World, admin: &Api, buyer: &Api) {
    let maker = story::planner(world, "frames-munich").await;
    for api in [admin, &maker] {
        let lease = api.get("/factories/FOR_MUC/lease").await.expect_ok();
        let (holder, contender) = (&lease["holder"], &lease["contenders"][0]);
        assert_eq!(
            (&holder["instanceId"], &contender["instanceId"]),
            (&json!("a2"), &json!("b1")),
            "{lease}"
        );
        assert_eq!(
            (&lease["leaseNumber"], &contender["isSecond"]),
            (&json!(1), &json!(true)),
            "{lease}"
        );
    }
    buyer.get("/factories/FOR_MUC/lease").await.expect_problem(404, "NOT_FOUND");
    let unrequested = admin.get("/factories/INS_HAM/lease").await.expect_ok();
    assert_eq!((&unrequested["leaseNumber"], &unrequested["holder"]), (&json!(0), &Value::Null));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_copy_is_refused_by_name_until_people_hand_the_lease_over() {
    let mut world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    with_leases(&munich);
    let first = ask(&munich, "a1", "here").await;
    assert_eq!(first["result"], json!("GRANTED"));
    assert_eq!(first["leaseNumber"], json!(1));
    assert_eq!(first["contender"], Value::Null);
    munich.send_under(1, "ua-data", &story::report("m0", 0, 3));
    story::value_is(&buyer, "3").await;

    let copy = ask(&munich, "b1", "there").await;
    assert_eq!(
        (&copy["result"], &copy["holder"]["host"]),
        (&json!("REFUSED"), &json!("machine of here"))
    );
    let again = ask(&munich, "a2", "here").await;
    assert_eq!(
        (&again["result"], &again["leaseNumber"]),
        (&json!("GRANTED"), &json!(1)),
        "as after a crash"
    );
    assert_eq!(again["contender"]["host"], "machine of there");

    // Under another lease nothing counts, and nothing is receipted or held to be a repeat later.
    munich.send_under(2, "ua-data", &story::report("m1", 1, 4));
    let letters = dead_letters(&admin, 1).await;
    assert_eq!(letters[0]["code"], "NOT_LEASED");
    assert!(
        letters[0]["reason"].as_str().is_some_and(|reason| reason.contains("machine of here")),
        "{letters:?}"
    );
    munich.send_under(1, "ua-data", &story::report("m1", 1, 4));
    story::value_is(&buyer, "4").await;

    assert_shown_to_its_own(&world, &admin, &buyer).await;

    // All that survives a restart of the platform.
    drop(munich);
    world.restart().await;
    let (admin, buyer) = (world.admin().await, story::planner(&world, "acme-aero").await);
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    with_leases(&munich);
    assert_eq!(ask(&munich, "b2", "there").await["result"], "REFUSED");
    assert_eq!(ask(&munich, "a3", "here").await["leaseNumber"], 1);

    let handover = |to: &str| json!({ "instanceId": to });
    let path = "/factories/FOR_MUC/lease/handovers";
    let maker = story::planner(&world, "frames-munich").await;
    assert_eq!(maker.post(path, handover("b2")).await.status, 403);
    admin.post(path, handover("a3")).await.expect_problem(409, "NO_SUCH_CONTENDER");
    let lease = admin.post(path, handover("b2")).await.expect_ok();
    assert_eq!((&lease["leaseNumber"], &lease["holder"]["instanceId"]), (&json!(2), &json!("b2")));
    let former = ask(&munich, "a3", "here").await;
    assert_eq!(
        (&former["result"], &former["holder"]["host"]),
        (&json!("REFUSED"), &json!("machine of there"))
    );
    assert_eq!(ask(&munich, "b3", "there").await["leaseNumber"], 2);
    // What the former connector had received is sent to the new one as well.
    let part = munich.receive("operation-network", |_| true).await;
    munich.accept(&part);
    munich.send_under(1, "ua-data", &story::report("m2", 2, 5));
    dead_letters(&admin, 2).await;
    munich.send_under(2, "ua-data", &story::report("n2", 2, 6));
    story::value_is(&buyer, "6").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_successor_on_another_machine_gets_the_lease_when_the_first_is_silent() {
    let world = World::start().await;
    let (_admin, _buyer, munich, _hamburg) = story::accepted(&world).await;
    let maker = story::planner(&world, "frames-munich").await;
    with_leases(&munich);
    assert_eq!(ask(&munich, "a", "here").await["leaseNumber"], 1);
    let mut answers = Vec::new();
    loop {
        let answer = ask(&munich, "b", "there").await;
        let is_granted = answer["result"] == "GRANTED";
        answers.push(answer);
        if is_granted {
            break;
        }
        assert!(answers.len() < 10_000, "{:?}", answers.last());
    }
    assert_eq!(answers[0]["result"], "REFUSED", "not before the silence");
    assert_eq!(answers.last().map(|answer| &answer["leaseNumber"]), Some(&json!(2)));
    let taken = newest(&maker, "takeLease").await;
    assert_eq!(taken["subject"], "factories/FOR_MUC/lease");
    let hosts = ("machine of here", "machine of there");
    let fact = json!({ "kind": "HOST", "former": hosts.0, "present": hosts.1 });
    assert_eq!(taken["detail"], json!([fact]));
}
