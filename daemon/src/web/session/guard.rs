//! Middleware before every route that needs a session.

use std::time::Instant;

use axum::{
    body::Body,
    extract::{Request, State},
    http::header::CONTENT_TYPE,
    middleware::Next,
    response::{IntoResponse, Response},
};
use axum_extra::extract::CookieJar;
use futures::StreamExt as _;
use subtle::ConstantTimeEq;

use super::{
    accounts::{Accounts, SessionId},
    known_cookies::has_form_of_cookie,
    sessions::{CSRF_HEADER, Sessions, SignedIn, internal},
};
use crate::web::{
    address_range::AddressRange,
    client_address::ClientAddress,
    headers::is_safe,
    problem::Problem,
    shares::{Claim, Member},
};

/// Passes requests of signed-in users only, within their shares, and changes only with the CSRF token.
/// For `axum::middleware::from_fn_with_state(sessions, require_session::<A>)`.
pub async fn require_session<A: Accounts>(
    State(sessions): State<Sessions<A>>,
    client: ClientAddress,
    mut request: Request,
    next: Next,
) -> Response {
    let jar = CookieJar::from_headers(request.headers());
    let Some(cookie) = jar.get(sessions.config().cookie_name()) else {
        return Problem::unauthorized().into_response();
    };
    let signed_in = match look_up(&sessions, client, cookie.value()).await {
        Ok(signed_in) => signed_in,
        Err(problem) => return problem.into_response(),
    };
    let member = Member {
        person: signed_in.user_name.clone(),
        organisation: A::organisation(&signed_in.principal).map(str::to_owned),
    };
    if let Err(problem) = sessions.shares().take_request(&member, Instant::now()) {
        return problem.into_response();
    }
    if !is_safe(request.method()) {
        let sent = request.headers().get(CSRF_HEADER).map_or(&b""[..], |value| value.as_bytes());
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
    request.extensions_mut().insert(Claim { shares: sessions.shares().clone(), member });
    let token = cookie.value().to_owned();
    let answer = next.run(request).await;
    if !is_live(&answer) {
        return answer;
    }
    // A live stream ends with its session.
    answer.map(|body| {
        let ended = async move { while sessions.is_valid_after_pause(&token).await {} };
        Body::from_stream(body.into_data_stream().take_until(Box::pin(ended)))
    })
}

/// Returns the user of a cookie. What is none draws on the share of strangers of its client, and once that
/// is spent, the store is asked about known cookies alone.
async fn look_up<A: Accounts>(
    sessions: &Sessions<A>,
    client: ClientAddress,
    cookie: &str,
) -> Result<SignedIn<A::Principal>, Problem> {
    if !has_form_of_cookie(cookie) {
        return Err(Problem::unauthorized());
    }
    let id = SessionId::of(cookie);
    let (known, strangers) = (sessions.known_cookies(), sessions.strangers());
    let client = AddressRange::of_client(client.0);
    if !known.has(&id) {
        strangers.check(client, Instant::now())?;
    }
    let Some(signed_in) = sessions.resume(cookie).await.map_err(internal)? else {
        known.remove(&id);
        strangers.take(client, Instant::now())?;
        return Err(Problem::unauthorized());
    };
    known.add(&id);
    Ok(signed_in)
}

/// Returns true for an answer that lasts until the client closes it.
fn is_live(answer: &Response) -> bool {
    answer
        .headers()
        .get(CONTENT_TYPE)
        .is_some_and(|kind| kind.as_bytes().starts_with(b"text/event-stream"))
}
