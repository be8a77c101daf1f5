//! Shares of people and organisations: what one uses up, others do not feel.

use std::{
    convert::Infallible,
    num::NonZeroU32,
    time::{Duration, Instant},
};

use futures::stream;
use reqwest::{Body, Method, Response};
use serde_json::Value;
use testkit::{ApiClient, wait::eventually};
use tokio::{task::JoinHandle, time::timeout};

use crate::{harness::Harness, memory::PageReaders};

const SESSION: &str = "/api/v1/session";
const PASSWORD: &str = "/api/v1/session/password";
const EXPORT: &str = "/api/v1/export";
const LIVE: &str = "/api/v1/live";
const PAGE: &str = "/api/v1/page";
const ENDLESS_PAGE: &str = "/api/v1/page/endless";
const ENDLESS_EXPORT: &str = "/api/v1/export/endless";

fn number(value: u32) -> NonZeroU32 {
    NonZeroU32::new(value).expect("not zero")
}

/// A daemon where a person has 5 requests and an organisation 8, one of each back in a second.
async fn few_requests() -> Harness {
    Harness::start_with(|config, _| {
        let shares = &mut config.shares;
        shares.person.requests_per_second = number(1);
        shares.person.requests_at_once = number(5);
        shares.organisation.requests_per_second = number(1);
        shares.organisation.requests_at_once = number(8);
    })
    .await
}

/// A daemon where a person has two places for downloads and for streams each, an organisation three.
async fn few_places() -> Harness {
    Harness::start_with(|config, _| {
        let shares = &mut config.shares;
        shares.person.downloads = number(2);
        shares.person.streams = number(2);
        shares.organisation.downloads = number(3);
        shares.organisation.streams = number(3);
    })
    .await
}

async fn get(client: &ApiClient, path: &str) -> Response {
    client.request(Method::GET, path).send().await.expect("an answer")
}

async fn problem(response: Response) -> (String, Value) {
    assert_eq!(response.status(), 429);
    assert_eq!(response.headers()["content-type"], "application/problem+json");
    let retry_after = response.headers()["retry-after"].to_str().expect("text").to_owned();
    let document: Value = response.json().await.expect("JSON");
    (retry_after, document["code"].clone())
}

#[tokio::test]
async fn one_person_uses_its_requests_up_and_others_do_not_feel_it() {
    let harness = few_requests().await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let bob = harness.person("bob@b").await;
    let mut passed = 0;
    let refused = loop {
        let answer = get(&ann, SESSION).await;
        if answer.status() != 200 {
            break answer;
        }
        passed += 1;
        assert!(passed < 100, "requests have no end");
    };
    assert!(passed >= 5, "{passed}");
    assert_eq!(problem(refused).await, ("1".to_owned(), "TOO_MANY_REQUESTS".into()));
    assert_eq!(get(&amy, SESSION).await.status(), 200, "a colleague");
    for _ in 0..5 {
        assert_eq!(get(&bob, SESSION).await.status(), 200, "another organisation");
    }
    let metrics = harness.get("/metrics").await.text().await.expect("a text");
    let count = r#"verbund_share_refusals_total{of="person",share="requests",who="ann@a"} "#;
    assert!(metrics.contains(count), "{metrics}");
}

#[tokio::test]
async fn an_organisation_uses_its_requests_up_and_others_do_not_feel_it() {
    let harness = few_requests().await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let bob = harness.person("bob@b").await;
    for client in [&ann, &amy] {
        for _ in 0..5 {
            get(client, SESSION).await;
        }
    }
    let zoe = harness.person("zoe@a").await;
    let mut answers = Vec::new();
    for _ in 0..5 {
        answers.push(get(&zoe, SESSION).await.status().as_u16());
    }
    assert!(answers.contains(&429), "a third person finds the organisation's used up: {answers:?}");
    let metrics = harness.get("/metrics").await.text().await.expect("a text");
    let count = r#"verbund_share_refusals_total{of="organisation",share="requests",who="a"} "#;
    assert!(metrics.contains(count), "{metrics}");
    for _ in 0..5 {
        assert_eq!(get(&bob, SESSION).await.status(), 200);
    }
}

