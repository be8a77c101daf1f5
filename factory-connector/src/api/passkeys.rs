//! Passkeys of one's own account.

use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{
    ApiJson, ApiPath, Problem,
    session::{
        Caller, NewPasskey, OwnPasskeys, PasskeyBegin, PasskeyList, PasskeyOffer, PasskeyRemoval,
        RecoveryCodes,
    },
};

use super::{
    context::Api,
    problems::{AttemptProblems, Problems},
    roles::Viewer,
};

/// Lists the own passkeys.
#[utoipa::path(
    get,
    path = "/session/passkeys",
    tag = "session",
    responses((status = 200, body = PasskeyList), Problems)
)]
pub async fn list_passkeys(
    user: Viewer,
    State(api): State<Api>,
) -> Result<Json<PasskeyList>, Problem> {
    Ok(Json(OwnPasskeys::of(&api.sessions, &user.user_name).list().await?))
}

/// Makes the options with which a browser makes a passkey.
#[utoipa::path(
    post,
    path = "/session/passkeys",
    tag = "session",
    request_body = PasskeyBegin,
    responses((status = 200, body = PasskeyOffer), AttemptProblems)
)]
pub async fn begin_passkey(
    user: Viewer,
    State(api): State<Api>,
    caller: Caller,
    ApiJson(body): ApiJson<PasskeyBegin>,
) -> Result<Json<PasskeyOffer>, Problem> {
    Ok(Json(
        OwnPasskeys::of(&api.sessions, &user.user_name).begin(&caller, &user.session, body).await?,
    ))
}

/// Adds a passkey that a browser made; the answer has recovery codes where it is the first second factor.
#[utoipa::path(
    put,
    path = "/session/passkeys",
    tag = "session",
    request_body = NewPasskey,
    responses((status = 200, body = RecoveryCodes), Problems)
)]
pub async fn add_passkey(
    user: Viewer,
    State(api): State<Api>,
    ApiJson(body): ApiJson<NewPasskey>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(OwnPasskeys::of(&api.sessions, &user.user_name).add(&body).await?))
}

/// Removes one of the own passkeys.
#[utoipa::path(
    post,
    path = "/session/passkeys/{passkeyId}/removal",
    tag = "session",
    params(("passkeyId" = String, Path)),
    request_body = PasskeyRemoval,
    responses((status = 204, description = "Removed"), AttemptProblems)
)]
pub async fn remove_passkey(
    user: Viewer,
    State(api): State<Api>,
    caller: Caller,
    ApiPath(passkey_id): ApiPath<String>,
    ApiJson(body): ApiJson<PasskeyRemoval>,
) -> Result<StatusCode, Problem> {
    let passkeys = OwnPasskeys::of(&api.sessions, &user.user_name);
    passkeys.remove(&caller, &user.session, &passkey_id, body).await?;
    Ok(StatusCode::NO_CONTENT)
}
