//! Export of the ledger as a file.

use std::sync::Arc;

use axum::{
    body::Body,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use daemon::web::{ApiQuery, Problem};
use disclosure::Language;
use futures::StreamExt as _;
use serde::Deserialize;
use tokio::sync::Semaphore;
use utoipa::IntoParams;

use super::LedgerSelection;
use crate::{
    api::{context::Api, problems::Problems, roles::Engineer},
    ledger_export::{ExportFormat, Exporter},
    store::{LedgerCursor, LedgerRow, Readers, StoreError},
};

/// Form of an export.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LedgerExportQuery {
    /// `jsonl`, `csv` or `html`.
    #[param(inline)]
    format: ExportFormat,
    /// Language of a page to print: `en` or `de`.
    #[param(inline)]
    language: Option<Language>,
}

/// Reads blocks of entries. A connection is held for one block only, never while a client reads: the ledger
/// only grows, so that the next block may come from another one.
struct Blocks {
    readers: Readers,
    turn: Arc<Semaphore>,
}

impl Blocks {
    async fn next(&self, cursor: &mut LedgerCursor) -> Result<Vec<LedgerRow>, StoreError> {
        let _turn = self.turn.acquire().await.map_err(|_| StoreError::Closed)?;
        self.readers.session().await?.ledger().next(cursor).await
    }
}

/// Exports entries as JSON lines, as a table for spreadsheets or as a page to print, in the order of
/// the chains.
#[utoipa::path(
    get,
    path = "/ledger/export",
    tag = "ledger",
    params(LedgerSelection, LedgerExportQuery),
    responses((status = 200, content_type = "text/csv", body = String), Problems)
)]
pub async fn export_ledger(
    _: Engineer,
    State(api): State<Api>,
    ApiQuery(selection): ApiQuery<LedgerSelection>,
    ApiQuery(query): ApiQuery<LedgerExportQuery>,
) -> Result<Response, Problem> {
    let exporter = Exporter::new(query.format, query.language.unwrap_or_default());
    let filter = selection.filter()?;
    let first = exporter.begin(api.instance.factory_id.as_str());
    let blocks = Blocks { readers: api.readers.clone(), turn: Arc::clone(&api.export_turn) };
    // One part per block of entries: no more than a block is in memory at once.
    let state = Some((blocks, LedgerCursor::new(filter)));
    let parts = futures::stream::try_unfold(state, move |state| async move {
        let Some((blocks, mut cursor)) = state else { return Ok(None) };
        let rows = blocks.next(&mut cursor).await?;
        if rows.is_empty() {
            return Ok(Some((exporter.end(), None)));
        }
        let part: String = rows.iter().map(|row| exporter.entry(row)).collect();
        Ok::<_, StoreError>(Some((part, Some((blocks, cursor)))))
    });
    let body = futures::stream::once(async move { Ok(first) }).chain(parts);
    let name = format!(
        "attachment; filename=\"ledger-{}.{}\"",
        api.instance.factory_id,
        query.format.extension()
    );
    let headers = [
        (header::CONTENT_TYPE, query.format.media_type().to_owned()),
        (header::CONTENT_DISPOSITION, name),
    ];
    Ok((headers, Body::from_stream(body)).into_response())
}
