//! A daemon's web API as a browser would use it: signed in by cookie, changes guarded by the CSRF
//! header.

use std::time::Duration;

use anyhow::Context as _;
use reqwest::{Method, StatusCode};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use testkit::ApiClient;

/// Longest time that an answer may take.
const ANSWER_MAX: Duration = Duration::from_secs(30);

/// A signed-in client of one daemon.
#[derive(Debug, Clone)]
pub struct Api {
    client: ApiClient,
}

/// An answer that was not a success, with its problem document.
#[derive(Debug, thiserror::Error)]
#[error("{method} {path}: {status}: {problem}")]
pub struct ApiError {
    /// The method of the call.
    pub method: Method,
    pub path: String,
    pub status: StatusCode,
    /// The body, an RFC 9457 problem where the daemon answered itself.
    pub problem: Value,
}

impl Api {
    /// Makes a client that is not signed in yet; `base` as `http://127.0.0.1:8080`.
    ///
    /// # Errors
    /// When the client cannot be made.
    pub fn new(base: impl Into<String>) -> anyhow::Result<Self> {
        let client = ApiClient::new(base, ANSWER_MAX).context("making an HTTP client")?;
        Ok(Self { client })
    }

    /// Returns the address of the daemon.
    #[must_use]
    pub fn base(&self) -> &str {
        self.client.origin()
    }

    /// Signs in and keeps the session.
    ///
    /// # Errors
    /// When the daemon refuses or does not answer.
    pub async fn sign_in(&mut self, user: &str, password: &str) -> anyhow::Result<()> {
        let path = "/api/v1/session";
        let answer = self.client.sign_in(user, password).await.context("signing in")?;
        checked(Method::POST, path, answer.status, answer.text.as_bytes())
    }

    /// GET.
    ///
    /// # Errors
    /// [`ApiError`] for an answer that is not a success; transport and decoding errors.
    pub async fn get<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        self.call(Method::GET, path, None::<&()>).await
    }

    /// GET of every item of a list, page by page.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub async fn list(&self, path: &str) -> anyhow::Result<Vec<Value>> {
        let mut items = Vec::new();
        let mut page: Value = self.get(path).await?;
        loop {
            items.extend(page["items"].as_array_mut().into_iter().flat_map(std::mem::take));
            let Some(cursor) = page["nextCursor"].as_str() else { return Ok(items) };
            let separator = if path.contains('?') { '&' } else { '?' };
            page = self.get(&format!("{path}{separator}cursor={cursor}")).await?;
        }
    }

    /// GET of what is not JSON, as `/metrics`.
    ///
    /// # Errors
    /// Transport errors, and an answer that is not a success.
    pub async fn text(&self, path: &str) -> anyhow::Result<String> {
        let answer = self
            .client
            .request(Method::GET, path)
            .send()
            .await
            .with_context(|| format!("GET {path}"))?;
        Ok(answer.error_for_status()?.text().await?)
    }

    /// POST.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub async fn post<T: DeserializeOwned>(
        &self,
        path: &str,
        body: &impl Serialize,
    ) -> anyhow::Result<T> {
        self.call(Method::POST, path, Some(body)).await
    }

    /// PUT.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub async fn put<T: DeserializeOwned>(
        &self,
        path: &str,
        body: &impl Serialize,
    ) -> anyhow::Result<T> {
        self.call(Method::PUT, path, Some(body)).await
    }

    /// DELETE.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub async fn delete<T: DeserializeOwned>(&self, path: &str) -> anyhow::Result<T> {
        self.call(Method::DELETE, path, None::<&()>).await
    }

    /// Sends a text as a JSON document, whatever it is. Returns the status of the answer.
    ///
    /// # Errors
    /// Transport errors.
    pub async fn send_text(
        &self,
        method: Method,
        path: &str,
        body: String,
    ) -> anyhow::Result<StatusCode> {
        let request = self.client.request(method, path).header("content-type", "application/json");
        Ok(request.body(body).send().await?.status())
    }

    /// Opens a stream of server-sent events, without an overall timeout.
    ///
    /// # Errors
    /// When the daemon refuses or does not answer.
    pub async fn events(&self, path: &str) -> anyhow::Result<reqwest::Response> {
        let answer = self
            .client
            .request(Method::GET, path)
            .header("accept", "text/event-stream")
            .timeout(Duration::from_secs(24 * 3600))
            .send()
            .await
            .with_context(|| format!("GET {path}"))?;
        Ok(answer.error_for_status()?)
    }

    async fn call<T: DeserializeOwned>(
        &self,
        method: Method,
        path: &str,
        body: Option<&impl Serialize>,
    ) -> anyhow::Result<T> {
        let mut request = self.client.request(method.clone(), path);
        if let Some(body) = body {
            request = request.json(body);
        }
        let answer = request.send().await.with_context(|| format!("{method} {path}"))?;
        let status = answer.status();
        let bytes = answer.bytes().await.with_context(|| format!("{method} {path}"))?;
        checked(method.clone(), path, status, &bytes)?;
        let bytes: &[u8] = if bytes.is_empty() { b"null" } else { &bytes };
        serde_json::from_slice(bytes)
            .with_context(|| format!("{method} {path}: reading the answer"))
    }
}

/// Turns an answer that is not a success into an [`ApiError`].
fn checked(method: Method, path: &str, status: StatusCode, body: &[u8]) -> anyhow::Result<()> {
    if status.is_success() {
        return Ok(());
    }
    let problem = serde_json::from_slice(body).unwrap_or_else(|_| {
        Value::String(String::from_utf8_lossy(body).chars().take(300).collect())
    });
    Err(ApiError { method, path: path.to_owned(), status, problem }.into())
}
