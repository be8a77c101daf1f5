//! Factories and their enrolment.

use std::time::Duration;

use asi_model::{DateTime, FactoryId, OrganisationId};
use axum::{Json, extract::State, http::StatusCode};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    administrator_only,
    page::Page,
    problems::{ChangeProblems, ReadProblems, taken, unknown_reference},
};
use crate::{
    application::Application,
    audit::RecordedWork,
    enrolment::make_token as make,
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Factory, Holder, Scope, Work},
};

/// A factory to add.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct NewFactory {
    factory_id: FactoryId,
    organisation_id: OrganisationId,
    /// Name for people; the id by default.
    #[serde(default)]
    name: Option<String>,
}

/// A token to enrol with, shown this once.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct TokenView {
    /// Token for `factory-connector enrol`; contains the platform's address.
    token: String,
    /// End of its validity.
    expires_at: DateTime,
    /// True where it names the certificate that the platform shows: then the connector enrols with nobody else.
    is_pinned: bool,
}

/// Result of a revocation.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Revoked {
    /// Credentials taken away.
    credentials: u64,
    /// Connections that were cut.
    connections: usize,
    /// Account at a broker of another make, which only its administrator can remove. Nothing of it counts and nothing
    /// is sent to it, but what waits there it can still read. Absent where the platform's own broker has cut it off.
    #[serde(skip_serializing_if = "Option::is_none")]
    broker_account: Option<String>,
}

/// Lists the factories of the viewer's organisation and of its collaborations; administrators see
/// all.
#[utoipa::path(get, operation_id = "listFactories", path = "/factories", tag = "factories", security(("session" = [])),
    responses((status = 200, body = Page<Factory>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
) -> Result<Json<Page<Factory>>, Problem> {
    Ok(Json(Page::whole(app.store.read().await?.factories().list(&who.principal.scope()).await?)))
}

/// Adds a factory; its queues are made.
#[utoipa::path(post, operation_id = "addFactory", path = "/factories", tag = "factories", security(("session" = [])), request_body = NewFactory,
    responses((status = 201, body = Factory), ChangeProblems))]
pub async fn add(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiJson(new): ApiJson<NewFactory>,
) -> Result<(StatusCode, Json<Factory>), Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "addFactory").await?;
    if !work.organisations().exists(&new.organisation_id).await? {
        return Err(unknown_reference("/organisationId", "such organisation"));
    }
    let name =
        new.name.as_deref().filter(|name| !name.is_empty()).unwrap_or(new.factory_id.as_str());
    if !work.factories().add(&new.factory_id, &new.organisation_id, name, app.clock.now()).await? {
        return Err(taken("factory"));
    }
    let factory = work.factories().lookup(&Scope::Platform, &new.factory_id).await?;
    let factory = factory.ok_or_else(|| Problem::not_found("factory"))?;
    work.describe([AuditFact::new(AuditFactKind::Organisation, &factory.organisation_id)]);
    work.commit(subject(&factory), AuditOutcome::Done).await?;
    app.broker_access.reconcile(&app.store.reserved_reader()).await?;
    Ok((StatusCode::CREATED, Json(factory)))
}

/// Makes a single-use token with which the factory's connector enrols.
#[utoipa::path(post, operation_id = "makeEnrolmentToken", path = "/factories/{factoryId}/enrolment-tokens", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path)), responses((status = 201, body = TokenView), ChangeProblems))]
pub async fn make_token(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(factory): ApiPath<FactoryId>,
) -> Result<(StatusCode, Json<TokenView>), Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "makeEnrolmentToken").await?;
    let known = lookup(&mut work, &factory).await?;
    let lifetime =
        Duration::from_secs(u64::from(app.config.retention.enrolment_token_hours) * 3600);
    let made = make(&mut work, &factory, &app.enrolment_address, app.clock.now(), lifetime).await?;
    work.commit(subject(&known), AuditOutcome::Done).await?;
    let (token, expires_at) = (made.token.expose().clone(), made.expires_at);
    Ok((StatusCode::CREATED, Json(TokenView { token, expires_at, is_pinned: made.is_pinned })))
}

/// Takes credentials and signing keys of the factory's connector away and cuts its connections.
#[utoipa::path(delete, operation_id = "revokeFactoryCredentials", path = "/factories/{factoryId}/credentials", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path)), responses((status = 200, body = Revoked), ChangeProblems))]
pub async fn revoke(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(factory): ApiPath<FactoryId>,
) -> Result<Json<Revoked>, Problem> {
    administrator_only::check(&who)?;
    let mut work = app.store.begin(&who.principal, "revokeFactoryCredentials").await?;
    let known = lookup(&mut work, &factory).await?;
    work.signing_keys().forget(&factory).await?;
    Ok(Json(revoke_holder(&app, work, Holder::Factory(factory), subject(&known)).await?))
}

async fn lookup(work: &mut Work, id: &FactoryId) -> Result<Factory, Problem> {
    let known = work.factories().lookup(&Scope::Platform, id).await?;
    known.ok_or_else(|| Problem::not_found(format_args!("factory {id}")))
}

fn subject(factory: &Factory) -> AuditSubject {
    let path = format!("factories/{}", factory.factory_id);
    AuditSubject::of(&factory.organisation_id, path)
}

/// Takes a holder's credentials away and cuts its connections.
pub async fn revoke_holder(
    app: &Application,
    mut work: RecordedWork,
    holder: Holder,
    subject: AuditSubject,
) -> Result<Revoked, Problem> {
    let credentials = work.credentials().revoke(&holder, app.clock.now()).await?;
    let broker_account = app.config.broker.external.is_some().then(|| holder.user_name());
    let is_changed = credentials > 0 || broker_account.is_some();
    work.describe([AuditFact::ended(AuditFactKind::Credentials, credentials)]);
    work.commit(subject, AuditOutcome::of(is_changed)).await?;
    let connections = app.broker_access.revoked(&app.store.reserved_reader(), &holder).await?;
    tracing::info!(holder = %holder, credentials, connections, "Credentials were revoked.");
    if let Some(account) = &broker_account {
        tracing::warn!(account, "The account is still alive at the broker: remove it there.");
    }
    Ok(Revoked { credentials, connections, broker_account })
}
