//! One's own account: password, sessions and second factor.

use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{
    ApiJson, ApiPath, Problem,
    session::{
        AccountChange, Caller, PasswordChange, RecoveryCodes, SecondFactorBegin, SecondFactorCode,
        SecondFactorOffer, SecondFactorRemoval, SecondFactorState, SessionList, SignedIn,
    },
};

use super::{
    administrator_only,
    problems::{AttemptProblems, ChangeProblems, ReadProblems},
};
use crate::{application::Application, principal::Principal};

/// Changes the own password; the person's other sessions end.
#[utoipa::path(put, operation_id = "changePassword", path = "/session/password", tag = "session",
    security(("session" = [])), request_body = PasswordChange,
    responses((status = 204, description = "Changed"), AttemptProblems))]
pub async fn change_password(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    caller: Caller,
    ApiJson(body): ApiJson<PasswordChange>,
) -> Result<StatusCode, Problem> {
    app.sessions.change_password(&caller, &who, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the own sessions.
#[utoipa::path(get, operation_id = "listSessions", path = "/sessions", tag = "session",
    security(("session" = [])), responses((status = 200, body = SessionList), ReadProblems))]
pub async fn list_sessions(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<SessionList>, Problem> {
    Ok(Json(app.sessions.list(&who.user_name, &who.session).await?))
}

/// Ends one of the own sessions.
#[utoipa::path(delete, operation_id = "endSession", path = "/sessions/{sessionId}", tag = "session",
    security(("session" = [])), params(("sessionId" = String, Path)),
    responses((status = 204, description = "Ended"), ChangeProblems))]
pub async fn end_session(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(session_id): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let change = AccountChange { by: &who.user_name, operation: "endSession" };
    app.sessions.end(&who.user_name, &session_id, change).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Lists the sessions of a person.
#[utoipa::path(get, operation_id = "listUserSessions", path = "/users/{userName}/sessions", tag = "users",
    security(("session" = [])), params(("userName" = String, Path)),
    responses((status = 200, body = SessionList), ReadProblems))]
pub async fn list_user_sessions(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(user_name): ApiPath<String>,
) -> Result<Json<SessionList>, Problem> {
    administrator_only::check(&who)?;
    Ok(Json(app.sessions.list(&user_name, &who.session).await?))
}

/// Ends a session of a person.
#[utoipa::path(delete, operation_id = "endUserSession", path = "/users/{userName}/sessions/{sessionId}",
    tag = "users", security(("session" = [])), params(("userName" = String, Path), ("sessionId" = String, Path)),
    responses((status = 204, description = "Ended"), ChangeProblems))]
pub async fn end_user_session(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((user_name, session_id)): ApiPath<(String, String)>,
) -> Result<StatusCode, Problem> {
    administrator_only::check(&who)?;
    let change = AccountChange { by: &who.user_name, operation: "endUserSession" };
    app.sessions.end(&user_name, &session_id, change).await?;
    tracing::info!(user.name = user_name, by = who.user_name, "A session was ended.");
    Ok(StatusCode::NO_CONTENT)
}

/// Says whether signing in takes a code.
#[utoipa::path(get, operation_id = "showSecondFactor", path = "/session/second-factor", tag = "session",
    security(("session" = [])), responses((status = 200, body = SecondFactorState), ReadProblems))]
pub async fn show_second_factor(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<SecondFactorState>, Problem> {
    Ok(Json(app.sessions.second_factor_state(&who.user_name).await?))
}

/// Makes a secret for an authenticator app, which counts once it is confirmed.
#[utoipa::path(post, operation_id = "beginSecondFactor", path = "/session/second-factor", tag = "session",
    security(("session" = [])), request_body = SecondFactorBegin,
    responses((status = 200, body = SecondFactorOffer), AttemptProblems))]
pub async fn begin_second_factor(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorBegin>,
) -> Result<Json<SecondFactorOffer>, Problem> {
    Ok(Json(app.sessions.begin_second_factor(&caller, &who, body).await?))
}

/// Turns the second factor on with a code of the app; the answer has the recovery codes.
#[utoipa::path(put, operation_id = "confirmSecondFactor", path = "/session/second-factor", tag = "session",
    security(("session" = [])), request_body = SecondFactorCode,
    responses((status = 200, body = RecoveryCodes), ChangeProblems))]
pub async fn confirm_second_factor(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(body): ApiJson<SecondFactorCode>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(app.sessions.confirm_second_factor(&who, &body).await?))
}

/// Turns the own second factor off.
#[utoipa::path(post, operation_id = "removeSecondFactor", path = "/session/second-factor/removal",
    tag = "session", security(("session" = [])), request_body = SecondFactorRemoval,
    responses((status = 204, description = "Removed"), AttemptProblems))]
pub async fn remove_second_factor(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorRemoval>,
) -> Result<StatusCode, Problem> {
    app.sessions.remove_second_factor(&caller, &who, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Removes the second factor of a person who has lost it, passkeys included.
#[utoipa::path(delete, operation_id = "resetSecondFactor", path = "/users/{userName}/second-factor",
    tag = "users", security(("session" = [])), params(("userName" = String, Path)),
    responses((status = 204, description = "Removed"), ChangeProblems))]
pub async fn reset_second_factor(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(user_name): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    administrator_only::check(&who)?;
    let change = AccountChange { by: &who.user_name, operation: "resetSecondFactor" };
    if !app.sessions.reset_second_factor(&user_name, change).await? {
        return Err(Problem::not_found("second factor of this person"));
    }
    tracing::info!(user.name = user_name, by = who.user_name, "A second factor was reset.");
    Ok(StatusCode::NO_CONTENT)
}
