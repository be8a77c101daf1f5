//! Signed statements of the heads of all chains.

use asi_model::DateTime;
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::{
    api::{Api, problems::Problems, roles::Viewer, view::Page},
    store::StoredCheckpoint,
};
use ledger::{Checkpoint, CheckpointHead};

/// Checkpoints per page.
const PAGE: u32 = 20;

/// Which page.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CheckpointsQuery {
    /// `nextCursor` of the page before.
    cursor: Option<i64>,
    /// Checkpoints per page, at most 200; 20 without it.
    limit: Option<u32>,
}

/// A checkpoint: whoever keeps one elsewhere can prove later whether the ledger still holds what it
/// held then.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CheckpointView {
    /// Its place, from 1 without gaps.
    number: u64,
    /// When it was made.
    recorded_at: DateTime,
    /// The last entry of each chain then.
    heads: Vec<CheckpointHead>,
    /// The exact text that was signed: factory, number, time, and of each chain the last number and
    /// hash.
    signed_text: String,
    /// The Ed25519 signature over that text, hexadecimal.
    signature: String,
    /// The key it is verified with, hexadecimal.
    public_key: String,
}

impl From<StoredCheckpoint> for CheckpointView {
    fn from(stored: StoredCheckpoint) -> Self {
        Self {
            number: stored.number,
            recorded_at: stored.recorded_at,
            heads: serde_json::from_str(&stored.signed_text)
                .map_or_else(|_| Vec::new(), |text: Checkpoint| text.heads),
            signed_text: stored.signed_text,
            signature: hex::encode(stored.signature),
            public_key: hex::encode(stored.public_key),
        }
    }
}

/// Lists the signed checkpoints over all chains, newest first.
#[utoipa::path(
    get,
    path = "/ledger/checkpoints",
    tag = "ledger",
    params(CheckpointsQuery),
    responses((status = 200, body = Page<CheckpointView>), Problems)
)]
pub async fn list_checkpoints(
    _: Viewer,
    State(api): State<Api>,
    ApiQuery(query): ApiQuery<CheckpointsQuery>,
) -> Result<Json<Page<CheckpointView>>, Problem> {
    let limit = query.limit.unwrap_or(PAGE).clamp(1, 200);
    let found =
        api.store().await?.checkpoints().page(query.cursor.unwrap_or(i64::MAX), limit).await?;
    Ok(Json(Page::of(found.into_iter().map(CheckpointView::from).collect(), limit, |last| {
        last.number.to_string()
    })))
}
