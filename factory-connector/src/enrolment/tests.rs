use std::{net::SocketAddr, sync::Arc};

use axum::{
    Json, Router,
    extract::State,
    http::{StatusCode, header},
    response::IntoResponse as _,
    routing::post,
};
use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use daemon::{
    certificate_pin::CertificatePin,
    web::server::{self, ListenerLimits},
};
use parking_lot::Mutex;
use rcgen::{CertificateParams, KeyPair};
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use serde_json::{Value, json};
use tempfile::TempDir;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio_util::sync::{CancellationToken, DropGuard};

use super::*;

/// A platform that answers one way and notes the tokens that it got.
struct Platform {
    address: SocketAddr,
    certificate: Option<CertificateDer<'static>>,
    tokens: Arc<Mutex<Vec<Value>>>,
    signing_keys: Arc<Mutex<Vec<Value>>>,
    _stop: DropGuard,
}

#[derive(Clone)]
struct Script {
    tokens: Arc<Mutex<Vec<Value>>>,
    signing_keys: Arc<Mutex<Vec<Value>>>,
    broker_url: &'static str,
    redirected_to: Option<String>,
}

impl Platform {
    async fn start(broker_url: &'static str, has_tls: bool, redirected_to: Option<String>) -> Self {
        rustls::crypto::ring::default_provider().install_default().ok();
        let (tokens, signing_keys) = (Arc::default(), Arc::default());
        let script = Script {
            tokens: Arc::clone(&tokens),
            signing_keys: Arc::clone(&signing_keys),
            broker_url,
            redirected_to,
        };
        let router = Router::new().route("/api/v1/enrolments", post(answer)).with_state(script);
        let listener =
            server::listen("127.0.0.1:0".parse().expect("an address")).await.expect("a port");
        let address = listener.local_addr().expect("bound");
        let (mut tls, mut certificate) = (None, None);
        if has_tls {
            let key = KeyPair::generate().expect("a key");
            let params =
                CertificateParams::new(vec!["somewhere.example".to_owned()]).expect("a name");
            let own = params.self_signed(&key).expect("signed").der().clone();
            let key = PrivateKeyDer::Pkcs8(key.serialize_der().into());
            tls = Some(server::server_config(vec![own.clone()], key).expect("a server"));
            certificate = Some(own);
        }
        let stop = CancellationToken::new();
        let shutdown = stop.clone();
        tokio::spawn(server::serve(listener, tls, router, ListenerLimits::default(), shutdown));
        Self { address, certificate, tokens, signing_keys, _stop: stop.drop_guard() }
    }

    fn token(&self, pin: Option<CertificatePin>) -> Confidential<String> {
        let scheme = if self.certificate.is_some() { "https" } else { "http" };
        let address = URL_SAFE_NO_PAD.encode(format!("{scheme}://{}", self.address));
        let pin = pin.map(|pin| format!("{pin}.")).unwrap_or_default();
        format!("{address}.{pin}secret").into()
    }

    fn count(&self) -> usize {
        self.tokens.lock().len()
    }
}

async fn answer(State(script): State<Script>, Json(body): Json<Value>) -> axum::response::Response {
    script.tokens.lock().push(body["token"].clone());
    script.signing_keys.lock().push(body["signingKey"].clone());
    if let Some(elsewhere) = script.redirected_to {
        return (StatusCode::TEMPORARY_REDIRECT, [(header::LOCATION, elsewhere)]).into_response();
    }
    let answer = json!({
        "factoryId": "F", "brokerUrl": script.broker_url, "profile": "embedded",
        "userName": "factory.F", "password": "canary", "rootCertificatePem": null,
    });
    (StatusCode::CREATED, Json(answer)).into_response()
}

fn config() -> (TempDir, ConnectorConfig) {
    let folder = tempfile::tempdir().expect("a folder");
    let data_directory = folder.path().join("data");
    (folder, ConnectorConfig { data_directory, ..ConnectorConfig::default() })
}

async fn stored(config: &ConnectorConfig) -> Option<Enrolment> {
    let mut session = Store::connect(&config.data_directory).await.expect("a store");
    session.enrolments().current().await.expect("read")
}

#[tokio::test]
async fn the_password_is_stored_sealed() {
    let platform = Platform::start("amqps://broker.example", false, None).await;
    let (_folder, config) = config();
    enrol(&config, None, &platform.token(None)).await.expect("enrolled");
    let enrolled = stored(&config).await.expect("stored");
    let opened = passwords::of_broker(&config.sealer(), &enrolled).expect("opens");
    assert_eq!(opened.expose(), "canary");
    let file = std::fs::read(config.data_directory.join("connector.sqlite-wal"))
        .or_else(|_| std::fs::read(config.data_directory.join("connector.sqlite")))
        .expect("a store");
    assert!(!file.windows(6).any(|window| window == b"canary"));
}

