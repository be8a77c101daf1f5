//! Organisations.

use asi_model::OrganisationId;
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, Problem, session::SignedIn};
use serde::Deserialize;
use utoipa::ToSchema;

use super::{
    administrator_only,
    page::Page,
    problems::{ChangeProblems, ReadProblems, taken},
};
use crate::{
    application::Application,
    principal::Principal,
    store::{AuditOutcome, AuditSubject, Organisation},
};

/// An organisation to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewOrganisation {
    organisation_id: OrganisationId,
    name: String,
}

/// Lists the organisations that the viewer shares a collaboration with; administrators see all.
#[utoipa::path(get, operation_id = "listOrganisations", path = "/organisations", tag = "organisations", security(("session" = [])),
    responses((status = 200, body = Page<Organisation>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<Organisation>>, Problem> {
    Ok(Json(Page::whole(
        app.store.read().await?.organisations().list(&who.principal.scope()).await?,
    )))
}

/// Adds an organisation.
#[utoipa::path(post, operation_id = "addOrganisation", path = "/organisations", tag = "organisations", security(("session" = [])),
    request_body = NewOrganisation, responses((status = 201, body = Organisation), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(new): ApiJson<NewOrganisation>,
) -> Result<(StatusCode, Json<Organisation>), Problem> {
    administrator_only::check(&who)?;
    let organisation = Organisation {
        organisation_id: new.organisation_id,
        name: new.name,
        created_at: app.clock.now(),
    };
    let mut work = app.store.begin(&who.principal, "addOrganisation").await?;
    if !work.organisations().add(&organisation).await? {
        return Err(taken("organisation"));
    }
    let id = &organisation.organisation_id;
    let subject = AuditSubject::of(id, format!("organisations/{id}"));
    work.commit(subject, AuditOutcome::Done).await?;
    Ok((StatusCode::CREATED, Json(organisation)))
}
