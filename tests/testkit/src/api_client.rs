//! A client of a daemon's web API: a session by cookie, changes guarded by the CSRF token.

use std::time::Duration;

use reqwest::{Client, Method, RequestBuilder, Result, StatusCode};
use serde_json::{Value, json};

use crate::event_stream::EventStream;

/// Longest time that a stream of events stays open.
const STREAM_MAX: Duration = Duration::from_secs(24 * 3600);

/// Client of one daemon. Clones share the session's cookie.
#[derive(Debug, Clone)]
pub struct ApiClient {
    origin: String,
    http: Client,
    csrf_token: Option<String>,
}

/// An answer with its body as text.
#[derive(Debug)]
pub struct Answer {
    pub status: StatusCode,
    pub text: String,
}

impl Answer {
    /// Returns the body; null where it is no JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_default()
    }
}

impl ApiClient {
    /// Makes a client without a session; `origin` as `http://127.0.0.1:8080`. An answer that takes
    /// longer than `patience` is an error.
    ///
    /// # Errors
    /// When no TLS provider is installed.
    pub fn new(origin: impl Into<String>, patience: Duration) -> Result<Self> {
        let http = Client::builder().cookie_store(true).no_proxy().timeout(patience).build()?;
        Ok(Self { origin: origin.into(), http, csrf_token: None })
    }

    /// Returns the address of the daemon.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// Signs in. The session is kept if the answer is a success.
    ///
    /// # Errors
    /// When the daemon does not answer.
    pub async fn sign_in(&mut self, user_name: &str, password: &str) -> Result<Answer> {
        self.sign_in_with(&json!({ "userName": user_name, "password": password })).await
    }

    /// Signs in with a document, as with a second factor. The session is kept if the answer is a success.
    ///
    /// # Errors
    /// When the daemon does not answer.
    pub async fn sign_in_with(&mut self, body: &Value) -> Result<Answer> {
        let answer = self.call(Method::POST, "/api/v1/session", Some(body)).await?;
        if answer.status.is_success() {
            self.csrf_token = answer.json()["csrfToken"].as_str().map(str::to_owned);
        }
        Ok(answer)
    }

    /// Begins a request with the session's cookie and CSRF token.
    pub fn request(&self, method: Method, path: &str) -> RequestBuilder {
        let request = self.http.request(method, format!("{}{path}", self.origin));
        match &self.csrf_token {
            Some(token) => request.header("x-csrf-token", token),
            None => request,
        }
    }

    /// Sends a request with this JSON body and reads the whole answer.
    ///
    /// # Errors
    /// When the daemon does not answer.
    pub async fn call(&self, method: Method, path: &str, body: Option<&Value>) -> Result<Answer> {
        let request = self.request(method, path);
        let request = match body {
            Some(body) => request.json(body),
            None => request,
        };
        let response = request.send().await?;
        Ok(Answer { status: response.status(), text: response.text().await? })
    }

    /// Opens a stream of server-sent events, from the one after `last_event_id` on.
    ///
    /// # Errors
    /// When the daemon does not answer or refuses.
    pub async fn events(&self, path: &str, last_event_id: Option<&str>) -> Result<EventStream> {
        let mut request = self
            .request(Method::GET, path)
            .header("accept", "text/event-stream")
            .timeout(STREAM_MAX);
        if let Some(id) = last_event_id {
            request = request.header("last-event-id", id);
        }
        Ok(EventStream::new(request.send().await?.error_for_status()?))
    }
}
