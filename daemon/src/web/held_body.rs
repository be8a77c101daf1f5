//! Body of an answer that holds something until it was sent or given up.

use std::{
    pin::Pin,
    task::{Context, Poll},
};

use axum::body::Body;
use bytes::Bytes;
use http_body::{Body as HttpBody, Frame, SizeHint};

/// Body with what it holds.
pub(in crate::web) struct HeldBody<H> {
    body: Body,
    _held: H,
}

impl<H: Send + Unpin + 'static> HeldBody<H> {
    /// Returns the body with `held`, which is dropped with it.
    pub(in crate::web) fn wrap(body: Body, held: H) -> Body {
        Body::new(Self { body, _held: held })
    }
}

impl<H: Unpin> HttpBody for HeldBody<H> {
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
