//! One's own account: password, sessions and second factor; and those of others, for engineers.

use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{
    ApiJson, ApiPath, Problem,
    session::{
        AccountChange, Caller, PasswordChange, RecoveryCodes, SecondFactorBegin, SecondFactorCode,
        SecondFactorOffer, SecondFactorRemoval, SecondFactorState,
    },
};

use super::{
    context::Api,
    person_sessions::{self, PersonSession},
    problems::{AttemptProblems, Problems},
    roles::{Engineer, Viewer},
    view::Page,
};

/// Changes the own password; the person's other sessions end.
#[utoipa::path(
    put,
    path = "/session/password",
    tag = "session",
    request_body = PasswordChange,
    responses((status = 204, description = "Changed"), AttemptProblems)
)]
pub async fn change_password(
    user: Viewer,
    State(api): State<Api>,
    caller: Caller,
    ApiJson(body): ApiJson<PasswordChange>,
) -> Result<StatusCode, Problem> {
    api.sessions.change_password(&caller, &user, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the own sessions, at the pages and at the OPC UA server.
#[utoipa::path(
    get,
    path = "/sessions",
    tag = "session",
    responses((status = 200, body = Page<PersonSession>), Problems)
)]
pub async fn list_sessions(
    user: Viewer,
    State(api): State<Api>,
) -> Result<Json<Page<PersonSession>>, Problem> {
    Ok(Json(Page::whole(person_sessions::list(&api, &user.user_name, &user.session).await?)))
}

/// Ends one of the own sessions.
#[utoipa::path(
    delete,
    path = "/sessions/{sessionId}",
    tag = "session",
    params(("sessionId" = String, Path)),
    responses((status = 204, description = "Ended"), Problems)
)]
pub async fn end_session(
    user: Viewer,
    State(api): State<Api>,
    ApiPath(session_id): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let change = AccountChange { by: &user.user_name, operation: "endSession" };
    person_sessions::end(&api, &user.user_name, &session_id, change).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the sessions of a person, at the pages and at the OPC UA server.
#[utoipa::path(
    get,
    path = "/users/{userName}/sessions",
    tag = "users",
    params(("userName" = String, Path)),
    responses((status = 200, body = Page<PersonSession>), Problems)
)]
pub async fn list_user_sessions(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(user_name): ApiPath<String>,
) -> Result<Json<Page<PersonSession>>, Problem> {
    Ok(Json(Page::whole(person_sessions::list(&api, &user_name, &user.session).await?)))
}

/// Ends a session of a person.
#[utoipa::path(
    delete,
    path = "/users/{userName}/sessions/{sessionId}",
    tag = "users",
    params(("userName" = String, Path), ("sessionId" = String, Path)),
    responses((status = 204, description = "Ended"), Problems)
)]
pub async fn end_user_session(
    user: Engineer,
    State(api): State<Api>,
    ApiPath((user_name, session_id)): ApiPath<(String, String)>,
) -> Result<StatusCode, Problem> {
    let change = AccountChange { by: &user.user_name, operation: "endUserSession" };
    person_sessions::end(&api, &user_name, &session_id, change).await?;
    tracing::info!(user.name = user_name, by = user.user_name, "A session was ended.");
    Ok(StatusCode::NO_CONTENT)
}

/// Says whether signing in takes a code.
#[utoipa::path(
    get,
    path = "/session/second-factor",
    tag = "session",
    responses((status = 200, body = SecondFactorState), Problems)
)]
pub async fn show_second_factor(
    user: Viewer,
    State(api): State<Api>,
) -> Result<Json<SecondFactorState>, Problem> {
    Ok(Json(api.sessions.second_factor_state(&user.user_name).await?))
}

/// Makes a secret for an authenticator app, which counts once it is confirmed.
#[utoipa::path(
    post,
    path = "/session/second-factor",
    tag = "session",
    request_body = SecondFactorBegin,
    responses((status = 200, body = SecondFactorOffer), AttemptProblems)
)]
pub async fn begin_second_factor(
    user: Viewer,
    State(api): State<Api>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorBegin>,
) -> Result<Json<SecondFactorOffer>, Problem> {
    Ok(Json(api.sessions.begin_second_factor(&caller, &user, body).await?))
}

/// Turns the second factor on with a code of the app; the answer has the recovery codes.
#[utoipa::path(
    put,
    path = "/session/second-factor",
    tag = "session",
    request_body = SecondFactorCode,
    responses((status = 200, body = RecoveryCodes), Problems)
)]
pub async fn confirm_second_factor(
    user: Viewer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<SecondFactorCode>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(api.sessions.confirm_second_factor(&user, &body).await?))
}

/// Turns the own second factor off.
#[utoipa::path(
    post,
    path = "/session/second-factor/removal",
    tag = "session",
    request_body = SecondFactorRemoval,
    responses((status = 204, description = "Removed"), AttemptProblems)
)]
pub async fn remove_second_factor(
    user: Viewer,
    State(api): State<Api>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorRemoval>,
) -> Result<StatusCode, Problem> {
    api.sessions.remove_second_factor(&caller, &user, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Removes the second factor of a person who has lost it, passkeys included.
#[utoipa::path(
    delete,
    path = "/users/{userName}/second-factor",
    tag = "users",
    params(("userName" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn reset_second_factor(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(user_name): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let change = AccountChange { by: &user.user_name, operation: "resetSecondFactor" };
    if !api.sessions.reset_second_factor(&user_name, change).await? {
        return Err(Problem::not_found("second factor of this person"));
    }
    tracing::info!(user.name = user_name, by = user.user_name, "A second factor was reset.");
    Ok(StatusCode::NO_CONTENT)
}
