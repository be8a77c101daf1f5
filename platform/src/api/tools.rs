//! Tools of organisations.

use asi_model::{OrganisationId, ToolId};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    administrator_only,
    factories::{Revoked, revoke_holder},
    page::Page,
    problems::{ChangeProblems, ReadProblems, taken, unknown_reference},
};
use crate::{
    application::Application,
    enrolment::make_tool_credential,
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Holder, Scope, Tool, Work},
};

/// A tool to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewTool {
    tool_id: ToolId,
    organisation_id: OrganisationId,
    name: String,
}

/// Endpoint and credential of a tool, shown this once.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ToolCredential {
    /// The broker's address.
    broker_url: String,
    /// The name to sign in with.
    user_name: String,
    /// The tool's own secret.
    password: String,
    /// The authority that vouches for the broker; absent where the system's roots do.
    root_certificate_pem: Option<String>,
}

/// Lists the tools of the viewer's organisation; administrators see all.
#[utoipa::path(get, operation_id = "listTools", path = "/tools", tag = "tools", security(("session" = [])),
    responses((status = 200, body = Page<Tool>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<Tool>>, Problem> {
    Ok(Json(Page::whole(app.store.read().await?.tools().list(&who.principal.scope()).await?)))
}

/// Adds a tool; its queues are made.
#[utoipa::path(post, operation_id = "addTool", path = "/tools", tag = "tools", security(("session" = [])), request_body = NewTool,
    responses((status = 201, body = Tool), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(new): ApiJson<NewTool>,
) -> Result<(StatusCode, Json<Tool>), Problem> {
    administrator_only::check(&who)?;
    let tool = Tool {
        tool_id: new.tool_id,
        organisation_id: new.organisation_id,
        name: new.name,
        created_at: app.clock.now(),
    };
    let mut work = app.store.begin(&who.principal, "addTool").await?;
    if !work.organisations().exists(&tool.organisation_id).await? {
        return Err(unknown_reference("/organisationId", "such organisation"));
    }
    if !work.tools().add(&tool).await? {
        return Err(taken("tool"));
    }
    work.describe([AuditFact::new(AuditFactKind::Organisation, &tool.organisation_id)]);
    work.commit(subject(&tool), AuditOutcome::Done).await?;
    app.broker_access.reconcile(&app.store.reserved_reader()).await?;
    Ok((StatusCode::CREATED, Json(tool)))
}

/// Makes a credential for a tool; the newest two are alive.
#[utoipa::path(post, operation_id = "makeToolCredential", path = "/tools/{toolId}/credentials", tag = "tools", security(("session" = [])),
    params(("toolId" = String, Path)), responses((status = 201, body = ToolCredential), ChangeProblems))]
pub async fn make_credential(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(tool): ApiPath<ToolId>,
) -> Result<(StatusCode, Json<ToolCredential>), Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "makeToolCredential").await?;
    let known = lookup(&mut work, &tool).await?;
    let credential = make_tool_credential(&mut work, &app.config, tool, app.clock.now()).await?;
    work.commit(subject(&known), AuditOutcome::Done).await?;
    app.broker_access.reconcile(&app.store.reserved_reader()).await?;
    let view = ToolCredential {
        broker_url: app.broker_endpoint.url.clone(),
        user_name: credential.holder.user_name(),
        password: credential.secret.expose().clone(),
        root_certificate_pem: app.broker_endpoint.root_certificate_pem.clone(),
    };
    Ok((StatusCode::CREATED, Json(view)))
}

/// Takes all credentials of a tool away and cuts its connections.
#[utoipa::path(delete, operation_id = "revokeToolCredentials", path = "/tools/{toolId}/credentials", tag = "tools", security(("session" = [])),
    params(("toolId" = String, Path)), responses((status = 200, body = Revoked), ChangeProblems))]
pub async fn revoke(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(tool): ApiPath<ToolId>,
) -> Result<Json<Revoked>, Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "revokeToolCredentials").await?;
    let known = lookup(&mut work, &tool).await?;
    Ok(Json(revoke_holder(&app, work, Holder::Tool(tool), subject(&known)).await?))
}

async fn lookup(work: &mut Work, id: &ToolId) -> Result<Tool, Problem> {
    let known = work.tools().lookup(&Scope::Platform, id).await?;
    known.ok_or_else(|| Problem::not_found(format_args!("tool {id}")))
}

fn subject(tool: &Tool) -> AuditSubject {
    AuditSubject::of(&tool.organisation_id, format!("tools/{}", tool.tool_id))
}
