//! A second factor at the platform, in its store.

use serde_json::json;
use testkit::authenticator::code;

use crate::harness::{ADMIN, Api, PASSWORD, World};

const FACTOR: &str = "/session/second-factor";

async fn sign_in(world: &World, code: Option<&str>) -> (u16, String) {
    let mut body = json!({ "userName": ADMIN, "password": PASSWORD });
    if let Some(code) = code {
        body["code"] = code.into();
    }
    let answer = world.anonymous().post("/session", body).await;
    (answer.status, answer.body["code"].as_str().unwrap_or_default().to_owned())
}

/// Turns the second factor of a person on; returns its secret and a recovery code.
async fn turned_on(person: &Api) -> (String, String) {
    let offer = person.post(FACTOR, json!({ "password": PASSWORD })).await.expect_ok();
    let secret = offer["secret"].as_str().expect("a secret").to_owned();
    let confirmed = person.put(FACTOR, json!({ "code": code(&secret, 0) })).await.expect_ok();
    (secret, confirmed["recoveryCodes"][0].as_str().expect("a code").to_owned())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_second_factor_outlasts_a_restart_and_its_codes_are_good_once() {
    let mut world = World::start().await;
    let (secret, recovery) = turned_on(&world.admin().await).await;
    world.restart().await;
    assert_eq!(sign_in(&world, None).await, (401, "SECOND_FACTOR_NEEDED".to_owned()));
    let next = code(&secret, 1);
    assert_eq!(sign_in(&world, Some(&next)).await.0, 200);
    world.restart().await;
    assert_eq!(sign_in(&world, Some(&next)).await.0, 401, "a replay");
    assert_eq!(sign_in(&world, Some(&recovery)).await.0, 200);
    assert_eq!(sign_in(&world, Some(&recovery)).await.0, 401, "used up");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_administrator_resets_a_lost_second_factor_and_nobody_else() {
    let world = World::start().await;
    let admin = world.admin().await;
    let body = json!({ "password": PASSWORD, "role": "VIEWER" });
    for name in ["ann", "bob"] {
        admin.put(&format!("/users/{name}"), body.clone()).await.expect_ok();
    }
    let (ann, bob) = (world.sign_in("ann", PASSWORD).await, world.sign_in("bob", PASSWORD).await);
    turned_on(&ann).await;
    assert_eq!(bob.delete("/users/ann/second-factor").await.status, 403);
    assert_eq!(admin.delete("/users/ann/second-factor").await.status, 204);
    assert_eq!(admin.delete("/users/ann/second-factor").await.status, 404);
    world.sign_in("ann", PASSWORD).await;
}
