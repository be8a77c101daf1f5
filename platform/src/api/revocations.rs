//! Receipts of revocations.

use asi_model::OperationNetworkId;
use axum::{Json, extract::State};
use daemon::web::{ApiPath, ApiQuery, Problem, session::SignedIn};

use super::{
    page::{Page, PageQuery},
    problems::ReadProblems,
};
use crate::{application::Application, principal::Principal, store::RevocationEntry};

/// Lists the signed receipts of revocations about requests of a network, oldest first: for those who
/// received the values, and for the factory. `asi ledger receipt` verifies one.
#[utoipa::path(get, operation_id = "listRevocations", path = "/operation-networks/{operationNetworkId}/revocations", tag = "networks",
    security(("session" = [])), params(("operationNetworkId" = String, Path), PageQuery),
    responses((status = 200, body = Page<RevocationEntry>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<OperationNetworkId>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<RevocationEntry>>, Problem> {
    let scope = who.principal.scope();
    let mut work = app.store.read().await?;
    let known = work.networks().lookup(&scope, &id).await?;
    known.ok_or_else(|| Problem::not_found(format_args!("operation network {id}")))?;
    let after = page.after_id();
    let receipts = work.revocations().list(&scope, &id, after.as_ref(), page.limit()).await?;
    Ok(Json(Page::new(receipts, page.limit(), |receipt| receipt.receipt_id.to_string())))
}
