//! Sessions, users and the configuration.

use reqwest::Method;
use serde_json::json;

use super::Answers;
use crate::plant::PASSWORD;

pub async fn sign_in(answers: &mut Answers<'_>) {
    let body = json!({ "userName": "engineer", "password": PASSWORD }).to_string();
    let answer = answers.plant.signed_out().call(Method::POST, "/session", Some(body)).await;
    answers.check("signIn", answer);
    answers.get("showSession", "/session").await;
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