/// Opens answers that last until the person and then the organisation has no place; ends one and waits
/// for its place.
async fn places_are_bounded(path: &str, code: &str) {
    let harness = few_places().await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let bob = harness.person("bob@b").await;
    let first = get(&ann, path).await;
    let second = get(&ann, path).await;
    assert_eq!((first.status().as_u16(), second.status().as_u16()), (200, 200));
    assert_eq!(problem(get(&ann, path).await).await, ("10".to_owned(), code.into()));
    let third = get(&amy, path).await;
    assert_eq!(third.status(), 200, "a colleague has the organisation's last place");
    assert_eq!(problem(get(&amy, path).await).await.1, code);
    let other = get(&bob, path).await;
    assert_eq!(other.status(), 200, "another organisation");
    assert_eq!(get(&bob, SESSION).await.status(), 200, "requests are another share");
    drop(first);
    let freed = eventually("the place is free", Duration::from_secs(20), async || {
        let answer = get(&amy, path).await;
        let status = answer.status();
        if status == 200 { Ok(answer) } else { Err(status.to_string()) }
    });
    freed.await.expect("the end of the first gave its place back");
    drop((second, third, other));
}

#[tokio::test]
async fn downloads_hold_a_place_until_they_have_ended_and_others_do_not_feel_it() {
    places_are_bounded(EXPORT, "TOO_MANY_DOWNLOADS").await;
}

#[tokio::test]
async fn live_streams_hold_a_place_until_they_have_ended_and_others_do_not_feel_it() {
    places_are_bounded(LIVE, "TOO_MANY_STREAMS").await;
}

/// Asks for so many pages that are read without end, and waits until readers are held.
async fn ask_without_end(
    harness: &Harness,
    client: &ApiClient,
    held: usize,
) -> Vec<JoinHandle<reqwest::Result<Response>>> {
    let asking = (0..50).map(|_| tokio::spawn(client.request(Method::GET, ENDLESS_PAGE).send()));
    let asking = asking.collect();
    let readers = &harness.memory.readers.0;
    let begun = eventually("readers are held", Duration::from_secs(20), async || {
        let free = readers.available_permits();
        if free <= PageReaders::COUNT - held { Ok(()) } else { Err(free.to_string()) }
    });
    begun.await.expect("its first pages are read");
    // The others are there, too.
    tokio::time::sleep(Duration::from_millis(500)).await;
    assert_eq!(readers.available_permits(), PageReaders::COUNT - held, "the others wait");
    asking
}

#[tokio::test(flavor = "multi_thread")]
async fn pages_without_end_of_one_member_leave_readers_to_others() {
    let harness = Harness::start().await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let (zoe, bob) = (harness.person("zoe@a").await, harness.person("bob@b").await);
    let is_served = async |client: &ApiClient| {
        let begun = Instant::now();
        let answer = timeout(Duration::from_secs(5), get(client, PAGE)).await;
        assert_eq!(answer.expect("it is served meanwhile").status(), 200);
        assert!(begun.elapsed() < Duration::from_secs(1), "{:?}", begun.elapsed());
    };
    let of_ann = ask_without_end(&harness, &ann, 2).await;
    is_served(&amy).await;
    is_served(&bob).await;
    let of_amy = ask_without_end(&harness, &amy, 4).await;
    is_served(&bob).await;
    let waits = timeout(Duration::from_millis(500), get(&zoe, PAGE)).await;
    assert!(waits.is_err(), "the organisation has its four");
    for asking in of_ann.into_iter().chain(of_amy) {
        asking.abort();
    }
    is_served_soon(&zoe).await;
}

