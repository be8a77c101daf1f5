//! Operations whose answers last, and their hold on a place until the answer has ended.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Instant,
};

use axum::{
    body::Body,
    extract::Request,
    middleware::{self, Next},
    response::{IntoResponse, Response},
};
use bytes::Bytes;
use http_body::{Body as HttpBody, Frame, SizeHint};
use utoipa_axum::router::{UtoipaMethodRouter, UtoipaMethodRouterExt as _};

use super::{
    share::Share,
    usage::{FairShares, HeldShare, Member},
};
use crate::web::problem::Problem;

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

async fn hold(share: Share, request: Request, next: Next) -> Response {
    let Some(claim) = request.extensions().get::<Claim>() else {
        return Problem::unauthorized().into_response();
    };
    match claim.shares.hold(share, &claim.member, Instant::now()) {
        Ok(place) => {
            next.run(request).await.map(|body| Body::new(HoldingBody { body, _place: place }))
        }
        Err(problem) => problem.into_response(),
    }
}

/// Body that holds a place until it was sent or given up.
struct HoldingBody {
    body: Body,
    _place: HeldShare,
}

impl HttpBody for HoldingBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
