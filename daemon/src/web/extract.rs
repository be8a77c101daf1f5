//! Extractors whose rejections are problem documents.

use axum::{
    extract::{
        FromRequest, FromRequestParts,
        rejection::{JsonRejection, PathRejection, QueryRejection},
    },
    http::StatusCode,
};

use super::{
    problem::{Problem, ProblemFault},
    server::BodyTooSlow,
};

/// A JSON body. Faults carry the JSON pointer of the member at fault.
#[derive(Debug, Clone, FromRequest)]
#[from_request(via(axum::Json), rejection(Problem))]
pub struct ApiJson<T>(pub T);

/// Parameters of the path.
#[derive(Debug, Clone, FromRequestParts)]
#[from_request(via(axum::extract::Path), rejection(Problem))]
pub struct ApiPath<T>(pub T);

/// Parameters of the query.
#[derive(Debug, Clone, FromRequestParts)]
#[from_request(via(axum::extract::Query), rejection(Problem))]
pub struct ApiQuery<T>(pub T);

impl From<JsonRejection> for Problem {
    fn from(rejection: JsonRejection) -> Self {
        if is_of_slow_body(&rejection) {
            return Self::new(
                StatusCode::REQUEST_TIMEOUT,
                "TOO_SLOW",
                "The body came too slowly; the connection is closed.",
            );
        }
        let status = rejection.status();
        let code = match &rejection {
            JsonRejection::JsonDataError(_) => "INVALID_DOCUMENT",
            JsonRejection::JsonSyntaxError(_) => "NOT_JSON",
            JsonRejection::MissingJsonContentType(_) => "WRONG_CONTENT_TYPE",
            _ if status == StatusCode::PAYLOAD_TOO_LARGE => "TOO_LARGE",
            _ => "UNREADABLE_BODY",
        };
        let text = rejection.body_text();
        // axum words it `<intro>: <path>: <message>`; the path is dotted with [indexes].
        let rest = text.split_once(": ").map_or(text.as_str(), |(_, rest)| rest);
        let faults = match (&rejection, rest.split_once(": ")) {
            (JsonRejection::JsonDataError(_), Some((path, message))) if !path.contains(' ') => {
                vec![ProblemFault {
                    pointer: pointer(path),
                    code: code.to_owned(),
                    message: message.to_owned(),
                }]
            }
            _ => Vec::new(),
        };
        Self { faults, ..Self::new(status, code, text) }
    }
}

/// Returns true if the server had no more patience with the body.
fn is_of_slow_body(rejection: &JsonRejection) -> bool {
    let first: &(dyn std::error::Error + 'static) = rejection;
    std::iter::successors(Some(first), |error| error.source())
        .any(|error| error.is::<BodyTooSlow>())
}

/// `a.b[0].c` as `/a/b/0/c`.
fn pointer(path: &str) -> String {
    if path == "." {
        return String::new();
    }
    path.replace('~', "~0")
        .replace('/', "~1")
        .replace('[', ".")
        .replace(']', "")
        .split('.')
        .filter(|part| !part.is_empty())
        .map(|part| format!("/{part}"))
        .collect()
}

impl From<PathRejection> for Problem {
    fn from(rejection: PathRejection) -> Self {
        Self::new(rejection.status(), "INVALID_PATH", rejection.body_text())
    }
}

impl From<QueryRejection> for Problem {
    fn from(rejection: QueryRejection) -> Self {
        Self::new(rejection.status(), "INVALID_QUERY", rejection.body_text())
    }
}