/// Waits until pages of a person are read again.
async fn is_served_soon(client: &ApiClient) {
    let served = timeout(Duration::from_secs(8), get(client, PAGE)).await;
    assert_eq!(served.expect("those who gave up left their places").status(), 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn who_asks_for_too_many_pages_at_once_is_refused() {
    let harness = Harness::start().await;
    let (ann, bob) = (harness.person("ann@a").await, harness.person("bob@b").await);
    let mut asking: Vec<_> = Vec::new();
    for _ in 0..3 {
        asking.extend(ask_without_end(&harness, &ann, 2).await);
    }
    let beyond = asking.len() - 2 - 100;
    let answered = eventually("all beyond are refused", Duration::from_secs(5), async || {
        let count = asking.iter().filter(|one| one.is_finished()).count();
        if count == beyond { Ok(()) } else { Err(count.to_string()) }
    });
    answered.await.expect("two are read, and a hundred wait");
    for one in asking {
        if one.is_finished() {
            let answer = one.await.expect("it ends").expect("an answer");
            assert_eq!(problem(answer).await, ("2".to_owned(), "TOO_MANY_READS".into()));
        } else {
            one.abort();
        }
    }
    assert_eq!(get(&bob, PAGE).await.status(), 200);
    let metrics = harness.get("/metrics").await.text().await.expect("a text");
    let count = r#"verbund_share_refusals_total{of="person",share="reads",who="ann@a"} "#;
    assert!(metrics.contains(count), "{metrics}");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_export_reads_in_the_turns_of_its_person() {
    let harness = Harness::start().await;
    let ann = harness.person("ann@a").await;
    let of_ann = ask_without_end(&harness, &ann, 2).await;
    let export = tokio::spawn(ann.request(Method::GET, ENDLESS_EXPORT).send());
    tokio::time::sleep(Duration::from_millis(500)).await;
    let readers = &harness.memory.readers.0;
    assert_eq!(readers.available_permits(), PageReaders::COUNT - 2, "the export waits");
    for asking in of_ann {
        asking.abort();
    }
    let read = eventually("the export is read", Duration::from_secs(20), async || {
        let free = readers.available_permits();
        if free == PageReaders::COUNT - 1 { Ok(()) } else { Err(free.to_string()) }
    });
    read.await.expect("its turn came");
    drop(export);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_change_has_its_turn_once_its_body_is_there() {
    let harness = Harness::start().await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let slow = [slow_body(&ann, PAGE), slow_body(&amy, PAGE)];
    tokio::time::sleep(Duration::from_millis(500)).await;
    let change = ann.request(Method::PUT, PAGE).body("all of it").send();
    let answer = timeout(Duration::from_secs(5), change).await.expect("nobody is before it");
    let answer = answer.expect("an answer");
    assert_eq!(
        (answer.status().as_u16(), answer.text().await.expect("a text")),
        (200, "all of it".into())
    );
    let too_long = ann.request(Method::PUT, PAGE).body(vec![b' '; 1024 * 1024 + 1]).send();
    assert_eq!(too_long.await.expect("an answer").status(), 413);
    slow.into_iter().for_each(|sending| sending.abort());
}

/// Sends a request whose body never comes, and which counts as 4 MiB.
fn slow_body(client: &ApiClient, path: &str) -> JoinHandle<reqwest::Result<Response>> {
    let body = Body::wrap_stream(stream::pending::<Result<Vec<u8>, Infallible>>());
    let request = client.request(Method::PUT, path).header("content-type", "application/json");
    tokio::spawn(request.body(body).send())
}

#[tokio::test]
async fn bodies_of_a_person_have_a_bound_in_sum() {
    let harness = Harness::start_with(|config, _| {
        config.shares.person.body_mib = number(8);
        config.shares.organisation.body_mib = number(12);
    })
    .await;
    let (ann, amy) = (harness.person("ann@a").await, harness.person("amy@a").await);
    let bob = harness.person("bob@b").await;
    let refused = |client: ApiClient| async move {
        let mut held = Vec::new();
        for _ in 0..10 {
            let mut sending = slow_body(&client, PASSWORD);
            match timeout(Duration::from_millis(200), &mut sending).await {
                Ok(answer) => return (held, answer.expect("it ends").expect("an answer")),
                Err(_) => held.push(sending),
            }
        }
        panic!("bodies have no end");
    };
    let (of_ann, answer) = refused(ann.clone()).await;
    assert_eq!((of_ann.len(), problem(answer).await.1), (2, "TOO_MANY_BODIES".into()));
    assert_eq!(get(&ann, SESSION).await.status(), 200, "what has no body");
    let (of_amy, answer) = refused(amy).await;
    assert_eq!((of_amy.len(), problem(answer).await.1), (1, "TOO_MANY_BODIES".into()));
    let (of_bob, _) = refused(bob).await;
    assert_eq!(of_bob.len(), 2, "another organisation");
    for sending in of_ann {
        sending.abort();
    }
    let freed = eventually("the bytes are free", Duration::from_secs(20), async || {
        let request = ann.request(Method::PUT, PASSWORD).json(&serde_json::json!({}));
        let status = request.send().await.expect("an answer").status().as_u16();
        if status == 422 || status == 400 { Ok(()) } else { Err(status.to_string()) }
    });
    freed.await.expect("the end of a request gave its bytes back");
}

#[tokio::test]
async fn made_up_cookies_draw_on_the_share_of_strangers() {
    let harness = Harness::start().await;
    let ann = harness.person("ann@a").await;
    let stranger = reqwest::Client::new();
    let ask = async |cookie: &str| {
        let url = format!("{}{SESSION}", harness.api.origin());
        let request = stranger.get(url).header("cookie", format!("verbund_test_8080={cookie}"));
        request.send().await.expect("an answer").status().as_u16()
    };
    let mut asked = 0;
    while ask(&daemon::web::session::random_token()).await == 401 {
        asked += 1;
        assert!(asked < 1_000, "guesses have no end");
    }
    assert_eq!(ask(&daemon::web::session::random_token()).await, 429);
    assert_eq!(ask("rubbish").await, 401, "it is no cookie, so nothing is looked up");
    assert_eq!(get(&ann, SESSION).await.status(), 200, "a person of the same address");
    let metrics = harness.get("/metrics").await.text().await.expect("a text");
    assert!(metrics.contains("verbund_open_requests_refused_total"), "{metrics}");
}
