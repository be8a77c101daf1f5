//! What left this factory.

use asi_model::OrganisationId;
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::{Api, problems::Problems};
use crate::{
    ledger::Verification,
    store::{LedgerRow, Store, ledger_page, verify_ledger},
};

/// Which part of which chain.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerQuery {
    /// Whose chain; the first by name without it.
    #[param(value_type = Option<String>)]
    recipient: Option<OrganisationId>,
    /// `nextCursor` of the page before.
    after: Option<u64>,
    /// Entries on the page, 1 to 500; 100 without it.
    limit: Option<u32>,
}

/// Entries of one chain, newest first.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct LedgerView {
    /// Every recipient that has a chain.
    recipients: Vec<String>,
    /// The entries.
    items: Vec<LedgerRow>,
    /// Where the next page begins.
    next_cursor: Option<String>,
}

/// Lists the entries of a recipient's chain, newest first, with what left.
#[utoipa::path(get, path = "/ledger", tag = "ledger", security(("session" = [])), params(LedgerQuery),
    responses((status = 200, body = LedgerView), Problems))]
pub async fn list(State(api): State<Api>, ApiQuery(query): ApiQuery<LedgerQuery>) -> Result<Json<LedgerView>, Problem> {
    let limit = query.limit.unwrap_or(100).clamp(1, 500);
    let before = query.after.unwrap_or(u64::MAX);
    let page = ledger_page(&api.readers, query.recipient.as_ref(), before, limit).await?;
    let next_cursor = page.entries.last().map(|entry| entry.number).filter(|number| *number > 1);
    Ok(Json(LedgerView {
        recipients: page.recipients,
        items: page.entries,
        next_cursor: next_cursor.map(|number| number.to_string()),
    }))
}

/// The outcome of a verification.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct VerificationView {
    /// Nothing is wrong.
    is_intact: bool,
    /// What was looked at and what is wrong.
    #[serde(flatten)]
    verification: Verification,
}

/// Reads every chain from its beginning and finds any change, deletion or reordering.
#[utoipa::path(post, path = "/ledger/verification", tag = "ledger", security(("session" = [])),
    responses((status = 200, body = VerificationView), Problems))]
pub async fn verify(State(api): State<Api>) -> Result<Json<VerificationView>, Problem> {
    // Hashing a whole ledger takes its time: it has a thread of its own.
    let directory = api.data_directory.clone();
    let runtime = tokio::runtime::Handle::current();
    let verified = tokio::task::spawn_blocking(move || {
        runtime.block_on(async {
            let mut connection = Store::connect(&directory).await?;
            verify_ledger(&mut connection).await
        })
    });
    let verification = verified.await.map_err(|error| Problem::internal(&error))??;
    Ok(Json(VerificationView { is_intact: verification.is_intact(), verification }))
}
