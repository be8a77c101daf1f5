//! Other people's AMQP 1.0 clients on the broker: Qpid Proton (C, Python) and rhea (JavaScript).

use std::{path::PathBuf, process::Stdio};

use broker::{BrokerUser, Carrier};
use serde_json::Value;
use tokio::process::Command;

use crate::support::{SECRET, TestBroker, certificate, pattern, queue, with_websockets};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/foreign")
        .canonicalize()
        .expect("the foreign peers")
}

async fn set_up() {
    let status = Command::new(folder().join("setup.sh")).status().await.expect("setup.sh runs");
    assert!(
        status.success(),
        "tests/foreign/setup.sh failed; tools/prerequisites.sh test installs what it needs"
    );
}

async fn talk(program: PathBuf, arguments: &[String], roots: Option<&str>) -> Value {
    let output = Command::new(program)
        .args(arguments)
        // The WebSocket of Node takes no roots of its own.
        .envs(roots.map(|roots| ("NODE_EXTRA_CA_CERTS", roots)))
        .stdin(Stdio::null())
        .kill_on_drop(true)
        .output()
        .await
        .expect("the peer runs");
    let (out, err) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "the peer failed: {out}\n{err}");
    serde_json::from_str(out.lines().last().unwrap_or_default()).expect("one JSON object")
}

async fn broker(is_encrypted: bool) -> (tempfile::TempDir, TestBroker, Option<String>) {
    set_up().await;
    let temporary = tempfile::tempdir().expect("a folder");
    let (identity, root) = certificate();
    let broker = TestBroker::start_with(temporary.path(), |config| {
        config.limits.message_bytes_max = 100_000;
        if is_encrypted {
            config.listeners[0].tls = Some(identity);
        }
        with_websockets(config);
    })
    .await;
    broker.declare("tool.t1.reports").await;
    broker.declare("factory.f2.requests").await;
    let user = BrokerUser::with_secret(SECRET.as_bytes())
        .may_consume(pattern("tool.t1.reports"))
        .may_produce(pattern("tool.t1.reports"));
    broker.users.put("t1", user);
    let roots = temporary.path().join("roots.pem");
    std::fs::write(&roots, &root).expect("written");
    let roots = is_encrypted.then(|| roots.display().to_string());
    (temporary, broker, roots)
}

async fn proton(is_encrypted: bool) {
    let (_temporary, broker, roots) = broker(is_encrypted).await;
    let scheme = if is_encrypted { "amqps" } else { "amqp" };
    let mut arguments = vec![
        folder().join("amqp/proton_client.py").display().to_string(),
        format!("{scheme}://localhost:{}", broker.port()),
        "t1".to_owned(),
        SECRET.to_owned(),
        "tool.t1.reports".to_owned(),
        "factory.f2.requests".to_owned(),
    ];
    arguments.extend(roots);
    let python = folder().join("../../target/foreign/python/bin/python");
    let seen = talk(python, &arguments, None).await;
    assert_eq!(seen["principal"], "t1", "a forged principal is replaced");
    assert_eq!((&seen["durable"], &seen["body"]), (&Value::Bool(true), &Value::from("{}")));
    assert_eq!(seen["order"], serde_json::json!(["p0", "p1", "p2"]));
    for (what, expected) in [
        ("oversize", "amqp:link:message-size-exceeded"),
        ("forbiddenSender", "amqp:unauthorized-access"),
        ("forbiddenReceiver", "amqp:unauthorized-access"),
        ("badPassword", "amqp:unauthorized-access"),
    ] {
        let condition = seen[what].as_str().unwrap_or_default();
        assert!(condition.contains(expected), "{what}: {condition}");
    }
    let letters = broker.handle.dead_letters(0, 10).await.expect("dead letters");
    assert_eq!(letters.iter().map(|l| l.message_id.as_deref()).collect::<Vec<_>>(), [Some("p1")]);
    assert_eq!(broker.ready("tool.t1.reports"), 1, "the last one waits");
    broker.stop().await;
}

async fn rhea(is_encrypted: bool, carrier: Carrier) {
    let (_temporary, broker, roots) = broker(is_encrypted).await;
    let scheme = if is_encrypted { "wss" } else { "ws" };
    let address = match carrier {
        Carrier::Stream => broker.port().to_string(),
        Carrier::WebSocket => format!("{scheme}://localhost:{}/amqp", broker.websocket_port()),
    };
    let mut arguments = vec![
        "--experimental-websocket".to_owned(),
        folder().join("amqp/rhea_client.js").display().to_string(),
        address,
        "t1".to_owned(),
        SECRET.to_owned(),
        "tool.t1.reports".to_owned(),
        "factory.f2.requests".to_owned(),
    ];
    arguments.extend(roots.clone());
    let seen = talk(PathBuf::from("node"), &arguments, roots.as_deref()).await;
    assert_eq!(seen["accepted"], 3);
    assert_eq!(seen["principal"], "t1");
    let mut received: Vec<_> =
        seen["received"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    received.sort_unstable();
    assert_eq!(received, ["r0", "r1", "r2"]);
    assert_eq!(
        seen["refused"],
        serde_json::json!({ "sender": "amqp:unauthorized-access", "receiver": "amqp:unauthorized-access" })
    );
    let status = broker.handle.queue(&queue("tool.t1.reports")).expect("the queue");
    assert_eq!(status.ready + status.unsettled, 0);
    broker.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn proton_speaks_with_the_broker() {
    proton(false).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn proton_speaks_with_the_broker_over_tls() {
    proton(true).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn rhea_speaks_with_the_broker() {
    rhea(false, Carrier::Stream).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn rhea_speaks_with_the_broker_over_tls() {
    rhea(true, Carrier::Stream).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn rhea_speaks_with_the_broker_in_a_websocket() {
    rhea(false, Carrier::WebSocket).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn rhea_speaks_with_the_broker_in_an_encrypted_websocket() {
    rhea(true, Carrier::WebSocket).await;
}
