//! Users.

use asi_model::OrganisationId;
use axum::{Json, extract::State};
use daemon::{
    Confidential,
    web::{
        ApiJson, ApiPath, Problem,
        session::{PasswordPolicy, SignedIn},
    },
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    administrator_only,
    page::Page,
    problems::{ChangeProblems, ReadProblems, unknown_reference},
    removals::in_force,
};
use crate::{
    administrator::{self, AdministratorError},
    application::Application,
    principal::Principal,
    store::{AuditOutcome, Leaver, Role, User},
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

impl From<User> for UserView {
    fn from(user: User) -> Self {
        let User { user_name, role, organisation_id } = user;
        Self { user_name, role, organisation_id }
    }
}

/// Lists the people with an account, by name.
#[utoipa::path(get, operation_id = "listUsers", path = "/users", tag = "users", security(("session" = [])),
    responses((status = 200, body = Page<UserView>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<UserView>>, Problem> {
    administrator_only::check(&who)?;
    let users = app.store.read().await?.users().list().await?;
    Ok(Json(Page::whole(users.into_iter().map(UserView::from).collect())))
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
    let hashing = app.sessions.hashing().hash(body.password, PasswordPolicy::default());
    let hash = hashing.await.map_err(AdministratorError::Password)?;
    let mut work = app.store.begin(&who.principal, "putUser").await?;
    if user.role != Role::Administrator {
        // In force of a person is alone that it is the last administrator, who runs the platform.
        let leaver = Leaver::User(user.user_name.clone());
        let effects = work.removals().preview(&leaver).await?;
        if !effects.in_force.is_empty() {
            return Err(in_force(&effects.in_force));
        }
    }
    administrator::put(&mut work, &user, &hash, app.clock.now()).await?;
    work.commit(administrator::subject(&user), AuditOutcome::Done).await?;
    Ok(Json(user.into()))
}
