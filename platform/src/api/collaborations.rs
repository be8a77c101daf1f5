//! Collaborations.

use asi_model::{CollaborationId, FactoryId, OrganisationId};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};
use serde::Deserialize;
use utoipa::ToSchema;

use super::{
    administrator_only,
    page::Page,
    problems::{ChangeProblems, ReadProblems, taken, unknown_reference},
};
use crate::{
    application::Application,
    principal::Principal,
    store::{
        AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Collaboration, Factory, Scope, Work,
    },
};

/// A collaboration to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewCollaboration {
    collaboration_id: CollaborationId,
    name: String,
    /// The organisations that take part.
    #[serde(default)]
    members: Vec<OrganisationId>,
    /// The factories that take part.
    #[serde(default)]
    factories: Vec<FactoryId>,
}

/// Lists the collaborations of the viewer's organisation; administrators see all.
#[utoipa::path(get, operation_id = "listCollaborations", path = "/collaborations", tag = "collaborations", security(("session" = [])),
    responses((status = 200, body = Page<Collaboration>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<Collaboration>>, Problem> {
    Ok(Json(Page::whole(
        app.store.read().await?.collaborations().list(&who.principal.scope()).await?,
    )))
}

/// Adds a collaboration.
#[utoipa::path(post, operation_id = "addCollaboration", path = "/collaborations", tag = "collaborations", security(("session" = [])),
    request_body = NewCollaboration, responses((status = 201, body = Collaboration), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(new): ApiJson<NewCollaboration>,
) -> Result<(StatusCode, Json<Collaboration>), Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "addCollaboration").await?;
    for (index, member) in new.members.iter().enumerate() {
        check_member(&mut work, member, &format!("/members/{index}")).await?;
    }
    for (index, factory) in new.factories.iter().enumerate() {
        check_factory(&mut work, factory, &format!("/factories/{index}")).await?;
    }
    let collaboration = Collaboration {
        collaboration_id: new.collaboration_id,
        name: new.name,
        created_at: app.clock.now(),
        members: new.members,
        factories: new.factories,
    };
    if !work.collaborations().add(&collaboration).await? {
        return Err(taken("collaboration"));
    }
    let member = |id| AuditFact::new(AuditFactKind::Member, id);
    work.describe(collaboration.members.iter().map(member));
    let factory = |id| AuditFact::new(AuditFactKind::Factory, id);
    work.describe(collaboration.factories.iter().map(factory));
    let path = format!("collaborations/{}", collaboration.collaboration_id);
    work.commit(AuditSubject::shared(path), AuditOutcome::Done).await?;
    Ok((StatusCode::CREATED, Json(collaboration)))
}

/// Adds a member; has no effect if it is one.
#[utoipa::path(put, operation_id = "addMember", path = "/collaborations/{collaborationId}/members/{organisationId}", tag = "collaborations",
    security(("session" = [])), params(("collaborationId" = String, Path), ("organisationId" = String, Path)),
    responses((status = 200, body = Collaboration), ChangeProblems))]
pub async fn add_member(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((id, member)): ApiPath<(CollaborationId, OrganisationId)>,
) -> Result<Json<Collaboration>, Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "addMember").await?;
    let before = lookup(&mut work, &id).await?;
    check_member(&mut work, &member, "").await?;
    work.collaborations().add_member(&id, &member).await?;
    let collaboration = lookup(&mut work, &id).await?;
    let path = format!("collaborations/{id}/members/{member}");
    let outcome = AuditOutcome::of(before != collaboration);
    work.commit(AuditSubject::of(&member, path), outcome).await?;
    Ok(Json(collaboration))
}

/// Adds a factory; has no effect if it takes part.
#[utoipa::path(put, operation_id = "addCollaborationFactory", path = "/collaborations/{collaborationId}/factories/{factoryId}", tag = "collaborations",
    security(("session" = [])), params(("collaborationId" = String, Path), ("factoryId" = String, Path)),
    responses((status = 200, body = Collaboration), ChangeProblems))]
pub async fn add_factory(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath((id, factory)): ApiPath<(CollaborationId, FactoryId)>,
) -> Result<Json<Collaboration>, Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "addCollaborationFactory").await?;
    let before = lookup(&mut work, &id).await?;
    let known = check_factory(&mut work, &factory, "").await?;
    work.collaborations().add_factory(&id, &factory).await?;
    let collaboration = lookup(&mut work, &id).await?;
    let path = format!("collaborations/{id}/factories/{factory}");
    let outcome = AuditOutcome::of(before != collaboration);
    work.commit(AuditSubject::of(&known.organisation_id, path), outcome).await?;
    Ok(Json(collaboration))
}

async fn lookup(work: &mut Work, id: &CollaborationId) -> Result<Collaboration, Problem> {
    let found = work.collaborations().lookup(&Scope::Platform, id).await?;
    found.ok_or_else(|| Problem::not_found(format_args!("collaboration {id}")))
}

async fn check_member(work: &mut Work, id: &OrganisationId, pointer: &str) -> Result<(), Problem> {
    if work.organisations().exists(id).await? {
        Ok(())
    } else {
        Err(unknown_reference(pointer, &format!("organisation {id}")))
    }
}

async fn check_factory(work: &mut Work, id: &FactoryId, pointer: &str) -> Result<Factory, Problem> {
    let known = work.factories().lookup(&Scope::Platform, id).await?;
    known.ok_or_else(|| unknown_reference(pointer, &format!("factory {id}")))
}
