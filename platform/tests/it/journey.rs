//! The journeys of a request and of a value.

use serde_json::json;

use crate::{
    connector::Peer,
    harness::{World, eventually},
    leases,
    story::{self, NETWORK, network_path},
};

#[tokio::test(flavor = "multi_thread")]
async fn a_request_reaches_the_factory_and_its_answer_the_page() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let buyer = story::planner(&world, "acme-aero").await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    let mut live = buyer.live(None).await;

    let changed = story::put_network(&buyer, story::network()).await;
    assert_eq!(
        changed,
        json!({ "revision": 1, "isChanged": true, "sentTo": ["FOR_MUC", "INS_HAM"] })
    );
    let part = munich.receive("operation-network", |_| true).await;
    assert_eq!(part["revision"], json!(1));
    assert_eq!(part["factoryId"], json!("FOR_MUC"));
    assert_eq!(part["collaborationId"], json!("order"));
    let operations = part["operationNetwork"]["operationList"].as_array().expect("operations");
    assert_eq!(operations[1]["stub"], true, "the neighbour is a stub: {}", operations[1]);

    munich.accept(&part);
    let (_, event) = loop {
        let (id, event) = live.next("part").await;
        if event["state"] == "ACCEPTED" {
            break (id, event);
        }
    };
    assert_eq!(
        (&event["factoryId"], &event["operationNetworkId"]),
        (&json!("FOR_MUC"), &json!(NETWORK))
    );

    munich.send("decision", &story::decision("MAPPED", None));
    let (_, event) = live.next("decision").await;
    assert_eq!(
        (&event["key"]["fieldName"], &event["mappingState"]),
        (&json!("progressStatus"), &json!("MAPPED"))
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_value_reaches_the_page_once_however_often_it_is_delivered() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let view = buyer.get(&network_path()).await.expect_ok();
    let mut live = buyer.live(view["lastEventId"].as_str()).await;

    munich.send("ua-data", &story::report("m1", 0, 3));
    let (_, event) = live.next("value").await;
    let field = &event["fields"][0];
    assert_eq!(field["value"], json!("3"));
    assert_eq!(field["status"], json!("Good"));
    assert_eq!(field["sequence"], json!(0));
    assert_eq!(field["sourceTimestamp"], "2019-04-18T18:20:05Z");
    let (_, event) = live.next("progress").await;
    assert_eq!(
        (&event["operationId"], &event["percentComplete"]),
        (&json!("MakeFrame1"), &json!(25.0))
    );

    // The same message, the same report in another message, then a newer one.
    munich.send("ua-data", &story::report("m1", 0, 3));
    munich.send("ua-data", &story::report("m2", 0, 3));
    munich.send("ua-data", &story::report("m3", 1, 4));
    let view = story::value_is(&buyer, "4").await;
    assert_eq!(view["operations"][0]["quantity"], 4.0);
    let reports = buyer.get(&format!("/reports?network={NETWORK}")).await.expect_ok();
    let sequences: Vec<_> = reports["items"]
        .as_array()
        .expect("reports")
        .iter()
        .map(|r| r["sequence"].clone())
        .collect();
    assert_eq!(sequences, [0, 1]);
    let (_, event) = live.next("value").await;
    assert_eq!(event["fields"][0]["value"], "4", "what was repeated is not told again");
}