#[tokio::test]
async fn a_connector_names_the_key_with_which_it_signs() {
    let platform = Platform::start("amqps://broker.example", false, None).await;
    let (_folder, config) = config();
    for _ in 0..2 {
        enrol(&config, None, &platform.token(None)).await.expect("enrolled");
    }
    let key = ledger_key::existing(&config.data_directory.join(LEDGER_KEY_FILE)).expect("read");
    let key = PublicKey::from_bytes(&key.expect("made").public()).expect("a key").to_string();
    assert_eq!(*platform.signing_keys.lock(), [json!(key), json!(key)], "it stays the same");
}

#[tokio::test]
async fn a_token_follows_no_redirect() {
    let other = Platform::start("amqps://broker.example", false, None).await;
    let elsewhere = format!("http://{}/api/v1/enrolments", other.address);
    let platform = Platform::start("amqps://broker.example", false, Some(elsewhere)).await;
    let (_folder, config) = config();
    let refused = enrol(&config, None, &platform.token(None)).await.expect_err("a redirect");
    assert!(refused.to_string().contains("--platform"), "{refused}");
    assert_eq!((platform.count(), other.count()), (1, 0));
}

#[tokio::test]
async fn a_named_broker_without_tls_is_refused_and_nothing_is_stored() {
    let platform = Platform::start("amqp://broker.example", false, None).await;
    let (_folder, mut config) = config();
    let refused = enrol(&config, None, &platform.token(None)).await.expect_err("without TLS");
    assert!(refused.to_string().contains("broker.allow_plaintext"), "{refused}");
    assert!(stored(&config).await.is_none());
    config.broker.allow_plaintext = true;
    enrol(&config, None, &platform.token(None)).await.expect("allowed by name");
}

#[tokio::test]
async fn no_token_goes_to_another_machine_without_tls() {
    let (_folder, config) = config();
    let token: Confidential<String> = "secret".into();
    let refused = enrol(&config, Some("http://192.0.2.1"), &token).await.expect_err("without TLS");
    assert!(refused.to_string().contains("enrolment.allow_plaintext"), "{refused}");
}

#[tokio::test]
async fn a_token_goes_to_the_platform_that_made_it_alone() {
    let platform = Platform::start("amqps://broker.example", true, None).await;
    let impostor = Platform::start("amqps://broker.example", true, None).await;
    let pin = platform.certificate.as_ref().map(CertificatePin::of);
    let (_folder, config) = config();
    let address = format!("https://{}", impostor.address);
    let refused =
        enrol(&config, Some(&address), &platform.token(pin)).await.expect_err("an impostor");
    assert!(refused.to_string().contains("new token"), "{refused}");
    assert_eq!(impostor.count(), 0, "it never saw the token");
    let plain = Platform::start("amqps://broker.example", false, None).await;
    let address = format!("http://{}", plain.address);
    let refused = enrol(&config, Some(&address), &platform.token(pin)).await.expect_err("no TLS");
    assert!(refused.to_string().contains("shows none"), "{refused}");
    assert_eq!(plain.count(), 0, "what shows no certificate never saw it either");
    enrol(&config, None, &platform.token(pin)).await.expect("the right one");
    assert_eq!(platform.count(), 1);
}

#[tokio::test]
async fn an_answer_without_end_is_left() {
    rustls::crypto::ring::default_provider().install_default().ok();
    for status in ["201 Created", "403 Forbidden"] {
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("bound");
        let sending = tokio::spawn(async move {
            let (mut stream, _) = listener.accept().await.expect("a connector");
            let mut request = [0; 4096];
            assert!(stream.read(&mut request).await.expect("a request") > 0);
            let head = format!("HTTP/1.1 {status}\r\nTransfer-Encoding: chunked\r\n\r\n");
            stream.write_all(head.as_bytes()).await.expect("sent");
            let part = [b"1000\r\n".as_slice(), &[b' '; 0x1000], b"\r\n"].concat();
            let mut sent = 0_usize;
            while stream.write_all(&part).await.is_ok() {
                sent += part.len();
            }
            sent
        });
        let (_folder, config) = config();
        let token = Confidential::from("secret".to_owned());
        let refused = enrol(&config, Some(&format!("http://{address}")), &token).await;
        let refused = refused.expect_err("it has no end").to_string();
        let is_left = refused.contains("longer than") || refused.contains("no reason");
        assert!(is_left, "{refused}");
        let sent = sending.await.expect("it ends");
        assert!(sent < 16 << 20, "{sent} bytes were taken");
    }
}
