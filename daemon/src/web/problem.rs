//! Problem documents (RFC 9457): the one form in which the APIs say no.

use std::{collections::BTreeMap, fmt, num::NonZeroU64};

use axum::{
    Json,
    http::{HeaderValue, StatusCode, Uri, header},
    response::{IntoResponse, Response},
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A problem document. `code` is stable and for programs, `detail` is for people; what went wrong
/// inside is logged and never shown.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Problem {
    /// Problem type, `urn:verbund:problem:<code>`.
    #[serde(rename = "type")]
    #[schema(value_type = String)]
    pub problem_type: Box<str>,
    /// The HTTP status in words.
    #[schema(value_type = String)]
    pub title: Box<str>,
    /// The HTTP status.
    pub status: u16,
    /// A stable code, as `NOT_FOUND`.
    #[schema(value_type = String)]
    pub code: Box<str>,
    /// Problem and remedy, for people.
    #[schema(value_type = String)]
    pub detail: Box<str>,
    /// Each single fault, where a document has several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<ProblemFault>,
    /// Seconds after which trying again makes sense; also the header `Retry-After`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<u64>)]
    pub retry_after_seconds: Option<NonZeroU64>,
    /// Second factors of which a sign-in needs one, with the code `SECOND_FACTOR_NEEDED`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_factor: Option<Box<SecondFactorNeeded>>,
    /// Values that a text of the code in another language names, by their names in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<BTreeMap<String, String>>)]
    pub parameters: Option<Box<BTreeMap<String, String>>>,
}

/// Second factors that a person has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct SecondFactorNeeded {
    /// Kinds that are on; a recovery code is good in place of each.
    pub kinds: Vec<SecondFactorKind>,
    /// Options of `navigator.credentials.get` for the person's passkeys: `PublicKeyCredentialRequestOptionsJSON`
    /// of WebAuthn Level 3. Their challenge is good once, for two minutes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Object>)]
    pub passkey_options: Option<serde_json::Value>,
}

/// Proof that a person gives beside the password.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum SecondFactorKind {
    /// Code of an authenticator app.
    Code,
    /// Passkey, by WebAuthn.
    Passkey,
}

/// One fault of a document, placed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct ProblemFault {
    /// JSON pointer (RFC 6901) into the document that was sent.
    pub pointer: String,
    /// A stable code.
    pub code: String,
    /// A sentence that says what is wrong and what to do.
    pub message: String,
}

impl Problem {
    /// Creates a problem; its type is `urn:verbund:problem:` and the code in kebab case.
    #[must_use]
    pub fn new(status: StatusCode, code: &str, detail: impl Into<String>) -> Self {
        Self {
            problem_type: format!(
                "urn:verbund:problem:{}",
                code.to_ascii_lowercase().replace('_', "-")
            )
            .into(),
            title: status.canonical_reason().unwrap_or("Error").into(),
            status: status.as_u16(),
            code: code.into(),
            detail: detail.into().into(),
            faults: Vec::new(),
            retry_after_seconds: None,
            second_factor: None,
            parameters: None,
        }
    }

    /// Adds a value that texts of the code name.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl fmt::Display) -> Self {
        self.parameters.get_or_insert_default().insert(name.to_owned(), value.to_string());
        self
    }

    /// 400: the request cannot be understood.
    #[must_use]
    pub fn bad_request(code: &str, detail: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, code, detail)
    }

    /// 401: nobody is signed in.
    #[must_use]
    pub fn unauthorized() -> Self {
        Self::new(StatusCode::UNAUTHORIZED, "NOT_SIGNED_IN", "Sign in first: POST /api/v1/session.")
    }

    /// 403: the role does not allow it.
    #[must_use]
    pub fn forbidden(detail: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, "FORBIDDEN", detail)
    }

    /// 404: it does not exist, or the viewer may not know that it does.
    #[must_use]
    pub fn not_found(what: impl fmt::Display) -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            "NOT_FOUND",
            format!("There is no {what}, or you have no part in it."),
        )
    }

    /// 409: it does not fit the present state.
    #[must_use]
    pub fn conflict(code: &str, detail: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, code, detail)
    }

    /// 422: understood, but wrong in its meaning; each fault with its place.
    #[must_use]
    pub fn unprocessable(code: &str, detail: impl Into<String>, faults: Vec<ProblemFault>) -> Self {
        Self { faults, ..Self::new(StatusCode::UNPROCESSABLE_ENTITY, code, detail) }
    }

    /// 429: too often. `retry_after` is rounded down to seconds, at least one.
    #[must_use]
    pub fn too_many(detail: impl Into<String>, retry_after: std::time::Duration) -> Self {
        Self {
            retry_after_seconds: NonZeroU64::new(retry_after.as_secs().max(1)),
            ..Self::new(StatusCode::TOO_MANY_REQUESTS, "TOO_MANY_REQUESTS", detail)
        }
    }

    /// 500: a fault of ours. The cause is logged with its chain and not shown.
    #[must_use]
    pub fn internal(cause: &(dyn std::error::Error + 'static)) -> Self {
        tracing::error!(cause = %chain(cause), "A request failed by a fault of this program.");
        Self::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "INTERNAL",
            "Something went wrong here; the log of the daemon says what.",
        )
    }

    /// 503: not now, for a reason outside of the request.
    #[must_use]
    pub fn unavailable(code: &str, detail: impl Into<String>) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, code, detail)
    }
}

/// An error and its causes in one line.
fn chain(error: &(dyn std::error::Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    text
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let retry_after = self.retry_after_seconds;
        let mut response = (status, Json(self)).into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        if let Some(seconds) = retry_after {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds.get()));
        }
        response
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.status, self.code, self.detail)
    }
}

impl std::error::Error for Problem {}

/// The answer to a path of the API that does not exist.
pub async fn unknown_route(uri: Uri) -> Problem {
    Problem::new(
        StatusCode::NOT_FOUND,
        "UNKNOWN_ROUTE",
        format!("There is no {} here; /api/v1/openapi.json lists what there is.", uri.path()),
    )
}

/// The answer to a method that a path does not have.
pub async fn unknown_method(uri: Uri) -> Problem {
    Problem::new(
        StatusCode::METHOD_NOT_ALLOWED,
        "METHOD_NOT_ALLOWED",
        format!(
            "{} does not have this method; /api/v1/openapi.json lists what there is.",
            uri.path()
        ),
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn parameters_have_their_names_and_a_problem_without_any_has_no_such_member() {
        let plain = Problem::conflict("REVISION_CONFLICT", "Another change was faster.");
        let document = serde_json::to_value(&plain).expect("JSON");
        assert_eq!(document.get("parameters"), None);
        let document = serde_json::to_value(plain.with("revision", 7)).expect("JSON");
        assert_eq!(document["parameters"], json!({ "revision": "7" }));
    }
}
