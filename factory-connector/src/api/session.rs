//! Sign-in and sign-out.

use axum::{Json, extract::State, http::StatusCode};
use axum_extra::extract::CookieJar;
use daemon::web::{
    ApiJson, Problem,
    session::{self, Caller, SignIn, SignedIn},
};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    accounts::Principal,
    context::Api,
    problems::{AttemptProblems, Problems},
    roles::Viewer,
};
use crate::store::Role;

/// Session of a person.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Session {
    user_name: String,
    role: Role,
    /// Value of the header `x-csrf-token` that changes need.
    csrf_token: String,
}

impl From<SignedIn<Principal>> for Session {
    fn from(user: SignedIn<Principal>) -> Self {
        Self {
            user_name: user.principal.user_name,
            role: user.principal.role,
            csrf_token: user.csrf_token,
        }
    }
}

/// Signs in; the answer sets the session's cookie.
#[utoipa::path(
    post,
    path = "/session",
    tag = "session",
    request_body = SignIn,
    responses((status = 200, body = Session), AttemptProblems)
)]
pub async fn sign_in(
    State(api): State<Api>,
    caller: Caller,
    ApiJson(body): ApiJson<SignIn>,
) -> Result<(CookieJar, Json<Session>), Problem> {
    let (cookie, user) = session::sign_in(&api.sessions, &caller, &body).await?;
    Ok((caller.cookies.add(cookie), Json(user.into())))
}

/// Shows the session of the caller.
#[utoipa::path(
    get,
    path = "/session",
    tag = "session",
    responses((status = 200, body = Session), Problems)
)]
pub async fn show_session(user: Viewer) -> Json<Session> {
    Json(user.into_session().into())
}

/// Signs out.
#[utoipa::path(
    delete,
    path = "/session",
    tag = "session",
    responses((status = 204, description = "Signed out"), Problems)
)]
pub async fn sign_out(
    user: Viewer,
    State(api): State<Api>,
    jar: CookieJar,
) -> Result<(CookieJar, StatusCode), Problem> {
    let removal = api.sessions.sign_out(&user).await?;
    Ok((jar.add(removal), StatusCode::NO_CONTENT))
}
