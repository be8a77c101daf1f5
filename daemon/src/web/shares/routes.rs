//! Operations whose answers last, and their hold on a place until the answer has ended.

use std::time::Instant;

use axum::{
    body::Body,
    extract::{FromRequest, FromRequestParts, Request, rejection::JsonRejection},
    http::request::Parts,
    middleware::{self, Next},
    response::{IntoResponse, Response},
};
use bytes::Bytes;
use utoipa_axum::router::{UtoipaMethodRouter, UtoipaMethodRouterExt as _};

use super::{member::Member, member_turns::MemberTurn, share::Share, usage::FairShares};
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

/// Middleware of operations behind a session at a store with few readers and one writer: each waits for its turn to read
/// or to change, which ends when its answer begins. Who has a turn of one kind waits for none of the other.
pub async fn in_turn(request: Request, next: Next) -> Response {
    let Some(claim) = request.extensions().get::<Claim>().cloned() else {
        return Problem::unauthorized().into_response();
    };
    match with_turn(&claim, request).await {
        Ok((turn, request)) => {
            let answer = next.run(request).await;
            drop(turn);
            answer
        }
        Err(problem) => problem.into_response(),
    }
}

async fn with_turn(claim: &Claim, request: Request) -> Result<(MemberTurn, Request), Problem> {
    let Claim { shares, member } = claim;
    if request.method().is_safe() {
        return Ok((shares.take_read_turn(member).await?, request));
    }
    // A body may come slowly, and nobody waits for it: the turn begins once it is there.
    let request = with_whole_body(request).await?;
    Ok((shares.take_change_turn(member).await?, request))
}

/// Reads the body, of which the handler gets the same bytes; its length has the bound of the handler's.
async fn with_whole_body(request: Request) -> Result<Request, Problem> {
    let (parts, body) = request.into_parts();
    let whole = Bytes::from_request(Request::from_parts(parts.clone(), body), &()).await;
    let bytes = whole.map_err(JsonRejection::from)?;
    Ok(Request::from_parts(parts, Body::from(bytes)))
}

/// Turns of the person that asks, for what reads on while its answer is sent; an extractor for handlers behind a session.
#[derive(Debug, Clone)]
pub struct OwnTurns(Claim);

impl OwnTurns {
    /// Waits for a turn to read a portion, which ends once it is dropped.
    pub async fn to_read(&self) -> MemberTurn {
        self.0.shares.wait_to_read(&self.0.member).await
    }
}

impl<S: Send + Sync> FromRequestParts<S> for OwnTurns {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        parts.extensions.get::<Claim>().cloned().map(Self).ok_or_else(Problem::unauthorized)
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
