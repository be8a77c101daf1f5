//! One connection, from its TLS handshake to its end.

use std::{
    convert::Infallible,
    net::SocketAddr,
    pin::pin,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use axum::{Router, body::Body, extract::ConnectInfo};
use http_body::Body as _;
use hyper::{Request, body::Incoming, server::conn::http1, service::service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::TcpStream,
};
use tokio_rustls::TlsAcceptor;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt as _;
use tracing::debug;

use super::{
    bodies::{AnswerUnderWay, PatientBody},
    connections::{Activity, count_refused},
    limits::{BUFFER_BYTES_MAX, HEAD_BYTES_MAX, ListenerLimits},
    stream::PatientStream,
};
use crate::web::held_body::HeldBody;

/// Everything that serving one connection takes.
pub(super) struct Serving {
    pub peer: SocketAddr,
    pub tls: Option<TlsAcceptor>,
    pub router: Router,
    pub limits: ListenerLimits,
    pub shutdown: CancellationToken,
}

impl Serving {
    /// Serves the connection until either side ends it.
    pub(super) async fn run(self, stream: TcpStream, activity: Activity) {
        let stream = PatientStream::new(stream, self.limits.answer_patience, activity.clone());
        let Some(tls) = &self.tls else { return self.requests(stream, activity).await };
        let handshake = tokio::time::timeout(self.limits.handshake_timeout, tls.accept(stream));
        match handshake.await {
            Ok(Ok(stream)) => self.requests(stream, activity).await,
            Ok(Err(error)) => {
                count_refused("handshake");
                debug!(client = %self.peer, %error, "A TLS handshake failed.");
            }
            Err(_) => {
                count_refused("handshake_timeout");
                debug!(client = %self.peer, "A TLS handshake took too long.");
            }
        }
    }

    async fn requests<S>(&self, stream: S, activity: Activity)
    where
        S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
    {
        let has_asked = Arc::new(AtomicBool::new(false));
        let service = service_fn(|request: Request<Incoming>| {
            has_asked.store(true, Ordering::Relaxed);
            self.answer(request, activity.clone())
        });
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(self.limits.head_timeout)
            .max_header_size(HEAD_BYTES_MAX)
            .max_buf_size(BUFFER_BYTES_MAX)
            .serve_connection(TokioIo::new(stream), service);
        let mut connection = pin!(connection);
        let ended = tokio::select! {
            ended = connection.as_mut() => ended,
            () = self.shutdown.cancelled() => {
                connection.as_mut().graceful_shutdown();
                connection.await
            }
        };
        let Err(error) = ended else { return };
        // After an answer it is idleness, which is no fault of the client's.
        if error.is_timeout() && !has_asked.load(Ordering::Relaxed) {
            count_refused("head_timeout");
        } else if error.is_parse() {
            count_refused("rubbish");
        }
        debug!(client = %self.peer, %error, "A connection was given up.");
    }

    fn answer(
        &self,
        request: Request<Incoming>,
        activity: Activity,
    ) -> impl Future<Output = Result<axum::http::Response<Body>, Infallible>> + Send + 'static {
        if request.body().is_end_stream() {
            activity.answers();
        } else {
            activity.receives();
        }
        let patience = self.limits.body_patience;
        let body_activity = activity.clone();
        let mut request =
            request.map(|body| Body::new(PatientBody::new(body, patience, body_activity)));
        request.extensions_mut().insert(ConnectInfo(self.peer));
        let router = self.router.clone();
        async move {
            let answer = router.oneshot(request).await?;
            Ok(answer.map(|body| HeldBody::wrap(body, AnswerUnderWay(activity))))
        }
    }
}
