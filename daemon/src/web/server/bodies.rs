//! Bodies of requests and answers, which tell what their connection is busy with.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};

use bytes::Bytes;
use http_body::{Body as HttpBody, Frame, SizeHint};
use hyper::body::Incoming;

use super::{
    connections::{Activity, count_refused},
    patience::Patience,
};

/// The body of a request came too slowly.
#[derive(Debug, thiserror::Error)]
#[error("the body came too slowly")]
pub struct BodyTooSlow;

/// Body of a request; it fails where the client lets it wait for too long.
pub(super) struct PatientBody {
    inner: Incoming,
    patience: Patience,
    activity: Activity,
}

impl PatientBody {
    pub(super) const fn new(inner: Incoming, patience: Duration, activity: Activity) -> Self {
        Self { inner, patience: Patience::new(patience), activity }
    }
}

impl HttpBody for PatientBody {
    type Data = Bytes;
    type Error = axum::BoxError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        match Pin::new(&mut self.inner).poll_frame(context) {
            Poll::Ready(Some(Ok(frame))) => {
                self.patience.progressed(frame.data_ref().map_or(0, Bytes::len));
                if self.inner.is_end_stream() {
                    self.activity.received();
                }
                Poll::Ready(Some(Ok(frame)))
            }
            Poll::Ready(end) => {
                self.activity.received();
                Poll::Ready(end.map(|result| result.map_err(Into::into)))
            }
            Poll::Pending if self.patience.poll_spent(context).is_ready() => {
                count_refused("body_timeout");
                Poll::Ready(Some(Err(BodyTooSlow.into())))
            }
            Poll::Pending => Poll::Pending,
        }
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

impl Drop for PatientBody {
    fn drop(&mut self) {
        self.activity.received();
    }
}

/// Answer that is under way; when its body is dropped, the connection waits for the next request.
pub(super) struct AnswerUnderWay(pub(super) Activity);

impl Drop for AnswerUnderWay {
    fn drop(&mut self) {
        self.0.waits();
    }
}
