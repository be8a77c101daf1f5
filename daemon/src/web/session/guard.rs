//! The middleware before every route that needs a session, and the extractor behind it.

use axum::{
    body::Body,
    extract::{FromRequestParts, Request, State},
    http::{header::CONTENT_TYPE, request::Parts},
    middleware::Next,
    response::{IntoResponse, Response},
};
use axum_extra::extract::CookieJar;
use futures::StreamExt as _;
use subtle::ConstantTimeEq;

use super::{
    Sessions,
    accounts::{Accounts, SessionId},
    internal,
};
use crate::web::{headers::is_safe, problem::Problem};

/// Whoever asks, as handlers extract it.
#[derive(Clone)]
pub struct SignedIn<P> {
    /// The session, to end it.
    pub session: SessionId,
    /// Who it is.
    pub principal: P,
    /// What changes must carry in `x-csrf-token`; told to pages when they ask who is signed in.
    pub csrf_token: String,
}

impl<P: std::fmt::Debug> std::fmt::Debug for SignedIn<P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SignedIn").field("principal", &self.principal).finish_non_exhaustive()
    }
}

impl<P: Clone + Send + Sync + 'static, S: Send + Sync> FromRequestParts<S> for SignedIn<P> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        parts.extensions.get::<Self>().cloned().ok_or_else(Problem::unauthorized)
    }
}

/// Lets only those pass who are signed in, and changes only with the CSRF token. For
/// `axum::middleware::from_fn_with_state(sessions, require_session::<A>)`.
pub async fn require_session<A: Accounts>(
    State(sessions): State<Sessions<A>>,
    mut request: Request,
    next: Next,
) -> Response {
    let jar = CookieJar::from_headers(request.headers());
    let Some(cookie) = jar.get(&sessions.inner.config.cookie_name) else {
        return Problem::unauthorized().into_response();
    };
    let signed_in = match sessions.resume(cookie.value()).await {
        Ok(Some(signed_in)) => signed_in,
        Ok(None) => return Problem::unauthorized().into_response(),
        Err(error) => return internal(error).into_response(),
    };
    if !is_safe(request.method()) {
        let sent =
            request.headers().get(super::CSRF_HEADER).map_or(&b""[..], |value| value.as_bytes());
        if !bool::from(sent.ct_eq(signed_in.csrf_token.as_bytes())) {
            return Problem::new(
                axum::http::StatusCode::FORBIDDEN,
                "WRONG_CSRF_TOKEN",
                "Changes need the session's token in the header x-csrf-token; GET /api/v1/session tells it.",
            )
            .into_response();
        }
    }
    request.extensions_mut().insert(signed_in);
    let token = cookie.value().to_owned();
    let answer = next.run(request).await;
    if !is_live(&answer) {
        return answer;
    }
    // Whoever is no longer signed in hears no more either.
    answer.map(|body| {
        let ended = async move { while sessions.is_good(&token).await {} };
        Body::from_stream(body.into_data_stream().take_until(Box::pin(ended)))
    })
}

/// Whether an answer goes on for as long as somebody listens.
fn is_live(answer: &Response) -> bool {
    answer
        .headers()
        .get(CONTENT_TYPE)
        .is_some_and(|kind| kind.as_bytes().starts_with(b"text/event-stream"))
}
