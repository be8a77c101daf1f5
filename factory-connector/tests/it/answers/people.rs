//! Sessions, users and the configuration.

use reqwest::Method;
use serde_json::json;
use testkit::SecurityKey;

use super::Answers;
use crate::plant::{PAGES, PASSWORD, SignedIn};

pub async fn sign_in(answers: &mut Answers<'_>) {
    let body = json!({ "userName": "engineer", "password": PASSWORD }).to_string();
    let answer = answers.plant.signed_out().call(Method::POST, "/session", Some(body)).await;
    answers.check("signIn", answer);
    answers.get("showSession", "/session").await;
}

/// Everything about a person's own account.
pub async fn account(answers: &mut Answers<'_>) {
    let sign_in = async || {
        let plant = answers.plant;
        plant.signed_in("engineer", PASSWORD).await.expect("the engineer signs in")
    };
    let present = async |person: &SignedIn| {
        let sessions = person.get("/sessions").await["items"].clone();
        let present =
            sessions.as_array().into_iter().flatten().find(|one| one["isPresent"] == true);
        present.expect("a session")["sessionId"].as_str().expect("an id").to_owned()
    };
    let (there, elsewhere) = (sign_in().await, sign_in().await);
    let (there, elsewhere) = (present(&there).await, present(&elsewhere).await);
    answers.delete("endSession", &format!("/sessions/{there}")).await;
    answers.delete("endUserSession", &format!("/users/engineer/sessions/{elsewhere}")).await;
    let volatile = &["items"];
    answers.without(volatile).get("listSessions", "/sessions").await;
    answers.without(volatile).get("listUserSessions", "/users/engineer/sessions").await;
    let body = json!({ "presentPassword": PASSWORD, "newPassword": PASSWORD });
    answers.put("changePassword", "/session/password", body).await;

    let (path, password) = ("/session/passkeys", json!({ "password": PASSWORD }));
    let offer =
        answers.without(&["challenge", "id"]).post("beginPasskey", path, password.clone()).await;
    let credential = SecurityKey::new("blue", PAGES).create(&offer["options"]);
    let body = json!({ "name": "Blue key", "credential": credential });
    answers.without(&["recoveryCodes"]).put("addPasskey", path, body).await;
    let list = answers.without(&["passkeyId"]).get("listPasskeys", path).await;
    let id = list["items"][0]["passkeyId"].as_str().expect("an id").to_owned();
    answers.post("removePasskey", &format!("{path}/{id}/removal"), password).await;

    let path = "/session/second-factor";
    answers.get("showSecondFactor", path).await;
    answers
        .without(&["secret", "uri", "qrCode"])
        .post("beginSecondFactor", path, json!({ "password": PASSWORD }))
        .await;
    answers.put("confirmSecondFactor", path, json!({ "code": "no code" })).await;
    let body = json!({ "password": PASSWORD, "code": "no code" });
    answers.post("removeSecondFactor", "/session/second-factor/removal", body).await;
    answers.delete("resetSecondFactor", "/users/engineer/second-factor").await;
}

pub async fn manage(answers: &mut Answers<'_>) {
    let body = json!({ "role": "OPERATOR", "password": "otto at machine 7" });
    answers.put("putUser", "/users/otto", body).await;
    answers.get("listUsers", "/users").await;
    answers.delete("removeUser", "/users/otto").await;
    answers.get("showConfiguration", "/configuration").await;
    let state = &["version", "link", "lease", "spool", "sources"];
    answers.without(state).get("showStatus", "/status").await;
}
