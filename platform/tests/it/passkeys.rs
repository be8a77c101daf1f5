//! Passkeys at the platform, in its store.

use serde_json::{Value, json};
use testkit::SecurityKey;

use crate::harness::{ADMIN, Api, PAGES, PASSWORD, World};

const PASSKEYS: &str = "/session/passkeys";

/// Adds a passkey of a person; returns it with a recovery code.
async fn added(person: &Api, name: &str) -> (SecurityKey, Value) {
    let mut key = SecurityKey::new(name, PAGES);
    let offer = person.post(PASSKEYS, json!({ "password": PASSWORD })).await.expect_ok();
    let body = json!({ "name": name, "credential": key.create(&offer["options"]) });
    let answer = person.put(PASSKEYS, body).await.expect_ok();
    (key, answer["recoveryCodes"][0].clone())
}

async fn attempt(world: &World, user_name: &str, members: Value) -> (u16, Value) {
    let mut body = json!({ "userName": user_name, "password": PASSWORD });
    body.as_object_mut().expect("members").extend(members.as_object().expect("members").clone());
    let answer = world.anonymous().post("/session", body).await;
    (answer.status, answer.body)
}

/// Status of a sign-in by a key.
async fn by_key(world: &World, user_name: &str, key: &mut SecurityKey) -> u16 {
    let (_, needed) = attempt(world, user_name, json!({})).await;
    let passkey = key.get(&needed["secondFactor"]["passkeyOptions"]);
    attempt(world, user_name, json!({ "passkey": passkey })).await.0
}

#[tokio::test(flavor = "multi_thread")]
async fn passkeys_and_their_counters_outlast_a_restart() {
    let mut world = World::start_for_browsers().await;
    let admin = world.admin().await;
    let (mut key, recovery) = added(&admin, "blue").await;
    let (mut second, none) = added(&admin, "red").await;
    assert_eq!(none, Value::Null, "recovery codes are there");
    assert_eq!(by_key(&world, ADMIN, &mut key).await, 200);
    world.restart().await;
    key.counter = 0;
    assert_eq!(by_key(&world, ADMIN, &mut key).await, 401, "a copy of the key");
    key.counter = 1;
    assert_eq!(by_key(&world, ADMIN, &mut key).await, 200);
    assert_eq!(by_key(&world, ADMIN, &mut second).await, 200);
    assert_eq!(attempt(&world, ADMIN, json!({ "code": recovery })).await.0, 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_last_passkey_takes_the_recovery_codes_along() {
    let world = World::start_for_browsers().await;
    let admin = world.admin().await;
    let (mut key, recovery) = added(&admin, "blue").await;
    added(&admin, "red").await;
    assert_eq!(by_key(&world, ADMIN, &mut key).await, 200);
    let items = admin.get(PASSKEYS).await.expect_ok()["items"].clone();
    assert_eq!(items[0]["name"], "blue");
    assert!(items[0]["lastUsedAt"].is_string(), "{items}");
    for (item, left) in items.as_array().expect("a list").iter().zip([401, 200]) {
        let id = item["passkeyId"].as_str().expect("an id");
        let removal = format!("{PASSKEYS}/{id}/removal");
        admin.post(&removal, json!({ "password": PASSWORD })).await.expect_ok();
        assert_eq!(attempt(&world, ADMIN, json!({})).await.0, left);
    }
    let (_, new) = added(&admin, "green").await;
    assert_eq!(attempt(&world, ADMIN, json!({ "code": recovery })).await.0, 401);
    assert_eq!(attempt(&world, ADMIN, json!({ "code": new })).await.0, 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_administrator_resets_passkeys_and_nobody_else_and_all_of_it_is_on_record() {
    let world = World::start_for_browsers().await;
    let admin = world.admin().await;
    for name in ["ann", "bob"] {
        let body = json!({ "password": PASSWORD, "role": "VIEWER" });
        admin.put(&format!("/users/{name}"), body).await.expect_ok();
    }
    let (ann, bob) = (world.sign_in("ann", PASSWORD).await, world.sign_in("bob", PASSWORD).await);
    added(&ann, "blue").await;
    added(&ann, "red").await;
    let items = ann.get(PASSKEYS).await.expect_ok()["items"].clone();
    let removal = format!("{PASSKEYS}/{}/removal", items[1]["passkeyId"].as_str().expect("an id"));
    assert_eq!(bob.post(&removal, json!({ "password": PASSWORD })).await.status, 404);
    ann.post(&removal, json!({ "password": PASSWORD })).await.expect_ok();
    assert_eq!(bob.delete("/users/ann/second-factor").await.status, 403);
    assert_eq!(admin.delete("/users/ann/second-factor").await.status, 204);
    assert_eq!(admin.delete("/users/ann/second-factor").await.status, 404);
    world.sign_in("ann", PASSWORD).await;

    let entries = admin.get("/audit-entries").await.expect_ok()["items"].clone();
    let of_passkeys: Vec<String> = entries
        .as_array()
        .expect("a list")
        .iter()
        .filter(|entry| {
            entry["subject"].as_str().is_some_and(|path| path.starts_with("users/ann/"))
        })
        .filter(|entry| !entry["subject"].as_str().is_some_and(|path| path.ends_with("/session")))
        .map(|entry| format!("{}: {}", entry["agentName"], entry["operation"]).replace('"', ""))
        .collect();
    let newest_first =
        ["admin: resetSecondFactor", "ann: removePasskey", "ann: addPasskey", "ann: addPasskey"];
    assert_eq!(of_passkeys, newest_first);
    // Removed with the person.
    added(&ann, "green").await;
    admin.delete("/users/ann").await.expect_ok();
}
