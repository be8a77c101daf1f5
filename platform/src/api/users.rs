//! Users.

use asi_model::OrganisationId;
use axum::{Json, extract::State};
use daemon::{
    Confidential,
    web::{ApiJson, ApiPath, Problem, session::SignedIn},
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    administrator_only,
    problems::{ChangeProblems, unknown_reference},
};
use crate::{
    administrator,
    application::Application,
    principal::Principal,
    store::{Role, User},
};

/// User to add or replace.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PutUser {
    #[schema(value_type = String, format = Password)]
    password: Confidential<String>,
    role: Role,
    /// Organisation for which the user looks and acts.
    organisation_id: Option<OrganisationId>,
}

/// Account of a person, without the password.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct UserView {
    user_name: String,
    role: Role,
    organisation_id: Option<OrganisationId>,
}

/// Adds or replaces a user; the user's sessions end.
#[utoipa::path(put, operation_id = "putUser", path = "/users/{userName}", tag = "users", security(("session" = [])),
    params(("userName" = String, Path, description = "The name to sign in with")), request_body = PutUser,
    responses((status = 200, body = UserView), ChangeProblems))]
pub async fn put(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(user_name): ApiPath<String>,
    ApiJson(body): ApiJson<PutUser>,
) -> Result<Json<UserView>, Problem> {
    administrator_only::check(&who)?;
    if let Some(id) = &body.organisation_id
        && !app.store.read().await?.organisations().exists(id).await?
    {
        return Err(unknown_reference("/organisationId", "such organisation"));
    }
    let user = User { user_name, role: body.role, organisation_id: body.organisation_id };
    let hashing = app.sessions.hashing();
    administrator::put(&app.store, &user, body.password, hashing, app.clock.now()).await?;
    Ok(Json(UserView {
        user_name: user.user_name,
        role: user.role,
        organisation_id: user.organisation_id,
    }))
}
