//! Logs of a factory's ledger, countersigned by the platform: what a recipient needs to check an
//! audit file without trust in the factory.

use asi_model::{DateTime, FactoryId, OrganisationId};
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem, session::SignedIn};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    page::{Page, PageQuery},
    problems::ReadProblems,
};
use crate::{application::Application, principal::Principal, witness::WitnessedLog};

/// Log of what a factory discloses to one organisation.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerLogView {
    /// The organisation whose values the log is about.
    recipient_id: OrganisationId,
    /// Number of the log among those that replaced each other, from 1. The factory decided to replace
    /// one; its audit file says who, when and why.
    epoch: u32,
    /// Name of the log (C2SP tlog-checkpoint).
    origin: String,
    /// Number of leaves in the newest checkpoint: the entries, and one for the beginning.
    size: u64,
    /// The newest checkpoint, a C2SP signed note with the signatures of the log and of the platform.
    checkpoint: String,
    /// The key of the log, pinned with its first checkpoint: name, id and key.
    verifier_key: String,
    /// The platform's key as a witness: name, id and key.
    witness_key: String,
    /// Time of the platform's signature.
    cosigned_at: DateTime,
    /// Number of leaves in the first checkpoint that the platform saw. Unless it is 1 or 2, entries
    /// were made before the platform watched the log, or the platform has lost what it held.
    first_size: u64,
    /// Time at which it came.
    first_seen_at: DateTime,
    /// The last checkpoint that was refused: it contradicts the newest one, or has another key.
    refused_checkpoint: Option<String>,
    /// Time at which it was refused.
    refused_at: Option<DateTime>,
}

impl LedgerLogView {
    fn new(recipient_id: OrganisationId, log: WitnessedLog, witness_key: String) -> Self {
        let (refused_checkpoint, refused_at) = log.refused.unzip();
        Self {
            recipient_id,
            epoch: log.epoch,
            origin: log.verifier_key.name().to_owned(),
            size: log.head.size,
            checkpoint: log.checkpoint.to_string(),
            verifier_key: log.verifier_key.to_string(),
            witness_key,
            cosigned_at: log.cosigned_at,
            first_size: log.first_size,
            first_seen_at: log.first_seen_at,
            refused_checkpoint,
            refused_at,
        }
    }
}

/// Lists the logs of a factory's ledger with their countersigned checkpoints: for a recipient those
/// about what it gets, for the factory's own organisation all.
#[utoipa::path(get, operation_id = "listLedgerLogs", path = "/factories/{factoryId}/ledger-logs", tag = "factories", security(("session" = [])),
    params(("factoryId" = String, Path), PageQuery), responses((status = 200, body = Page<LedgerLogView>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<FactoryId>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<LedgerLogView>>, Problem> {
    let scope = who.principal.scope();
    let mut work = app.store.read().await?;
    if work.factories().lookup(&scope, &id).await?.is_none() {
        return Err(Problem::not_found(format_args!("factory {id}")));
    }
    let after = page.cursor.as_deref().and_then(recipient_and_epoch);
    let logs = work.ledger_logs().of_factory(&scope, &id, after, page.limit()).await?;
    let key = app.witness.verifier().to_string();
    let views = logs
        .into_iter()
        .map(|(recipient, log)| LedgerLogView::new(recipient, log, key.clone()))
        .collect();
    Ok(Json(Page::new(views, page.limit(), |last: &LedgerLogView| {
        format!("{}.{}", last.recipient_id, last.epoch)
    })))
}

/// Reads a cursor; any other text starts at the first page.
fn recipient_and_epoch(cursor: &str) -> Option<(&str, u32)> {
    let (recipient, epoch) = cursor.rsplit_once('.')?;
    Some((recipient, epoch.parse().ok()?))
}
