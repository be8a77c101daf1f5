//! Removals of people, tools, factories, organisations, collaborations and members: by administrators, by people of their own accounts,
//! and by planners of what is their organisation's.

use asi_model::{CollaborationId, FactoryId, OrganisationId, ToolId};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem, session::SignedIn};
use serde::Deserialize;
use utoipa::IntoParams;

use super::problems::ChangeProblems;
use crate::{
    application::Application,
    leaving,
    principal::Principal,
    store::{AuditOutcome, Leaver, RemovalEffects},
};

/// Things in force that a refusal names.
const NAMED_MAX: usize = 5;

/// Choice between a removal and its preview.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct RemovalQuery {
    /// True where the answer shall only say what would end and what is in force.
    #[serde(default, rename = "dryRun")]
    #[param(required = false)]
    dry_run: bool,
}

/// Removes a person: the sessions end. The last administrator stays. People end their own accounts within ten minutes
/// of a sign-in.
#[utoipa::path(delete, operation_id = "removeUser", path = "/users/{userName}", tag = "users", security(("session" = [])),
    params(("userName" = String, Path), RemovalQuery), responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn user(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(name): ApiPath<String>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeUser", Leaver::User(name), &query).await
}

/// Removes a tool: credentials and connections end, and it gets no more reports. Planners remove tools of their
/// organisation within ten minutes of a sign-in.
#[utoipa::path(delete, operation_id = "removeTool", path = "/tools/{toolId}", tag = "tools", security(("session" = [])),
    params(("toolId" = String, Path), RemovalQuery), responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn tool(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<ToolId>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeTool", Leaver::Tool(id), &query).await
}

/// Removes a factory that is in no collaboration any more: credentials, tokens and connections end. Planners remove
/// factories of their organisation within ten minutes of a sign-in.
#[utoipa::path(delete, operation_id = "removeFactory", path = "/factories/{factoryId}", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path), RemovalQuery), responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn factory(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeFactory", Leaver::Factory(id), &query).await
}

/// Removes an organisation of which nothing is left in force, with its people.
#[utoipa::path(delete, operation_id = "removeOrganisation", path = "/organisations/{organisationId}", tag = "organisations", security(("session" = [])),
    params(("organisationId" = String, Path), RemovalQuery), responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn organisation(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OrganisationId>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeOrganisation", Leaver::Organisation(id), &query).await
}

/// Removes a collaboration of which every network is withdrawn: its members and factories part in it.
#[utoipa::path(delete, operation_id = "removeCollaboration", path = "/collaborations/{collaborationId}", tag = "collaborations", security(("session" = [])),
    params(("collaborationId" = String, Path), RemovalQuery), responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn collaboration(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<CollaborationId>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeCollaboration", Leaver::Collaboration(id), &query).await
}

/// Takes a member out of a collaboration in which nothing of it is in force. What was released to it stays
/// readable to it. Planners take their own organisation out within ten minutes of a sign-in.
#[utoipa::path(delete, operation_id = "removeMember", path = "/collaborations/{collaborationId}/members/{organisationId}", tag = "collaborations",
    security(("session" = [])), params(("collaborationId" = String, Path), ("organisationId" = String, Path), RemovalQuery),
    responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn member(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((of, id)): ApiPath<(CollaborationId, OrganisationId)>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    leave(&app, &who, "removeMember", Leaver::Member(of, id), &query).await
}

/// Takes a factory out of a collaboration in which it performs nothing. Planners take factories of their organisation
/// out within ten minutes of a sign-in.
#[utoipa::path(delete, operation_id = "removeCollaborationFactory", path = "/collaborations/{collaborationId}/factories/{factoryId}", tag = "collaborations",
    security(("session" = [])), params(("collaborationId" = String, Path), ("factoryId" = String, Path), RemovalQuery),
    responses((status = 200, body = RemovalEffects), ChangeProblems))]
pub async fn collaboration_factory(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((of, id)): ApiPath<(CollaborationId, FactoryId)>,
    ApiQuery(query): ApiQuery<RemovalQuery>,
) -> Result<Json<RemovalEffects>, Problem> {
    let leaver = Leaver::CollaborationFactory(of, id);
    leave(&app, &who, "removeCollaborationFactory", leaver, &query).await
}

/// Says what a removal ends, and lets it happen where nothing is in its way.
async fn leave(
    app: &Application,
    who: &SignedIn<Principal>,
    operation: &'static str,
    leaver: Leaver,
    query: &RemovalQuery,
) -> Result<Json<RemovalEffects>, Problem> {
    check(app, who, &leaver, query.dry_run).await?;
    let mut work = app.store.begin(&who.principal, operation).await?;
    let subject = work.removals().subject(&leaver).await?;
    let subject = subject.ok_or_else(|| Problem::not_found(leaver.path()))?;
    let removal = work.removals().preview(&leaver).await?;
    if query.dry_run {
        return Ok(Json(removal));
    }
    if !removal.in_force.is_empty() {
        return Err(in_force(&removal.in_force));
    }
    leaving::leave(&mut work, &leaver, &subject, &removal, app.clock.now()).await?;
    work.commit(subject, AuditOutcome::Done).await?;
    if let Leaver::Factory(id) = &leaver {
        app.ingest.forget(id);
    }
    if let Some(holder) = leaver.holder() {
        app.broker_access.revoked(&app.store.reserved_reader(), &holder).await?;
    }
    tracing::info!(
        leaver = leaver.path(),
        "A person, program, plant, organisation or collaboration has left."
    );
    Ok(Json(RemovalEffects { is_done: true, ..removal }))
}

/// Lets those pass who may let it leave. To others all is alike, whether it is there or not.
async fn check(
    app: &Application,
    who: &SignedIn<Principal>,
    leaver: &Leaver,
    is_preview: bool,
) -> Result<(), Problem> {
    let principal = &who.principal;
    let is_own_account = matches!(leaver, Leaver::User(name) if *name == principal.user.user_name);
    if principal.is_administrator() && !is_own_account {
        return Ok(());
    }
    if !is_own_account && !is_of_own_organisation(app, principal, leaver).await? {
        return Err(Problem::forbidden(
            "This needs an administrator of the platform, or a planner of the organisation whose it is. An account is \
             also ended by its person.",
        ));
    }
    if is_preview {
        return Ok(());
    }
    app.sessions
        .check_signed_in_lately(
            &who.session,
            "Your account, and what belongs to your organisation, can be removed only",
        )
        .await
}

/// Returns true for what a planner's own organisation has. Accounts and the organisation itself are of all its people.
async fn is_of_own_organisation(
    app: &Application,
    principal: &Principal,
    leaver: &Leaver,
) -> Result<bool, Problem> {
    let (Some(own), true) = (principal.organisation(), principal.may_plan()) else {
        return Ok(false);
    };
    if let Leaver::User(_) | Leaver::Organisation(_) = leaver {
        return Ok(false);
    }
    let subject = app.store.read().await?.removals().subject(leaver).await?;
    Ok(subject.is_some_and(|subject| subject.concerned.as_ref() == Some(own)))
}

/// Returns the problem of a change that would end what is in force.
pub(super) fn in_force(paths: &[String]) -> Problem {
    let named = paths.iter().take(NAMED_MAX).map(String::as_str).collect::<Vec<_>>().join(", ");
    let detail = format!("Still in force: {named}. End that first; dryRun=true lists all of it.");
    Problem::conflict("IN_FORCE", detail)
}
