//! A small daemon: one user, one store in memory, the real web parts.

use std::{
    convert::Infallible,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use axum::{
    Json,
    body::Body,
    extract::State,
    http::StatusCode,
    middleware::from_fn,
    response::sse::{Event, Sse},
    routing::{delete, get, post, put},
};
use axum_extra::extract::CookieJar;
use daemon::{
    sealing::{Sealer, SealingConfig},
    telemetry::Metrics,
    web::{
        ApiJson, ApiPath, Problem,
        api::{self, Operations, Shell},
        client_address::TrustedProxies,
        health::Readiness,
        server::{self, ListenerLimits},
        session::{
            self, AccountChange, Caller, NewPasskey, OwnPasskeys, PasskeyBegin, PasskeyList,
            PasskeyOffer, PasskeyRemoval, PasswordChange, PasswordHash, PasswordHashing,
            PasswordPolicy, RecoveryCodes, SecondFactorBegin, SecondFactorCode, SecondFactorOffer,
            SecondFactorRemoval, SessionConfig, SessionList, Sessions, SignIn, SignedIn,
        },
        shares::{OwnTurns, hold_download, hold_stream, in_turn},
    },
};
use futures::{Stream, StreamExt as _, stream};
use reqwest::{Method, Response};
use testkit::ApiClient;
use tokio_util::sync::CancellationToken;
use utoipa_axum::router::OpenApiRouter;

use crate::memory::Memory;

/// Longest time that an answer may take, streams included.
const PATIENCE: Duration = Duration::from_secs(60);

/// Address of the pages for browsers: passkeys need a domain.
pub const PAGES: &str = "http://localhost:8080";

/// A folder without an index.html: an app whose pages were not built.
#[derive(rust_embed::RustEmbed)]
#[folder = "tests/it/"]
struct NoPages;

async fn sign_in(
    State(sessions): State<Sessions<Memory>>,
    caller: Caller,
    ApiJson(body): ApiJson<SignIn>,
) -> Result<(CookieJar, Json<serde_json::Value>), Problem> {
    let (cookie, signed_in) = session::sign_in(&sessions, &caller, &body).await?;
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
    Ok(jar.add(sessions.sign_out(&signed_in).await?))
}

async fn list_sessions(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
) -> Result<Json<SessionList>, Problem> {
    Ok(Json(sessions.list(&who.user_name, &who.session).await?))
}

async fn end_session(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    ApiPath(id): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    sessions
        .end(&who.user_name, &id, AccountChange { by: &who.user_name, operation: "endSession" })
        .await?;
    Ok(StatusCode::NO_CONTENT)
}

async fn change_password(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    caller: Caller,
    ApiJson(body): ApiJson<PasswordChange>,
) -> Result<StatusCode, Problem> {
    sessions.change_password(&caller, &who, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

async fn begin_factor(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorBegin>,
) -> Result<Json<SecondFactorOffer>, Problem> {
    Ok(Json(sessions.begin_second_factor(&caller, &who, body).await?))
}

async fn confirm_factor(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    ApiJson(body): ApiJson<SecondFactorCode>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(sessions.confirm_second_factor(&who, &body).await?))
}

async fn remove_factor(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    caller: Caller,
    ApiJson(body): ApiJson<SecondFactorRemoval>,
) -> Result<StatusCode, Problem> {
    sessions.remove_second_factor(&caller, &who, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

async fn list_passkeys(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
) -> Result<Json<PasskeyList>, Problem> {
    Ok(Json(OwnPasskeys::of(&sessions, &who.user_name).list().await?))
}

async fn begin_passkey(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    caller: Caller,
    ApiJson(body): ApiJson<PasskeyBegin>,
) -> Result<Json<PasskeyOffer>, Problem> {
    Ok(Json(OwnPasskeys::of(&sessions, &who.user_name).begin(&caller, &who.session, body).await?))
}

async fn add_passkey(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    ApiJson(body): ApiJson<NewPasskey>,
) -> Result<Json<RecoveryCodes>, Problem> {
    Ok(Json(OwnPasskeys::of(&sessions, &who.user_name).add(&body).await?))
}

async fn remove_passkey(
    State(sessions): State<Sessions<Memory>>,
    who: SignedIn<String>,
    caller: Caller,
    ApiPath(passkey_id): ApiPath<String>,
    ApiJson(body): ApiJson<PasskeyRemoval>,
) -> Result<StatusCode, Problem> {
    let passkeys = OwnPasskeys::of(&sessions, &who.user_name);
    passkeys.remove(&caller, &who.session, &passkey_id, body).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Reads by one of the store's readers, for a moment.
async fn page(State(sessions): State<Sessions<Memory>>) -> &'static str {
    let _reader = sessions.accounts().readers.0.acquire().await.expect("it is never closed");
    "read"
}

/// Reads by one of the store's readers, until nobody waits for the answer.
async fn endless_page(State(sessions): State<Sessions<Memory>>) -> &'static str {
    let _reader = sessions.accounts().readers.0.acquire().await.expect("it is never closed");
    std::future::pending().await
}

/// Changes something, and answers with what was sent.
async fn change_page(body: String) -> String {
    body
}

/// Begins in a turn, and reads its next portion by one of the store's readers, in another one, until nobody waits for it.
async fn endless_export(
    State(sessions): State<Sessions<Memory>>,
    turns: OwnTurns,
) -> Result<Body, Problem> {
    let readers = Arc::clone(&sessions.accounts().readers.0);
    let (turn, turns) = turns.to_begin().await?;
    drop(turn);
    Ok(Body::from_stream(stream::once(async move {
        let _turn = turns.to_read().await;
        let _reader = readers.acquire_owned().await.expect("it is never closed");
        std::future::pending::<Result<&'static str, Infallible>>().await
    })))
}

/// Says something once, and is never over.
async fn live() -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    Sse::new(stream::once(async { Ok(Event::default().data("here")) }).chain(stream::pending()))
}

/// Sends the beginning of a file, and never its end.
async fn export() -> Body {
    let begin = stream::once(async { Ok::<_, Infallible>("begin") });
    Body::from_stream(begin.chain(stream::pending()))
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
    /// Folder of the key that seals secrets of second factors.
    pub keys: Arc<tempfile::TempDir>,
    shutdown: CancellationToken,
}

impl Harness {
    pub async fn start() -> Self {
        Self::start_with(|_, _| ()).await
    }

    /// Starts with settings that differ from the usual ones.
    pub async fn start_with(change: impl FnOnce(&mut SessionConfig, &mut TrustedProxies)) -> Self {
        Self::start_within(ListenerLimits::default(), change).await
    }

    /// Starts with bounds of the server, too.
    pub async fn start_within(
        limits: ListenerLimits,
        change: impl FnOnce(&mut SessionConfig, &mut TrustedProxies),
    ) -> Self {
        Self::start_on(Memory::default(), limits, change).await
    }

    /// Starts on accounts of before.
    pub async fn start_on(
        memory: Memory,
        limits: ListenerLimits,
        change: impl FnOnce(&mut SessionConfig, &mut TrustedProxies),
    ) -> Self {
        drop(rustls::crypto::ring::default_provider().install_default());
        let hash = PasswordHash::of(&"correct horse".into(), PasswordPolicy::default())
            .expect("long enough");
        memory.users.lock().insert("ann".into(), hash);
        let mut config = SessionConfig::new("verbund_test", "Verbund test", false, 8080, PAGES);
        config.stream_check_interval = Duration::from_millis(20);
        let mut trusted_proxies = TrustedProxies::default();
        change(&mut config, &mut trusted_proxies);
        let keys = Arc::new(tempfile::tempdir().expect("a folder"));
        let sealer = Sealer::new(&SealingConfig::default(), keys.path());
        let sessions = Sessions::new(config, memory.clone(), PasswordHashing::default(), sealer);
        let readiness = Readiness::new();
        let operations = Operations {
            guarded: OpenApiRouter::new()
                .route("/page", get(page).put(change_page).layer(from_fn(in_turn)))
                .route("/page/endless", get(endless_page).layer(from_fn(in_turn)))
                .route("/live", get(live).layer(from_fn(hold_stream)))
                .route("/export", get(export).layer(from_fn(hold_download)))
                .route("/export/endless", get(endless_export).layer(from_fn(hold_download)))
                .route("/session", get(who).delete(sign_out))
                .route("/session/password", put(change_password))
                .route("/session/second-factor", post(begin_factor).put(confirm_factor))
                .route("/session/second-factor/removal", post(remove_factor))
                .route("/session/passkeys", get(list_passkeys).post(begin_passkey).put(add_passkey))
                .route("/session/passkeys/{passkey_id}/removal", post(remove_passkey))
                .route("/sessions", get(list_sessions))
                .route("/sessions/{session_id}", delete(end_session)),
            open: OpenApiRouter::new().route("/session", post(sign_in)).route("/flood", get(flood)),
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
        let router =
            api::router::<NoPages, _, _>(operations, utoipa::openapi::OpenApi::default(), shell);
        let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
        let address = listener.local_addr().expect("bound");
        let shutdown = CancellationToken::new();
        tokio::spawn(server::serve(listener, None, router, limits, shutdown.clone()));
        let api = ApiClient::new(format!("http://{address}"), PATIENCE).expect("a client");
        Self { api, readiness, memory, keys, shutdown }
    }

    /// Signs a new person in, by a client of its own.
    pub async fn person(&self, user_name: &str) -> ApiClient {
        let hash = self.memory.users.lock()["ann"].clone();
        self.memory.users.lock().insert(user_name.to_owned(), hash);
        let mut client = ApiClient::new(self.api.origin(), PATIENCE).expect("a client");
        let answer = client.sign_in(user_name, "correct horse").await.expect("an answer");
        assert_eq!(answer.status, StatusCode::OK, "{}", answer.text);
        client
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