#[tokio::test(flavor = "multi_thread")]
async fn after_an_outage_the_newest_value_stays_in_front_of_the_backlog() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("ua-data", &story::report("m9", 9, 90));
    story::value_is(&buyer, "90").await;
    for sequence in 0..9 {
        munich.send(
            "ua-data",
            &story::report(&format!("m{sequence}"), sequence, u64::from(sequence)),
        );
    }
    eventually("all are held", || async {
        let writers = admin.get("/factories/FOR_MUC/writers").await.expect_ok();
        let writer = &writers["items"][0];
        if writer["received"] == 10 && writer["missingCount"] == 0 {
            Ok(())
        } else {
            Err(writer.to_string())
        }
    })
    .await;
    story::value_is(&buyer, "90").await;
    let newest =
        buyer.get(&format!("/reports?network={NETWORK}&newest=true&limit=2")).await.expect_ok();
    let sequences: Vec<_> = newest["items"]
        .as_array()
        .expect("reports")
        .iter()
        .map(|r| r["sequence"].clone())
        .collect();
    assert_eq!(sequences, [7, 8], "the newest in the order of arrival: {newest}");
    let first = buyer.get(&format!("/reports?network={NETWORK}&limit=1")).await.expect_ok();
    assert_eq!(first["items"][0]["sequence"], 9);
    let after = first["nextCursor"].as_str().expect("another page");
    let second =
        buyer.get(&format!("/reports?network={NETWORK}&limit=1&after={after}")).await.expect_ok();
    assert_eq!(second["items"][0]["sequence"], 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_restart_loses_nothing_and_pages_are_asked_to_reload() {
    let mut world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    munich.send("decision", &story::decision("MAPPED", None));
    munich.send("ua-data", &story::report("m1", 0, 3));
    let before = story::value_is(&buyer, "3").await;
    drop(munich);

    world.restart().await;
    let buyer = story::planner(&world, "acme-aero").await;
    let after = buyer.get(&network_path()).await.expect_ok();
    for part in ["revision", "network", "parts", "operations"] {
        assert_eq!(after[part], before[part], "{part}");
    }
    let values = |view: &serde_json::Value| {
        let fields = view["fields"].as_array().cloned().unwrap_or_default();
        fields
            .into_iter()
            .map(|field| (field["key"].clone(), field["value"].clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(values(&after), values(&before));
    let mut live = buyer.live(before["lastEventId"].as_str()).await;
    assert_eq!(live.any().await.1, "reset");
}

#[tokio::test(flavor = "multi_thread")]
async fn only_what_differs_is_sent_and_withdrawal_reaches_those_who_had_a_part() {
    let world = World::start().await;
    let (_, buyer, munich, hamburg) = story::accepted(&world).await;
    let again = story::put_network(&buyer, story::network()).await;
    assert_eq!(again, json!({ "revision": 1, "isChanged": false, "sentTo": [] }));

    let path = format!("{}/operations/MakeFrame1/requests", network_path());
    let added = buyer.post(&path, story::request("ReqResponse2", "acme-aero")).await.expect_ok();
    assert_eq!((&added["revision"], &added["sentTo"]), (&json!(2), &json!(["FOR_MUC"])));
    let part = munich.receive("operation-network", |part| part["revision"] == 2).await;
    munich.accept(&part);

    let removed = buyer.delete(&format!("{path}/ReqResponse2")).await.expect_ok();
    assert_eq!(removed["sentTo"], json!(["FOR_MUC"]));
    let part = munich.receive("operation-network", |part| part["revision"] == 3).await;
    munich.accept(&part);

    buyer.delete(&network_path()).await.expect_ok();
    for peer in [&munich, &hamburg] {
        let withdrawal = peer.receive("withdraw", |_| true).await;
        assert_eq!(withdrawal["revision"], 4);
        peer.accept(&withdrawal);
    }
    let view = story::parts_are(&buyer, "ACCEPTED").await;
    assert!(view["withdrawnAt"].is_string());
    assert_eq!(view["fields"], json!([]));
    assert_eq!(hamburg.count("operation-network"), 1, "Hamburg's part never changed");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_unanswered_part_is_sent_again_until_it_is() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let munich = Peer::enrolled(&world, &admin, "FOR_MUC").await;
    story::put_network(&admin, story::network()).await;
    eventually("a second copy", || async {
        let count = munich.count("operation-network");
        if count >= 2 { Ok(()) } else { Err(count.to_string()) }
    })
    .await;
    let part = munich.receive("operation-network", |_| true).await;
    munich.answer(
        &part,
        "REJECTED",
        json!([{ "pointer": "/operationNetwork", "code": "NO", "message": "No." }]),
    );
    eventually("the rejection", || async {
        let view = admin.get(&network_path()).await.expect_ok();
        let part = view["parts"][0].clone();
        if part["state"] == "REJECTED" && part["faultList"][0]["code"] == "NO" {
            Ok(())
        } else {
            Err(part.to_string())
        }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn comments_go_both_ways() {
    let world = World::start().await;
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    let comments = format!("{}/comments", network_path());
    let said = json!({ "factoryId": "FOR_MUC", "text": "When do you start?", "fieldName": "progressStatus" });
    buyer.post(&comments, said).await.expect_ok();
    let heard = munich.receive("comment", |_| true).await;
    assert_eq!(
        (&heard["text"], &heard["authorId"]),
        (&json!("When do you start?"), &json!("acme-aero-planner@acme-aero"))
    );
    munich.send(
        "comment",
        &json!({ "messageType": "comment", "messageId": "c2", "factoryId": "FOR_MUC",
        "operationNetworkId": NETWORK, "authorId": "engineer", "text": "Tomorrow." }),
    );
    eventually("the answer", || async {
        let list = buyer.get(&comments).await.expect_ok();
        let texts: Vec<_> =
            list["items"].as_array().expect("a list").iter().map(|c| c["text"].clone()).collect();
        if texts == ["When do you start?", "Tomorrow."] { Ok(()) } else { Err(list.to_string()) }
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_receive_heartbeats_and_catch_up_from_the_beginning() {
    let world = World::start().await;
    let beginning = world.handle().application.live.newest_id();
    let (_, buyer, munich, _hamburg) = story::accepted(&world).await;
    leases::with_leases(&munich);
    leases::ask(&munich, "a1", "here").await;
    let mut live = buyer.live(Some(&beginning)).await;
    let (_, first, _) = live.any().await;
    assert_eq!(first, "network");
    let (_, event) = live.next("factory").await;
    assert!(event["lastSeenAt"].is_string(), "{event}");
}
