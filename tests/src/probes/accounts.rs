//! Accounts and sessions of people: those who left, those who sit at the open session of another, and browsers that collect
//! sessions.

use anyhow::Context as _;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::{
    frame_order::MAKER,
    harness::{Api, ApiError},
};

const PASSWORD: &str = "a first password";
const NEW_PASSWORD: &str = "another password";
/// Sessions of one person, at most.
const SESSIONS_MAX: usize = 32;
/// Browsers that sign one person in.
const BROWSERS: usize = 40;

/// Adds a person who may do the least, at a platform or at a connector.
async fn add(administrator: &Api, name: &str, role: &Value) -> anyhow::Result<()> {
    let mut body = role.clone();
    body["password"] = json!(PASSWORD);
    administrator.put::<Value>(&format!("/api/v1/users/{name}"), &body).await.map(drop)
}

/// Returns the role of a planner at the platform.
pub(super) fn planner() -> Value {
    json!({ "role": "PLANNER", "organisationId": MAKER })
}

/// Returns the role of a viewer at a connector.
pub(super) fn viewer() -> Value {
    json!({ "role": "VIEWER" })
}

/// Returns the role of an engineer at a connector.
pub(super) fn engineer() -> Value {
    json!({ "role": "ENGINEER" })
}

/// Adds a person, and signs in.
pub(super) async fn person(administrator: &Api, name: &str, role: &Value) -> anyhow::Result<Api> {
    add(administrator, name, role).await?;
    signed_in(administrator, name, PASSWORD).await
}

async fn signed_in(at: &Api, name: &str, password: &str) -> anyhow::Result<Api> {
    let mut api = Api::new(at.base())?;
    api.sign_in(name, password).await?;
    Ok(api)
}

/// Returns the status of an error, or that of success.
fn status<T>(answer: &anyhow::Result<T>) -> StatusCode {
    let Err(error) = answer else { return StatusCode::OK };
    let of_problem = error.downcast_ref::<ApiError>().map(|error| error.status);
    of_problem.unwrap_or(StatusCode::IM_A_TEAPOT)
}

/// Fails unless a session has ended.
async fn has_ended(api: &Api, whose: &str) -> anyhow::Result<()> {
    let status = status(&api.get::<Value>("/api/v1/status").await);
    anyhow::ensure!(status == StatusCode::UNAUTHORIZED, "{whose} session is answered {status}");
    Ok(())
}

/// A person leaves: the open session ends, the password is no way in, and the record says who took the person out.
pub(super) async fn leaver(administrator: Api) -> anyhow::Result<String> {
    const NAME: &str = "probe-leaver";
    let leaver = person(&administrator, NAME, &planner()).await?;
    let _: Value = leaver.get("/api/v1/status").await?;
    let path = format!("/api/v1/users/{NAME}");
    let _: Value = administrator.delete(&path).await?;
    has_ended(&leaver, "the leaver's").await?;
    let again = signed_in(&administrator, NAME, PASSWORD).await.map(drop);
    anyhow::ensure!(again.is_err(), "the leaver signs in again");
    let known: Value = administrator.get("/api/v1/users").await?;
    anyhow::ensure!(!known.to_string().contains(NAME), "the leaver is listed");
    let entries: Value = administrator.get("/api/v1/audit-entries?limit=50").await?;
    let entries = entries["items"].as_array().context("entries")?;
    let subject = format!("users/{NAME}");
    for operation in ["putUser", "removeUser"] {
        let is_named = |entry: &&Value| {
            entry["operation"] == operation
                && entry["subject"] == subject.as_str()
                && entry["agentName"].is_string()
        };
        anyhow::ensure!(entries.iter().any(|entry| is_named(&entry)), "no record of {operation}");
    }
    Ok("session and password are of no use, and the record names who did it".to_owned())
}

/// A stranger sits at another's open session: it changes no password without the present one, and ends as soon as the
/// person changes it.
pub(super) async fn open_session(administrator: Api, role: Value) -> anyhow::Result<String> {
    const NAME: &str = "probe-person";
    let person = person(&administrator, NAME, &role).await?;
    let thief = signed_in(&administrator, NAME, PASSWORD).await?;
    let path = "/api/v1/session/password";
    let body = |present: &str| json!({ "presentPassword": present, "newPassword": NEW_PASSWORD });
    let taken = thief.put::<Value>(path, &body("a guess like others")).await;
    let refused = status(&taken);
    anyhow::ensure!(refused.is_client_error(), "a password was changed without the present one");
    let _: Value = person.put(path, &body(PASSWORD)).await?;
    has_ended(&thief, "the stranger's").await?;
    let _: Value = person.get("/api/v1/status").await?;
    let former = signed_in(&administrator, NAME, PASSWORD).await.map(drop);
    anyhow::ensure!(former.is_err(), "the former password is a way in");
    signed_in(&administrator, NAME, NEW_PASSWORD).await?;
    Ok(format!("{} without the present password, and ended by a change", refused.as_u16()))
}

/// One person signs in with more browsers than sessions are kept, and with one of them again and again.
pub(super) async fn sessions(administrator: Api, role: Value) -> anyhow::Result<String> {
    const NAME: &str = "probe-collector";
    let count = |list: &Value| list["items"].as_array().map_or(0, Vec::len);
    let mut first = person(&administrator, NAME, &role).await?;
    for _ in 0..2 {
        first.sign_in(NAME, PASSWORD).await?;
    }
    let of_one: Value = first.get("/api/v1/sessions").await?;
    anyhow::ensure!(count(&of_one) == 1, "a browser has {} sessions", count(&of_one));
    let mut last = None;
    for _ in 0..BROWSERS {
        last = Some(signed_in(&administrator, NAME, PASSWORD).await?);
    }
    let of_all: Value = last.context("a browser")?.get("/api/v1/sessions").await?;
    let kept = count(&of_all);
    anyhow::ensure!(kept <= SESSIONS_MAX, "{kept} sessions are kept");
    has_ended(&first, "the oldest").await?;
    Ok(format!("one of a browser, {kept} of {} browsers", BROWSERS + 1))
}
