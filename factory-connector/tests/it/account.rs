//! A person's own account: password and second factor.

use reqwest::Method;
use serde_json::{Value, json};
use testkit::{SecurityKey, authenticator::code};

use crate::plant::{PAGES, Plant, SignedIn};

const PASSWORD: &str = "otto at machine 7";

/// Calls with a document; returns status and answer.
async fn call(person: &SignedIn, method: Method, path: &str, body: Value) -> (u16, Value) {
    let (status, answer) = person.call(method, path, Some(body.to_string())).await;
    (status.as_u16(), serde_json::from_str(&answer).unwrap_or_default())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn people_change_their_password_and_use_a_second_factor() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    plant.put("/users/otto", json!({ "role": "OPERATOR", "password": PASSWORD })).await;
    let otto = plant.signed_in("otto", PASSWORD).await.expect("otto may come in");
    let elsewhere = plant.signed_in("otto", PASSWORD).await.expect("otto may come in");
    let new_password = "otto's own secret";
    let change = json!({ "presentPassword": PASSWORD, "newPassword": new_password });
    assert_eq!(call(&otto, Method::PUT, "/session/password", change).await.0, 204);
    assert_eq!(elsewhere.call(Method::GET, "/session", None).await.0, 401);
    assert_eq!(otto.call(Method::GET, "/session", None).await.0, 200);
    assert!(plant.signed_in("otto", PASSWORD).await.is_err());

    let path = "/session/second-factor";
    let (_, offer) = call(&otto, Method::POST, path, json!({ "password": new_password })).await;
    let secret = offer["secret"].as_str().expect("a secret");
    let (_, codes) = call(&otto, Method::PUT, path, json!({ "code": code(secret, 0) })).await;
    let recovery = codes["recoveryCodes"][0].as_str().expect("a code");
    let sign_in = async |code: &str| {
        let body = json!({ "userName": "otto", "password": new_password, "code": code });
        call(&plant.signed_out(), Method::POST, "/session", body).await.0
    };
    let needed = plant.signed_in("otto", new_password).await.err().expect("a code is needed");
    assert!(needed.contains("SECOND_FACTOR_NEEDED"), "{needed}");
    let next = code(secret, 1);
    assert_eq!([sign_in(&next).await, sign_in(&next).await], [200, 401], "a code is good once");
    assert_eq!([sign_in(recovery).await, sign_in(recovery).await], [200, 401]);

    let reset = plant.call(Method::DELETE, "/users/otto/second-factor", None).await;
    assert_eq!(reset.0, 204, "an engineer helps");
    plant.signed_in("otto", new_password).await.expect("the password is enough");
    let sessions = plant.get("/users/otto/sessions").await;
    let id = sessions["items"][0]["sessionId"].as_str().expect("an id");
    let path = format!("/users/otto/sessions/{id}");
    assert_eq!(plant.call(Method::DELETE, &path, None).await.0, 204);
    let left = plant.get("/users/otto/sessions").await["items"].as_array().map(Vec::len);
    assert_eq!(left.map(|left| left + 1), sessions["items"].as_array().map(Vec::len));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn people_sign_in_by_a_passkey_until_it_is_removed() {
    let plant = Plant::start(json!([{ "name": "progressStatus", "type": 9 }])).await;
    plant.put("/users/otto", json!({ "role": "OPERATOR", "password": PASSWORD })).await;
    let otto = plant.signed_in("otto", PASSWORD).await.expect("otto may come in");
    let path = "/session/passkeys";
    let add = async |name: &str| {
        let mut key = SecurityKey::new(name, PAGES);
        let (_, offer) = call(&otto, Method::POST, path, json!({ "password": PASSWORD })).await;
        let body = json!({ "name": name, "credential": key.create(&offer["options"]) });
        let (status, codes) = call(&otto, Method::PUT, path, body).await;
        assert_eq!(status, 200, "{codes}");
        (key, codes["recoveryCodes"][0].clone())
    };
    let attempt = async |members: Value| {
        let mut body = json!({ "userName": "otto", "password": PASSWORD });
        body.as_object_mut()
            .expect("members")
            .extend(members.as_object().expect("members").clone());
        call(&plant.signed_out(), Method::POST, "/session", body).await
    };
    let by_key = async |key: &mut SecurityKey| {
        let (_, needed) = attempt(json!({})).await;
        let passkey = key.get(&needed["secondFactor"]["passkeyOptions"]);
        attempt(json!({ "passkey": passkey })).await.0
    };
    let (mut blue, recovery) = add("blue").await;
    let (mut red, none) = add("red").await;
    assert_eq!(none, Value::Null, "recovery codes are there");
    assert_eq!([by_key(&mut blue).await, by_key(&mut red).await], [200, 200]);
    blue.counter = 0;
    assert_eq!(by_key(&mut blue).await, 401, "a copy of the key");
    assert_eq!(attempt(json!({ "code": recovery })).await.0, 200);

    let list = otto.get(path).await["items"].clone();
    assert!(list[0]["lastUsedAt"].is_string(), "{list}");
    let removal = format!("{path}/{}/removal", list[0]["passkeyId"].as_str().expect("an id"));
    let body = json!({ "password": PASSWORD });
    assert_eq!(call(&otto, Method::POST, &removal, body.clone()).await.0, 204);
    assert_eq!(call(&otto, Method::POST, &removal, body).await.0, 404);
    blue.counter = 50;
    assert_eq!(by_key(&mut blue).await, 401, "removed");
    let reset = plant.call(Method::DELETE, "/users/otto/second-factor", None).await;
    assert_eq!(reset.0, 204, "an engineer helps");
    assert_eq!(attempt(json!({})).await.0, 200, "the password is enough");
}
