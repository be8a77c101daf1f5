//! Turns of pages at the readers of the store, and of changes at its writer: what one person asks for leaves readers to
//! the others, and holds up no change of theirs.

use std::time::{Duration, Instant};

use platform::audit::CommandLine;
use reqwest::{Method, Response, StatusCode};
use serde_json::{Value, json};
use tokio::{task::JoinHandle, time::timeout};

use crate::{
    harness::{Api, World, eventually},
    story,
};

const FACTORIES: &str = "/api/v1/factories";
/// Requests of the greedy person: one that has its turn at least, 100 that wait, and some beyond.
const GREEDY: usize = 120;

/// Waits until requests beyond those that may wait are refused.
async fn so_many_are_refused(asking: &[JoinHandle<reqwest::Result<Response>>], wanted: usize) {
    let begun = Instant::now();
    eventually("those beyond the ones that may wait are refused", || async {
        let count = asking.iter().filter(|one| one.is_finished()).count();
        if count >= wanted { Ok(()) } else { Err(count.to_string()) }
    })
    .await;
    assert!(begun.elapsed() < Duration::from_secs(9), "at once, not after a while");
}

/// Returns how many were refused; the others have an answer of this status.
async fn refused(asking: Vec<JoinHandle<reqwest::Result<Response>>>, served: StatusCode) -> usize {
    let mut refused = 0;
    for one in asking {
        let status = one.await.expect("it ends").expect("an answer").status();
        assert!([served, StatusCode::TOO_MANY_REQUESTS].contains(&status), "{status}");
        refused += usize::from(status == StatusCode::TOO_MANY_REQUESTS);
    }
    refused
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_of_one_person_wait_for_their_turn_and_another_member_is_served() {
    let world = World::start().await;
    story::set_up(&world).await;
    let greedy = story::planner(&world, "inspect-hamburg").await;
    let other = story::planner(&world, "frames-munich").await;
    let store = &world.handle().application.store;
    let mut held = Vec::new();
    while let Ok(work) = timeout(Duration::from_secs(1), store.read()).await {
        held.push(work.expect("a reader"));
    }
    // Nothing is read, as if each page took long.
    let asking: Vec<_> = (0..GREEDY)
        .map(|_| tokio::spawn(greedy.client.request(Method::GET, FACTORIES).send()))
        .collect();
    so_many_are_refused(&asking, 18).await;
    let others = tokio::spawn(other.client.request(Method::GET, FACTORIES).send());
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert!(!others.is_finished(), "there is no reader yet");
    // One reader for all: the pages of the greedy one that have their turn come first, and then that of the other.
    drop(held.pop());
    let answer = timeout(Duration::from_secs(1), others).await.expect("it is served");
    assert_eq!(answer.expect("it ends").expect("an answer").status(), StatusCode::OK);
    drop(held);
    let refused = refused(asking, StatusCode::OK).await;
    assert!((18..GREEDY).contains(&refused), "{refused}");
}

/// Begins to comment on the network.
fn comment(api: &Api, number: usize) -> JoinHandle<reqwest::Result<Response>> {
    let path = format!("/api/v1{}/comments", story::network_path());
    let body = json!({ "factoryId": "FOR_MUC", "text": format!("Comment {number}.") });
    tokio::spawn(api.client.request(Method::POST, &path).json(&body).send())
}

/// Returns the people who commented, in the order in which the writer had their comments.
async fn authors(admin: &Api) -> Vec<Value> {
    let entries = admin.get("/audit-entries?limit=500").await.expect_ok();
    let entries = entries["items"].as_array().expect("a list");
    let comments = entries.iter().rev().filter(|entry| entry["operation"] == "addComment");
    comments.map(|entry| entry["agentName"].clone()).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_flood_of_changes_of_one_member_is_passed_by_the_change_of_another() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let greedy = story::planner(&world, "acme-aero").await;
    let other = story::planner(&world, "frames-munich").await;
    story::put_network(&greedy, story::network()).await;
    let store = &world.handle().application.store;
    // Nothing is written, as if each change took long.
    let writer = store.begin(CommandLine, "holdTheWriter").await.expect("the writer");
    let flood: Vec<_> = (0..GREEDY).map(|number| comment(&greedy, number)).collect();
    so_many_are_refused(&flood, GREEDY - 101).await;
    let change = comment(&other, 0);
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert!(!change.is_finished(), "there is no writer yet");
    let page = greedy.client.request(Method::GET, FACTORIES).send();
    let page = timeout(Duration::from_secs(5), page).await.expect("pages have other turns");
    assert_eq!(page.expect("an answer").status(), StatusCode::OK);
    drop(writer);
    let change = change.await.expect("it ends").expect("an answer");
    assert_eq!(change.status(), StatusCode::CREATED);
    let refused = refused(flood, StatusCode::CREATED).await;
    assert!((GREEDY - 101..GREEDY).contains(&refused), "{refused}");
    let authors = authors(&admin).await;
    assert_eq!(authors.len(), GREEDY - refused + 1);
    // One of the flood had its turn when the other came, and a second one may have had it meanwhile.
    let turn = authors.iter().position(|author| author == "frames-munich-planner");
    assert!(turn.is_some_and(|turn| turn <= 2), "{turn:?} of {}", authors.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn enrolments_and_progress_wait_for_no_page() {
    let world = World::start().await;
    let (admin, buyer, munich, _hamburg) = story::accepted(&world).await;
    let token = admin.post("/factories/INS_HAM/enrolment-tokens", json!({})).await.expect_ok();
    let view = buyer.get(&story::network_path()).await.expect_ok();
    let mut live = buyer.live(view["lastEventId"].as_str()).await;
    let store = &world.handle().application.store;
    let mut held = Vec::new();
    while let Ok(work) = timeout(Duration::from_secs(1), store.read()).await {
        held.push(work.expect("a reader"));
    }
    let enrolled = world.anonymous();
    let enrolled = enrolled.post("/enrolments", json!({ "token": token["token"] }));
    let enrolled = timeout(Duration::from_secs(10), enrolled).await;
    enrolled.expect("it waits for no page").expect_ok();
    munich.send("ua-data", &story::report("m0", 0, 3));
    let progress = timeout(Duration::from_secs(10), live.next("progress")).await;
    let (_, progress) = progress.expect("it waits for no page");
    assert_eq!(progress["operationNetworkId"], json!(story::NETWORK));
    drop(held);
}
