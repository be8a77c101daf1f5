//! Bodies of requests behind a session: the bytes that one person, one organisation and all together may
//! have under way at once.

use std::time::Instant;

use axum::{
    extract::Request,
    http::header::CONTENT_LENGTH,
    middleware::Next,
    response::{IntoResponse, Response},
};
use http_body::Body as _;

use super::routes::Claim;

/// Bytes that a body without a length counts as: most are shorter, and the operations refuse what is longer.
const UNKNOWN_BYTES: u64 = 4 * 1024 * 1024;

/// Middleware that holds the bytes of a body on the share of its sender until the answer begins.
pub(crate) async fn hold_body(request: Request, next: Next) -> Response {
    let length = request.headers().get(CONTENT_LENGTH);
    let length = length.and_then(|length| length.to_str().ok()?.parse().ok());
    let is_empty = request.body().is_end_stream();
    let bytes = length.unwrap_or(if is_empty { 0 } else { UNKNOWN_BYTES });
    if bytes == 0 {
        return next.run(request).await;
    }
    let Some(claim) = request.extensions().get::<Claim>() else { return next.run(request).await };
    match claim.shares.hold_bytes(&claim.member, bytes, Instant::now()) {
        Ok(held) => {
            let answer = next.run(request).await;
            drop(held);
            answer
        }
        Err(problem) => problem.into_response(),
    }
}
