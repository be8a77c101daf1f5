//! A small daemon: one user, one store in memory, the real web parts.

use std::{
    collections::HashMap,
    convert::Infallible,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use async_trait::async_trait;
use axum::{
    Json,
    body::Body,
    extract::State,
    response::sse::{Event, Sse},
    routing::{get, post},
};
use axum_extra::extract::CookieJar;
use daemon::{
    telemetry::Metrics,
    web::{
        ApiJson, Problem,
        api::{self, Operations, Shell},
        client_address::TrustedProxies,
        health::Readiness,
        server::{self, ServerLimits},
        session::{
            Accounts, AccountsError, Caller, PasswordHash, PasswordHashing, PasswordPolicy,
            SessionConfig, SessionId, Sessions, SignIn, SignedIn, StoredSession,
        },
    },
};
use futures::{Stream, StreamExt as _, stream};
use parking_lot::Mutex;
use reqwest::{Method, Response};
use testkit::ApiClient;
use tokio_util::sync::CancellationToken;
use utoipa_axum::router::OpenApiRouter;

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
    /// Endless answers that are being sent.
    pub floods: Arc<AtomicUsize>,
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

async fn sign_in(
    State(sessions): State<Sessions<Memory>>,
    caller: Caller,
    ApiJson(body): ApiJson<SignIn>,
) -> Result<(CookieJar, Json<serde_json::Value>), Problem> {
    let (cookie, signed_in) = sessions.sign_in(&caller, &body).await?;
    Ok((caller.cookies.add(cookie), view(&signed_in)))
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

/// An endless answer, counted while it is being sent.
struct Flood(Arc<AtomicUsize>);

impl Drop for Flood {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

async fn flood(State(sessions): State<Sessions<Memory>>) -> Body {
    let flood = Flood(Arc::clone(&sessions.accounts().floods));
    flood.0.fetch_add(1, Ordering::Relaxed);
    Body::from_stream(stream::repeat(()).map(move |()| {
        let _counted = &flood;
        Ok::<_, Infallible>(vec![0_u8; 64 * 1024])
    }))
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
        Self::start_with(|_, _| ()).await
    }

    /// Starts with settings that differ from the usual ones.
    pub async fn start_with(
        change: impl FnOnce(&mut SessionConfig, &mut TrustedProxies),
    ) -> Self {
        Self::start_within(ServerLimits::default(), change).await
    }

    /// Starts with bounds of the server, too.
    pub async fn start_within(
        limits: ServerLimits,
        change: impl FnOnce(&mut SessionConfig, &mut TrustedProxies),
    ) -> Self {
        drop(rustls::crypto::ring::default_provider().install_default());
        let memory = Memory::default();
        let hash = PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
            .expect("long enough");
        memory.users.lock().insert("ann".into(), hash);
        let mut config = SessionConfig::new("verbund_test", false);
        config.stream_check_interval = Duration::from_millis(20);
        let mut trusted_proxies = TrustedProxies::default();
        change(&mut config, &mut trusted_proxies);
        let sessions = Sessions::new(config, memory.clone(), PasswordHashing::default());
        let readiness = Readiness::new();
        let operations = Operations {
            guarded: OpenApiRouter::new()
                .route("/live", get(live))
                .route("/session", get(who).delete(sign_out)),
            open: OpenApiRouter::new()
                .route("/session", post(sign_in))
                .route("/flood", get(flood)),
        };
        let shell = Shell {
            state: sessions.clone(),
            sessions,
            readiness: readiness.clone(),
            metrics: Metrics::install().expect("the recorder"),
            body_bytes_max: 1024 * 1024,
            has_tls: false,
            trusted_proxies,
        };
        let router = api::router::<NoPages, _, _>(operations, utoipa::openapi::OpenApi::default(), shell);
        let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
        let address = listener.local_addr().expect("bound");
        let shutdown = CancellationToken::new();
        tokio::spawn(server::serve(listener, None, router, limits, shutdown.clone()));
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
