//! Headers that keep a browser from being turned against its user.

use axum::{
    Router,
    extract::Request,
    http::{HeaderName, HeaderValue, Method, header},
    middleware::{self, Next},
    response::{IntoResponse, Response},
};

use super::problem::Problem;

/// Policy that allows nothing from elsewhere, no framing, no inline scripts; style attributes are
/// what charts need.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; \
     style-src-attr 'unsafe-inline'; img-src 'self' data:; font-src 'self'; connect-src 'self'; manifest-src 'self'; \
     worker-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

const ALWAYS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("permissions-policy"), "camera=(), geolocation=(), microphone=()"),
];

/// Adds the security headers to every answer, forbids caching unless the answer says otherwise, and
/// refuses changes that a browser says another site has asked for. `has_tls` adds HSTS.
pub fn secured<S: Clone + Send + Sync + 'static>(router: Router<S>, has_tls: bool) -> Router<S> {
    router.layer(middleware::from_fn(move |request: Request, next: Next| async move {
        let mut response = if is_foreign_change(&request) {
            Problem::forbidden("Another site has asked for this change.").into_response()
        } else {
            next.run(request).await
        };
        add_headers(&mut response, has_tls);
        response
    }))
}

/// Methods that change nothing (RFC 9110 §9.2.1).
pub(super) fn is_safe(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS)
}

fn is_foreign_change(request: &Request) -> bool {
    !is_safe(request.method())
        && request
            .headers()
            .get("sec-fetch-site")
            .is_some_and(|site| site == "cross-site" || site == "same-site")
}

fn add_headers(response: &mut Response, has_tls: bool) {
    let headers = response.headers_mut();
    for (name, value) in ALWAYS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if has_tls {
        headers.insert(
            header::STRICT_TRANSPORT_SECURITY,
            HeaderValue::from_static("max-age=31536000"),
        );
    }
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
}
