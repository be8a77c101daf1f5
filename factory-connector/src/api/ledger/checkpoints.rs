//! Checkpoints: signed heads of all chains.

use asi_model::DateTime;
use axum::{Json, extract::State};
use daemon::web::{ApiQuery, Problem};
use ledger::{CheckpointHead, HeadsCheckpoint};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::{
    api::{context::Api, problems::Problems, roles::Viewer, view::Page},
    store::StoredCheckpoint,
};

/// Checkpoints per page.
const PAGE: u32 = 20;

/// Page of checkpoints.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CheckpointsQuery {
    /// `nextCursor` of the page before.
    #[param(value_type = Option<String>)]
    cursor: Option<i64>,
    /// Checkpoints per page, at most 200; 20 without it.
    limit: Option<u32>,
}

/// A checkpoint. A copy of it elsewhere proves later whether the ledger still has the entries of that
/// time.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct CheckpointView {
    /// Number, from 1 without gaps.
    number: u64,
    /// Time at which it was made.
    recorded_at: DateTime,
    /// Last entry of each chain at that time.
    heads: Vec<CheckpointHead>,
    /// Exact text that was signed: factory, number, time, and the last number and hash of each chain.
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
                .map_or_else(|_| Vec::new(), |text: HeadsCheckpoint| text.heads),
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
