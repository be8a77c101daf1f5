//! Lease of a factory's identity: show and hand over.

use asi_model::{FactoryId, InstanceId};
use axum::{Json, extract::State};
use daemon::web::{ApiJson, ApiPath, Problem, session::SignedIn};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{
    administrator_only, own_factory,
    problems::{ChangeProblems, ReadProblems},
};
use crate::{
    application::Application,
    leases::{FactoryLease, Party},
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Scope},
};

/// Lease of a factory with the connectors that were refused.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LeaseView {
    /// Counts up whenever the lease passes to another place; 0 while nobody has asked for it.
    lease_number: u64,
    /// The connector that speaks for the factory; absent while none has asked.
    holder: Option<Party>,
    /// Connectors that were refused, the last heard first.
    contenders: Vec<Party>,
}

/// The next holder of a lease.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Handover {
    /// One of the contenders.
    instance_id: InstanceId,
}

impl From<Option<FactoryLease>> for LeaseView {
    fn from(lease: Option<FactoryLease>) -> Self {
        match lease {
            Some(FactoryLease { number, holder, contenders }) => {
                Self { lease_number: number, holder: Some(holder), contenders }
            }
            None => Self { lease_number: 0, holder: None, contenders: Vec::new() },
        }
    }
}

/// Shows who speaks for a factory and who else asked to: for its own organisation and
/// administrators.
#[utoipa::path(get, operation_id = "showLease", path = "/factories/{factoryId}/lease", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path)), responses((status = 200, body = LeaseView), ReadProblems))]
pub async fn show(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
) -> Result<Json<LeaseView>, Problem> {
    let mut work = app.store.read().await?;
    own_factory::check(&mut work, &who.principal, &id).await?;
    Ok(Json(work.leases().lookup(&id).await?.into()))
}

/// Gives the lease to a connector that was refused, as when the old machine is gone for good. The
/// former holder is refused from now on.
#[utoipa::path(post, operation_id = "handLeaseOver", path = "/factories/{factoryId}/lease/handovers", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path)), request_body = Handover,
    responses((status = 200, body = LeaseView), ChangeProblems))]
pub async fn hand_over(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
    ApiJson(handover): ApiJson<Handover>,
) -> Result<Json<LeaseView>, Problem> {
    administrator_only::check(&who)?;
    let now = app.clock.now();
    let mut work = app.store.begin(&who.principal, "handLeaseOver").await?;
    let factory = work.factories().lookup(&Scope::Platform, &id).await?;
    let lease = work
        .leases()
        .lookup(&id)
        .await?
        .ok_or_else(|| Problem::not_found(format_args!("lease of {id}")))?;
    let former = lease.holder.host.clone();
    let lease = lease.handed_over(&handover.instance_id, now).ok_or_else(|| {
        Problem::conflict(
            "NO_SUCH_CONTENDER",
            "No such connector was refused lately. Look again who asks for the lease.",
        )
    })?;
    work.leases().put(&id, &lease).await?;
    work.parts().send_again(&id, now).await?;
    let hosts = (Some(&former), Some(&lease.holder.host));
    work.describe(AuditFact::changed(AuditFactKind::Host, hosts.0, hosts.1));
    let concerned = factory.map(|factory| factory.organisation_id);
    let subject = AuditSubject { path: format!("factories/{id}/lease"), concerned };
    work.commit(subject, AuditOutcome::Done).await?;
    tracing::info!(factory.id = %id, host = %lease.holder.host, former, "The lease of a factory was handed over.");
    Ok(Json(Some(lease).into()))
}
