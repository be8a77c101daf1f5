//! Serving over TLS.

use std::{
    fs::{Permissions, set_permissions},
    net::SocketAddr,
    os::unix::fs::PermissionsExt as _,
};

use axum::{Router, extract::ConnectInfo, routing::get};
use daemon::web::server::{self, ListenerLimits, TlsFiles};
use tokio_util::sync::CancellationToken;

#[tokio::test]
async fn pages_are_served_over_tls_and_silent_peers_hold_nobody_up() {
    drop(rustls::crypto::ring::default_provider().install_default());
    let folder = tempfile::tempdir().expect("a folder");
    let own = rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let files = TlsFiles {
        certificate: folder.path().join("cert.pem"),
        key: folder.path().join("key.pem"),
    };
    std::fs::write(&files.certificate, own.cert.pem()).expect("written");
    std::fs::write(&files.key, own.signing_key.serialize_pem()).expect("written");
    set_permissions(&files.key, Permissions::from_mode(0o600)).expect("ours");

    let listener = server::listen(([127, 0, 0, 1], 0).into()).await.expect("a free port");
    let port = listener.local_addr().expect("bound").port();
    let router = Router::new().route(
        "/",
        get(|ConnectInfo(peer): ConnectInfo<SocketAddr>| async move { peer.ip().to_string() }),
    );
    let shutdown = CancellationToken::new();
    let tls = files.load().expect("usable files");
    let serving = tokio::spawn(server::serve(
        listener,
        Some(tls),
        router,
        ListenerLimits { connections_max: 4, ..ListenerLimits::default() },
        shutdown.clone(),
    ));

    let mut silent = Vec::new();
    for _ in 0..10 {
        silent.push(tokio::net::TcpStream::connect(("127.0.0.1", port)).await.expect("connected"));
    }
    let root = reqwest::Certificate::from_pem(own.cert.pem().as_bytes()).expect("a certificate");
    let client = reqwest::Client::builder().tls_certs_only([root]).build().expect("a client");
    let answer = client.get(format!("https://localhost:{port}/")).send().await.expect("an answer");
    assert_eq!(answer.text().await.expect("text"), "127.0.0.1");

    drop(client);
    shutdown.cancel();
    serving.await.expect("an orderly end");
}

#[test]
fn a_key_that_others_may_read_is_refused() {
    drop(rustls::crypto::ring::default_provider().install_default());
    let folder = tempfile::tempdir().expect("a folder");
    let own = rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let (certificate, key) = (folder.path().join("cert.pem"), folder.path().join("key.pem"));
    std::fs::write(&certificate, own.cert.pem()).expect("written");
    std::fs::write(&key, own.signing_key.serialize_pem()).expect("written");
    let files = TlsFiles { certificate, key: key.clone() };
    for mode in [0o604, 0o644, 0o602] {
        set_permissions(&key, Permissions::from_mode(mode)).expect("ours");
        let refused = files.load().expect_err("refused").to_string();
        assert!(refused.contains("chmod o-rwx"), "{mode:o}: {refused}");
    }
    for mode in [0o600, 0o640, 0o400] {
        set_permissions(&key, Permissions::from_mode(mode)).expect("ours");
        assert!(files.load().is_ok(), "{mode:o}");
    }
    // Root alone gives files away.
    if std::os::unix::fs::chown(&key, Some(65_534), None).is_ok() {
        let refused = files.load().expect_err("refused").to_string();
        assert!(refused.contains("belongs to another user"), "{refused}");
    }
}

#[test]
fn a_missing_certificate_is_named() {
    let files =
        TlsFiles { certificate: "/nowhere/cert.pem".into(), key: "/nowhere/key.pem".into() };
    assert_eq!(files.load().expect_err("missing").to_string(), "cannot read /nowhere/cert.pem");
}
