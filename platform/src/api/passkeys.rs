//! Passkeys of one's own account.

use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{
    ApiJson, ApiPath, Problem,
    session::{
        Caller, NewPasskey, OwnPasskeys, PasskeyBegin, PasskeyList, PasskeyOffer, PasskeyRemoval,
        RecoveryCodes, SignedIn,
    },
};

use super::problems::{AttemptProblems, ChangeProblems, ReadProblems};
use crate::{application::Application, principal::Principal};

/// Lists the own passkeys.
#[utoipa::path(get, operation_id = "listPasskeys", path = "/session/passkeys", tag = "session",
    security(("session" = [])), responses((status = 200, body = PasskeyList), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<PasskeyList>, Problem> {
    Ok(Json(OwnPasskeys::of(&app.sessions, &who.user_name).list().await?))
}

/// Makes the options with which a browser makes a passkey.
#[utoipa::path(post, operation_id = "beginPasskey", path = "/session/passkeys", tag = "session",
    security(("session" = [])), request_body = PasskeyBegin,
    responses((status = 200, body = PasskeyOffer), AttemptProblems))]
pub async fn begin(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    caller: Caller,
    ApiJson(body): ApiJson<PasskeyBegin>,
) -> Result<Json<PasskeyOffer>, Problem> {
    Ok(Json(
        OwnPasskeys::of(&app.sessions, &who.user_name).begin(&caller, &who.session, body).await?,
    ))
}

/// Adds a passkey that a browser made; the answer has recovery codes where it is the first second factor.
#[utoipa::path(put, operation_id = "addPasskey", path = "/session/passkeys", tag = "session",
    security(("session" = [])), request_body = NewPasskey,
    responses((status = 200, body = RecoveryCodes), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(body): ApiJson<NewPasskey>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(OwnPasskeys::of(&app.sessions, &who.user_name).add(&body).await?))
}

/// Removes one of the own passkeys.
#[utoipa::path(post, operation_id = "removePasskey", path = "/session/passkeys/{passkeyId}/removal",
    tag = "session", security(("session" = [])), params(("passkeyId" = String, Path)),
    request_body = PasskeyRemoval,
    responses((status = 204, description = "Removed"), AttemptProblems))]
pub async fn remove(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    caller: Caller,
    ApiPath(passkey_id): ApiPath<String>,
    ApiJson(body): ApiJson<PasskeyRemoval>,
) -> Result<StatusCode, Problem> {
    let passkeys = OwnPasskeys::of(&app.sessions, &who.user_name);
    passkeys.remove(&caller, &who.session, &passkey_id, body).await?;
    Ok(StatusCode::NO_CONTENT)
}
