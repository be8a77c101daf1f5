//! Search for fields that the ledger has entries about.

use asi_model::FieldKey;
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::api::{Api, problems::Problems, roles::Viewer, view::Page};

/// Fields in one answer, and most that may be asked for.
const FIELDS: u32 = 20;
const FIELDS_MAX: u32 = 200;
/// Most words of a search. Each is a condition of the query.
const WORDS_MAX: usize = 10;

/// Search for fields.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerFieldsQuery {
    /// Fields in whose ids all these words occur.
    search: Option<String>,
    /// Most fields, at most 200; 20 without it.
    limit: Option<u32>,
}

/// A field that the ledger has entries about, requested still or no more.
#[derive(Serialize, ToSchema)]
pub struct LedgerField {
    key: FieldKey,
}

/// Searches the fields that the ledger has entries about, in the order of their addresses; those of
/// ended requests included.
#[utoipa::path(
    get,
    path = "/ledger/fields",
    tag = "ledger",
    params(LedgerFieldsQuery),
    responses((status = 200, body = Page<LedgerField>), Problems)
)]
pub async fn search_ledger_fields(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<LedgerFieldsQuery>,
) -> Result<Json<Page<LedgerField>>, Problem> {
    let search = query.search.unwrap_or_default();
    let words: Vec<String> = search.split_whitespace().take(WORDS_MAX).map(str::to_owned).collect();
    let limit = query.limit.unwrap_or(FIELDS).clamp(1, FIELDS_MAX);
    let found = api.store().await?.ledger().fields(&words, limit).await?;
    Ok(Json(Page::whole(found.into_iter().map(|key| LedgerField { key }).collect())))
}
