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

/// Turns of an answer that has begun, which is not refused any more.
#[derive(Debug, Clone)]
pub struct FurtherTurns(Claim);

impl OwnTurns {
    /// Waits for the turn with which an answer begins, which ends once it is dropped.
    ///
    /// # Errors
    /// 429 `TOO_MANY_READS` where too many requests of the person wait, or this one waits too long.
    pub async fn to_begin(self) -> Result<(MemberTurn, FurtherTurns), Problem> {
        let turn = self.0.shares.take_read_turn(&self.0.member).await?;
        Ok((turn, FurtherTurns(self.0)))
    }
}

impl FurtherTurns {
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tokio::time::timeout;

    use super::{super::config::FairShareConfig, *};

    #[tokio::test]
    async fn an_answer_that_lasts_begins_in_a_turn_as_others_or_is_refused() {
        let shares = FairShares::new(FairShareConfig::default());
        let member = Member { person: "ann".to_owned(), organisation: None };
        let turns = OwnTurns(Claim { shares, member });
        let begin = || turns.clone().to_begin();
        let held = [begin().await.expect("free"), begin().await.expect("free")];
        let wait = |_| {
            let begins = begin();
            tokio::spawn(async move { begins.await.map(drop) })
        };
        let waiting: Vec<_> = (0..100).map(wait).collect();
        for _ in 0..1_000 {
            tokio::task::yield_now().await;
        }
        let refused = timeout(Duration::from_secs(5), begin()).await.expect("it does not wait");
        let problem = refused.expect_err("too many wait");
        assert_eq!((problem.status, &*problem.code), (429, "TOO_MANY_READS"));
        let (_, further) = &held[0];
        let portion = timeout(Duration::from_millis(50), further.to_read()).await;
        assert!(portion.is_err(), "what has begun waits for its next turn");
        drop(held);
        for one in waiting {
            one.await.expect("it ends").expect("its turn came");
        }
    }
}
