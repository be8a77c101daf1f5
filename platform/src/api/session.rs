//! Signing in and out.

use asi_model::OrganisationId;
use axum::{Json, extract::State, http::StatusCode};
use axum_extra::extract::CookieJar;
use daemon::web::{
    ApiJson, Problem,
    session::{self, Caller, SignIn, SignedIn},
};
use serde::Serialize;
use utoipa::ToSchema;

use super::problems::{AttemptProblems, ChangeProblems, ReadProblems};
use crate::{application::Application, principal::Principal, store::Role};

/// The signed-in user and the token of its session.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Session {
    user_name: String,
    role: Role,
    organisation_id: Option<OrganisationId>,
    /// Token that changes must carry in the header `x-csrf-token`.
    csrf_token: String,
}

impl From<SignedIn<Principal>> for Session {
    fn from(who: SignedIn<Principal>) -> Self {
        let user = who.principal.user;
        Self {
            user_name: user.user_name,
            role: user.role,
            organisation_id: user.organisation_id,
            csrf_token: who.csrf_token,
        }
    }
}

/// Signs in; the answer sets the session's cookie.
#[utoipa::path(post, operation_id = "signIn", path = "/session", tag = "session", request_body = SignIn,
    responses((status = 200, body = Session), AttemptProblems))]
pub async fn sign_in(
    State(app): State<Application>,
    caller: Caller,
    ApiJson(body): ApiJson<SignIn>,
) -> Result<(CookieJar, Json<Session>), Problem> {
    let (cookie, who) = session::sign_in(&app.sessions, &caller, &body).await?;
    Ok((caller.cookies.add(cookie), Json(who.into())))
}

/// Says who is signed in.
#[utoipa::path(get, operation_id = "showSession", path = "/session", tag = "session", security(("session" = [])),
    responses((status = 200, body = Session), ReadProblems))]
pub async fn show(who: SignedIn<Principal>) -> Json<Session> {
    Json(who.into())
}

/// Signs out.
#[utoipa::path(delete, operation_id = "signOut", path = "/session", tag = "session", security(("session" = [])),
    responses((status = 204, description = "Signed out"), ChangeProblems))]
pub async fn sign_out(
    State(app): State<Application>,
    jar: CookieJar,
    who: SignedIn<Principal>,
) -> Result<(CookieJar, StatusCode), Problem> {
    let removal = app.sessions.sign_out(&who).await?;
    Ok((jar.add(removal), StatusCode::NO_CONTENT))
}
