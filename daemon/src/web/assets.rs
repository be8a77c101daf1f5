//! A single-page app out of the executable.
//!
//! Vite names what it builds by its content and puts it under `assets/`, so that such files may be
//! cached for ever while `index.html` is requested each time. Paths without a file are routes inside
//! the app and get `index.html`.

use std::borrow::Cow;

use axum::{
    Router,
    http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header},
    response::{IntoResponse, Response},
};
use bytes::Bytes;
use rust_embed::{EmbeddedFile, RustEmbed};

use super::{compressed::FixedBody, problem::Problem};

const INDEX: &str = "index.html";

/// Answers everything that no route answers: files of the app, its places, or a problem under
/// `/api`.
pub fn with_app<E: RustEmbed + 'static, S: Clone + Send + Sync + 'static>(
    router: Router<S>,
) -> Router<S> {
    router.fallback(|method: Method, uri: Uri, headers: HeaderMap| async move {
        answer(&method, uri.path(), &headers, E::get).unwrap_or_else(|| {
            Problem::new(
                StatusCode::NOT_FOUND,
                "UNKNOWN_ROUTE",
                format!(
                    "There is no {} here; /api/v1/openapi.json lists what there is.",
                    uri.path()
                ),
            )
            .into_response()
        })
    })
}

fn answer(
    method: &Method,
    path: &str,
    headers: &HeaderMap,
    get: impl Fn(&str) -> Option<EmbeddedFile>,
) -> Option<Response> {
    if !matches!(*method, Method::GET | Method::HEAD) || path == "/api" || path.starts_with("/api/")
    {
        return None;
    }
    let path = path.trim_start_matches('/');
    let (name, file) = match get(path) {
        Some(file) if !path.is_empty() => (path, file),
        // A missing script or image is missing; a place in the app has no dot in its last part.
        _ if path.rsplit('/').next().is_some_and(|last| last.contains('.')) => return None,
        _ => match get(INDEX) {
            Some(file) => (INDEX, file),
            None => {
                return Some(
                    Problem::unavailable(
                        "NO_PAGES",
                        "The pages were not built into this executable; `make build` builds web/ first.",
                    )
                    .into_response(),
                );
            }
        },
    };
    Some(serve(name, &file, headers))
}

fn serve(name: &str, file: &EmbeddedFile, headers: &HeaderMap) -> Response {
    let tag = format!("\"{}\"", hex::encode(&file.metadata.sha256_hash()[..16]));
    let caching = if name.starts_with("assets/") {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    };
    let is_known =
        headers.get(header::IF_NONE_MATCH).is_some_and(|known| known.as_bytes() == tag.as_bytes());
    let mut response = if is_known {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        let bytes = match &file.data {
            Cow::Borrowed(bytes) => Bytes::from_static(bytes),
            Cow::Owned(bytes) => Bytes::copy_from_slice(bytes),
        };
        let body = FixedBody::with_digest(bytes, file.metadata.sha256_hash());
        let (encoding, bytes) = body.for_client(headers);
        let mut response = (encoding, bytes).into_response();
        let mime = mime_guess::from_path(name).first_or_octet_stream();
        let mime = if mime.type_() == "text" {
            format!("{mime}; charset=utf-8")
        } else {
            mime.to_string()
        };
        if let Ok(mime) = HeaderValue::from_str(&mime) {
            response.headers_mut().insert(header::CONTENT_TYPE, mime);
        }
        response
    };
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static(caching));
    if let Ok(tag) = HeaderValue::from_str(&tag) {
        response.headers_mut().insert(header::ETAG, tag);
    }
    response
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use rust_embed::Metadata;

    use super::*;

    fn files(path: &str) -> Option<EmbeddedFile> {
        ["index.html", "assets/app-1.js", "favicon.svg"].contains(&path).then(|| EmbeddedFile {
            data: Cow::Borrowed(b"content"),
            metadata: Metadata::__rust_embed_new([7; 32], None, None),
        })
    }

    fn check(path: &str, expected: Option<(StatusCode, &str, &str)>) {
        let response = answer(&Method::GET, path, &HeaderMap::new(), files);
        let found = response.as_ref().map(|response| {
            let header = |name| {
                response.headers().get(name).and_then(|value: &HeaderValue| value.to_str().ok())
            };
            (
                response.status(),
                header(header::CONTENT_TYPE).unwrap_or_default(),
                header(header::CACHE_CONTROL).unwrap_or_default(),
            )
        });
        assert_eq!(found, expected, "{path}");
    }

    #[test]
    fn files_places_and_the_rest() {
        let index = Some((StatusCode::OK, "text/html; charset=utf-8", "no-cache"));
        check("/", index);
        check("/index.html", index);
        check("/networks/frame-4711", index);
        let immutable = "public, max-age=31536000, immutable";
        check(
            "/assets/app-1.js",
            Some((StatusCode::OK, "text/javascript; charset=utf-8", immutable)),
        );
        check("/favicon.svg", Some((StatusCode::OK, "image/svg+xml", "no-cache")));
        check("/assets/gone-2.js", None);
        check("/api/v1/nothing", None);
    }

    #[test]
    fn a_known_tag_saves_the_body() {
        let mut headers = HeaderMap::new();
        let first = answer(&Method::GET, "/", &headers, files).expect("the index");
        headers.insert(header::IF_NONE_MATCH, first.headers()[header::ETAG].clone());
        let second = answer(&Method::GET, "/", &headers, files).expect("the index");
        assert_eq!(second.status(), StatusCode::NOT_MODIFIED);
    }
}
