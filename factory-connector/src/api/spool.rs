//! Spool and dead letters.

use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use messaging::Backlog;
use serde::Deserialize;
use utoipa::IntoParams;

use super::{context::Api, problems::Problems, roles::Viewer, view::Page};
use crate::store::DeadLetter;

/// Letters per page.
const PAGE: u32 = 100;

/// Shows the backlog of the spool.
#[utoipa::path(
    get,
    path = "/spool",
    tag = "spool",
    responses((status = 200, body = Backlog), Problems)
)]
pub async fn show_spool(_: Viewer, State(api): State<Api>) -> Result<Json<Backlog>, Problem> {
    Ok(Json(api.store().await?.spool().backlog().await?))
}

/// Page of dead letters.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct DeadLettersQuery {
    /// `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
    cursor: Option<i64>,
}

/// Lists messages that were received or sent and rejected, newest first.
#[utoipa::path(
    get,
    path = "/dead-letters",
    tag = "spool",
    params(DeadLettersQuery),
    responses((status = 200, body = Page<DeadLetter>), Problems)
)]
pub async fn list_dead_letters(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<DeadLettersQuery>,
) -> Result<Json<Page<DeadLetter>>, Problem> {
    let items =
        api.store().await?.dead_letters().page(query.cursor.unwrap_or(i64::MAX), PAGE).await?;
    let next_cursor =
        items.last().filter(|_| items.len() == PAGE as usize).map(|letter| letter.id.clone());
    Ok(Json(Page { items, next_cursor }))
}
