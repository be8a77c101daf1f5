//! A small daemon: one user, one store in memory, the real web parts.

use std::{collections::HashMap, convert::Infallible, net::SocketAddr, sync::Arc, time::Duration};

use async_trait::async_trait;
use axum::{
    Json, Router,
    extract::{ConnectInfo, State},
    middleware,
    response::sse::{Event, Sse},
    routing::get,
};
use axum_extra::extract::CookieJar;
use daemon::{
    Confidential,
    telemetry::Metrics,
    web::{
        ApiJson, Problem,
        assets::with_app,
        headers::secured,
        health::{self, Readiness},
        problem::unknown_method,
        server,
        session::{
            Accounts, AccountsError, PasswordHash, PasswordPolicy, SessionConfig, SessionId,
            Sessions, SignedIn, StoredSession, require_session,
        },
    },
};
use futures::{Stream, StreamExt as _, stream};
use parking_lot::Mutex;
use reqwest::{Method, Response};
use serde::Deserialize;
use testkit::ApiClient;
use tokio_util::sync::CancellationToken;

/// Longest time that an answer may take, streams included.
const PATIENCE: Duration = Duration::from_secs(60);

/// A folder without an index.html: an app whose pages were not built.
#[derive(rust_embed::RustEmbed)]
#[folder = "tests/it/"]
struct NoPages;

#[derive(Clone, Default)]
pub struct Memory {
    pub users: Arc<Mutex<HashMap<String, PasswordHash>>>,
    pub sessions: Arc<Mutex<HashMap<String, StoredSession>>>,
}

#[async_trait]
impl Accounts for Memory {
    type Principal = String;

    async fn password_hash(&self, user_name: &str) -> Result<Option<PasswordHash>, AccountsError> {
        Ok(self.users.lock().get(user_name).cloned())
    }

    async fn principal(&self, user_name: &str) -> Result<Option<String>, AccountsError> {
        Ok(self.users.lock().contains_key(user_name).then(|| user_name.to_owned()))
    }

    async fn put_session(&self, session: &StoredSession) -> Result<(), AccountsError> {
        self.sessions.lock().insert(session.id.as_str().to_owned(), session.clone());
        Ok(())
    }

    async fn session(&self, id: &SessionId) -> Result<Option<StoredSession>, AccountsError> {
        Ok(self.sessions.lock().get(id.as_str()).cloned())
    }

    async fn delete_session(&self, id: &SessionId) -> Result<(), AccountsError> {
        self.sessions.lock().remove(id.as_str());
        Ok(())
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct SignIn {
    user_name: String,
    password: Confidential<String>,
}

async fn sign_in(
    State(sessions): State<Sessions<Memory>>,
    ConnectInfo(client): ConnectInfo<SocketAddr>,
    jar: CookieJar,
    ApiJson(body): ApiJson<SignIn>,
) -> Result<(CookieJar, Json<serde_json::Value>), Problem> {
    let (cookie, signed_in) =
        sessions.sign_in(client.ip(), &body.user_name, &body.password).await?;
    Ok((jar.add(cookie), view(&signed_in)))
}

async fn who(signed_in: SignedIn<String>) -> Json<serde_json::Value> {
    view(&signed_in)
}

async fn sign_out(
    State(sessions): State<Sessions<Memory>>,
    jar: CookieJar,
    signed_in: SignedIn<String>,
) -> Result<CookieJar, Problem> {
    Ok(jar.add(sessions.sign_out(&signed_in.session).await?))
}

/// Says something once, and is never over.
async fn live() -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    Sse::new(stream::once(async { Ok(Event::default().data("here")) }).chain(stream::pending()))
}

fn view(signed_in: &SignedIn<String>) -> Json<serde_json::Value> {
    Json(serde_json::json!({ "userName": signed_in.principal, "csrfToken": signed_in.csrf_token }))
}

pub struct Harness {
    pub api: ApiClient,
    pub readiness: Readiness,
    pub memory: Memory,
    shutdown: CancellationToken,
}

impl Harness {
    pub async fn start() -> Self {
        drop(rustls::crypto::ring::default_provider().install_default());
        let memory = Memory::default();
        let hash = PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
            .expect("long enough");
        memory.users.lock().insert("ann".into(), hash);
        let mut config = SessionConfig::new("verbund_test", false);
        config.stream_check_interval = Duration::from_millis(20);
        let sessions = Sessions::new(config, memory.clone());
        let readiness = Readiness::new();
        let guarded = get(who)
            .delete(sign_out)
            .layer(middleware::from_fn_with_state(sessions.clone(), require_session::<Memory>));
        let live = get(live)
            .layer(middleware::from_fn_with_state(sessions.clone(), require_session::<Memory>));
        let router = Router::new()
            .route("/api/v1/live", live)
            .route("/api/v1/session", guarded.post(sign_in))
            .with_state(sessions)
            .merge(health::routes(readiness.clone(), Metrics::install().expect("the recorder")))
            .method_not_allowed_fallback(unknown_method);
        let router = secured(with_app::<NoPages, ()>(router), false);
        let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
        let address = listener.local_addr().expect("bound");
        let shutdown = CancellationToken::new();
        tokio::spawn(server::serve(listener, None, router, shutdown.clone()));
        let api = ApiClient::new(format!("http://{address}"), PATIENCE).expect("a client");
        Self { api, readiness, memory, shutdown }
    }

    /// Sends a request without a body.
    pub async fn send(&self, method: Method, path: &str) -> Response {
        self.api.request(method, path).send().await.expect("an answer")
    }

    pub async fn get(&self, path: &str) -> Response {
        self.send(Method::GET, path).await
    }
}

impl Drop for Harness {
    fn drop(&mut self) {
        self.shutdown.cancel();
    }
}
