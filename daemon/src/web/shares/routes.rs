//! Operations whose answers last, and their hold on a place until the answer has ended.

use std::time::Instant;

use axum::{
    extract::Request,
    middleware::{self, Next},
    response::{IntoResponse, Response},
};
use utoipa_axum::router::{UtoipaMethodRouter, UtoipaMethodRouterExt as _};

use super::{
    share::Share,
    usage::{FairShares, Member},
};
use crate::web::{held_body::HeldBody, problem::Problem};

/// Shares on which a request draws; an extension of requests behind a session.
#[derive(Debug, Clone)]
pub(crate) struct Claim {
    pub(crate) shares: FairShares,
    pub(crate) member: Member,
}

/// Lets operations hold a place for a download, for `OpenApiRouter::routes`.
pub fn downloads<S>(routes: UtoipaMethodRouter<S>) -> UtoipaMethodRouter<S>
where
    S: Clone + Send + Sync + 'static,
{
    routes.layer(middleware::from_fn(hold_download))
}

/// Lets operations hold a place for a live stream, for `OpenApiRouter::routes`.
pub fn streams<S>(routes: UtoipaMethodRouter<S>) -> UtoipaMethodRouter<S>
where
    S: Clone + Send + Sync + 'static,
{
    routes.layer(middleware::from_fn(hold_stream))
}

/// Middleware of a download behind a session.
pub async fn hold_download(request: Request, next: Next) -> Response {
    hold(Share::Downloads, request, next).await
}

/// Middleware of a live stream behind a session.
pub async fn hold_stream(request: Request, next: Next) -> Response {
    hold(Share::Streams, request, next).await
}

/// Middleware of operations behind a session that read a store with few readers: each waits for its turn, which ends
/// when its answer begins. Changes pass: their bodies may come slowly, and they hold readers for moments.
pub async fn read_in_turn(request: Request, next: Next) -> Response {
    if !request.method().is_safe() {
        return next.run(request).await;
    }
    let Some(claim) = request.extensions().get::<Claim>().cloned() else {
        return Problem::unauthorized().into_response();
    };
    match claim.shares.take_read_turn(&claim.member).await {
        Ok(turn) => {
            let answer = next.run(request).await;
            drop(turn);
            answer
        }
        Err(problem) => problem.into_response(),
    }
}

async fn hold(share: Share, request: Request, next: Next) -> Response {
    let Some(claim) = request.extensions().get::<Claim>() else {
        return Problem::unauthorized().into_response();
    };
    match claim.shares.hold(share, &claim.member, Instant::now()) {
        Ok(place) => next.run(request).await.map(|body| HeldBody::wrap(body, place)),
        Err(problem) => problem.into_response(),
    }
}
