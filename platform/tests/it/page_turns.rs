//! Turns of pages at the readers of the store: what one person asks for leaves readers to the others.

use std::time::{Duration, Instant};

use reqwest::{Method, StatusCode};
use tokio::time::timeout;

use crate::{
    harness::{World, eventually},
    story,
};

const FACTORIES: &str = "/api/v1/factories";

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
    let begun = Instant::now();
    let asking: Vec<_> = (0..120)
        .map(|_| tokio::spawn(greedy.client.request(Method::GET, FACTORIES).send()))
        .collect();
    eventually("those beyond the ones that may wait are refused", || async {
        let count = asking.iter().filter(|one| one.is_finished()).count();
        if count >= 18 { Ok(()) } else { Err(count.to_string()) }
    })
    .await;
    assert!(begun.elapsed() < Duration::from_secs(9), "at once, not after a while");
    let others = tokio::spawn(other.client.request(Method::GET, FACTORIES).send());
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert!(!others.is_finished(), "there is no reader yet");
    // One reader for all: the pages of the greedy one that have their turn come first, and then that of the other.
    drop(held.pop());
    let answer = timeout(Duration::from_secs(1), others).await.expect("it is served");
    assert_eq!(answer.expect("it ends").expect("an answer").status(), StatusCode::OK);
    drop(held);
    let mut refused = 0;
    for one in asking {
        let status = one.await.expect("it ends").expect("an answer").status();
        assert!([StatusCode::OK, StatusCode::TOO_MANY_REQUESTS].contains(&status), "{status}");
        refused += usize::from(status == StatusCode::TOO_MANY_REQUESTS);
    }
    assert!((18..120).contains(&refused), "{refused}");
}
