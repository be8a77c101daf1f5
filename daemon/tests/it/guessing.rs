//! People who guess passwords, many at once and from many places.

use std::{net::IpAddr, time::Duration};

use daemon::web::{client_address::TrustedProxies, server::ListenerLimits, session::SessionConfig};
use futures::future::join_all;
use reqwest::{Method, header};
use serde_json::json;

use crate::harness::Harness;

const SESSION: &str = "/api/v1/session";
/// Guesses at once.
const GUESSES: u16 = 60;
/// Longest time in which an answer to a guess may come.
const WAIT: Duration = Duration::from_secs(600);

/// Starts behind a proxy on loopback, with waits that outlast the test.
async fn behind_proxy() -> Harness {
    Harness::start_with(of_proxy).await
}

fn of_proxy(sessions: &mut SessionConfig, proxies: &mut TrustedProxies) {
    sessions.throttle.first_wait = WAIT;
    sessions.throttle.longest_wait = WAIT;
    proxies.ranges.push("127.0.0.0/8".parse().expect("a range"));
}

/// Signs in as a client of the proxy.
async fn attempt(harness: &Harness, client: IpAddr, user: &str, password: &str) -> u16 {
    let request = harness
        .api
        .request(Method::POST, SESSION)
        .header("x-forwarded-for", client.to_string())
        .json(&json!({ "userName": user, "password": password }));
    request.send().await.expect("an answer").status().as_u16()
}

/// Returns the statuses of guesses at once that say whether the password is right.
async fn answered(harness: &Harness, client: impl Fn(u16) -> IpAddr) -> Vec<u16> {
    let guesses = (0..GUESSES).map(|number| attempt(harness, client(number), "ann", "wrong"));
    let mut statuses = join_all(guesses).await;
    statuses.retain(|status| *status != 429 && *status != 503);
    statuses
}

fn neighbour(number: u16) -> IpAddr {
    IpAddr::from([0x2001, 0xdb8, 0, 1, 0, 0, 0, number])
}

fn elsewhere(number: u16) -> IpAddr {
    let [high, low] = number.to_be_bytes();
    IpAddr::from([198, 18, high, low])
}

#[tokio::test]
async fn parallel_guesses_are_as_few_as_those_in_a_row() {
    let here: fn(u16) -> IpAddr = |_| IpAddr::from([192, 0, 2, 1]);
    for clients in [here, neighbour, elsewhere] {
        let harness = behind_proxy().await;
        let answers = answered(&harness, clients).await;
        assert!(answers.len() <= 5, "from {} on: {answers:?}", clients(0));
        assert!(answers.iter().all(|status| *status == 401), "{answers:?}");
    }
}

#[tokio::test]
async fn right_passwords_at_once_are_no_guesses() {
    let harness = behind_proxy().await;
    let sign_ins = (0..12).map(|_| attempt(&harness, neighbour(1), "ann", "correct horse"));
    assert_eq!(join_all(sign_ins).await, [200; 12]);
}

#[tokio::test]
async fn clients_of_a_proxy_are_distinguished_and_others_cannot_pose_as_them() {
    let harness = behind_proxy().await;
    for number in 0..50 {
        attempt(&harness, elsewhere(1), &format!("user{number}"), "wrong").await;
    }
    assert_eq!(attempt(&harness, elsewhere(1), "ann", "correct horse").await, 429);
    assert_eq!(attempt(&harness, elsewhere(2), "ann", "correct horse").await, 200);

    let open = Harness::start_with(|sessions, _| sessions.throttle.first_wait = WAIT).await;
    for number in 0..50 {
        attempt(&open, elsewhere(number), &format!("user{number}"), "wrong").await;
    }
    assert_eq!(attempt(&open, elsewhere(99), "ann", "correct horse").await, 429, "it is one peer");
}

#[tokio::test]
async fn strangers_do_not_lock_out_a_person_at_the_usual_place() {
    let harness = behind_proxy().await;
    assert_eq!(attempt(&harness, neighbour(1), "ann", "correct horse").await, 200);
    assert_eq!(answered(&harness, elsewhere).await.len(), 5);
    assert_eq!(attempt(&harness, elsewhere(99), "ann", "correct horse").await, 429);
    assert_eq!(attempt(&harness, neighbour(2), "ann", "correct horse").await, 200);
}

#[tokio::test]
async fn the_usual_place_of_a_person_with_a_session_outlasts_a_start() {
    let before = behind_proxy().await;
    let sign_in = before
        .api
        .request(Method::POST, SESSION)
        .header("x-forwarded-for", neighbour(1).to_string())
        .json(&json!({ "userName": "ann", "password": "correct horse" }));
    let answer = sign_in.send().await.expect("an answer");
    assert_eq!(answer.status(), 200);
    let cookie = answer.headers()[header::SET_COOKIE].to_str().expect("text").to_owned();
    let cookie = cookie.split(';').next().expect("a cookie").to_owned();
    let memory = before.memory.clone();
    drop(before);
    let after = Harness::start_on(memory, ListenerLimits::default(), of_proxy).await;
    let page = after.api.request(Method::GET, SESSION).header(header::COOKIE, cookie);
    assert_eq!(page.send().await.expect("an answer").status(), 200);
    assert_eq!(answered(&after, elsewhere).await.len(), 5);
    assert_eq!(attempt(&after, elsewhere(99), "ann", "correct horse").await, 429);
    assert_eq!(attempt(&after, neighbour(2), "ann", "correct horse").await, 200);
}

#[tokio::test]
async fn four_clients_cannot_take_all_places_before_a_sign_in() {
    let harness = behind_proxy().await;
    let attempts = (0..64_u16).map(|number| {
        let (user, harness) = (format!("user{number}"), &harness);
        async move { attempt(harness, elsewhere(number % 4), &user, "wrong").await }
    });
    let fifth = async {
        // Until they have all that they may have.
        tokio::time::sleep(Duration::from_millis(100)).await;
        attempt(&harness, elsewhere(99), "ann", "correct horse").await
    };
    let (statuses, fifth) = tokio::join!(join_all(attempts), fifth);
    assert_eq!(fifth, 200);
    assert!(statuses.iter().all(|status| [401, 503].contains(status)), "{statuses:?}");
}

#[tokio::test]
async fn endless_names_are_refused_and_leave_nothing_behind() {
    let harness = behind_proxy().await;
    assert_eq!(attempt(&harness, neighbour(1), &"x".repeat(1024 * 1024), "wrong").await, 413);
    let body = json!({ "userName": "x".repeat(257), "password": "wrong" });
    let answer = harness.api.call(Method::POST, SESSION, Some(&body)).await.expect("an answer");
    assert_eq!(answer.status, 422);
    assert_eq!(answer.json()["faults"][0]["pointer"], "/userName");

    let before = resident_bytes();
    for round in 0..100 {
        let attempts = (0..100).map(|number| {
            let name = format!("{round}-{number}-{}", "x".repeat(200));
            let harness = &harness;
            async move { attempt(harness, elsewhere(round), &name, "wrong").await }
        });
        join_all(attempts).await;
    }
    let grown = resident_bytes().saturating_sub(before);
    assert!(grown < 100 * 1024 * 1024, "10 000 attempts left {grown} bytes");
}

/// Returns the memory of this process.
fn resident_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("the process's status");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("its memory");
    line.trim().trim_end_matches(" kB").trim().parse::<u64>().expect("a number") * 1024
}
