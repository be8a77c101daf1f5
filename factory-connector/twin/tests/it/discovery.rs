//! Discovery by a foreign discovery server, and by a foreign listener of multicast DNS.

use std::{net::TcpListener, process::Stdio, time::Duration};

use serde_json::Value;
use testkit::wait::eventually;
use tokio::{
    io::{AsyncBufReadExt, BufReader, Lines},
    process::{Child, ChildStdout, Command},
    time::{Instant, timeout_at},
};
use twin::{CertificateState, TwinConfig};

use crate::{
    foreign::{installed, repository},
    harness::TestTwin,
};

/// Time limit of an answer by a foreign program: the start of an interpreter on a busy machine is
/// slow.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running script that reports events, one line of JSON each.
struct Script {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Script {
    async fn start(name: &str, arguments: &[&str]) -> Self {
        installed().await;
        let mut child = Command::new("node")
            .arg(repository().join("tests/foreign/opcua").join(name))
            .args(arguments)
            .args(["--timeout", "120"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .kill_on_drop(true)
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut script = Self { child, lines };
        script.hear("listening").await;
        script
    }

    /// Waits for the next event of this kind; others are skipped.
    async fn hear(&mut self, event: &str) -> Value {
        self.hear_where(event, |_| true).await
    }

    async fn hear_where(&mut self, event: &str, matches: impl Fn(&Value) -> bool) -> Value {
        let deadline = Instant::now() + PATIENCE;
        let mut heard = Vec::new();
        loop {
            let line = match timeout_at(deadline, self.lines.next_line()).await {
                Ok(line) => line.unwrap().unwrap_or_else(|| panic!("it ended after {heard:?}")),
                Err(_) => panic!("no {event} within {PATIENCE:?}, but {heard:?}"),
            };
            let said: Value = serde_json::from_str(&line).unwrap();
            if said["event"] == event && matches(&said) {
                return said;
            }
            heard.push(said);
        }
    }

    async fn stop(mut self) {
        self.child.kill().await.unwrap();
    }
}

fn registering(port: u16) -> impl FnOnce(&mut TwinConfig) {
    move |config| {
        config.security.trust_unknown_certificates = true;
        config.discovery.local_discovery_server_url = Some(format!("opc.tcp://127.0.0.1:{port}"));
        config.discovery.registration_interval_s = 1;
    }
}

/// Starts without the discovery server, so that the twin has to try again. Then it registers at each
/// interval, and withdraws at the end.
async fn is_registered_by(arguments: &[&str], service: &str) {
    let folder = tempfile::tempdir().unwrap();
    let [port] = free_ports::reserve().unwrap();
    let twin = TestTwin::start_with(registering(port)).await;
    let (port, pki) = (port.to_string(), folder.path().to_str().unwrap().to_owned());
    let mut server = Script::start(
        "discovery_server.js",
        &[&[port.as_str(), "--pki", &pki], arguments].concat(),
    )
    .await;
    for _ in 0..2 {
        let registered = server.hear("registered").await;
        assert_eq!(registered["service"], service, "{registered}");
        assert_eq!(registered["serverUri"], "urn:verbund:twin:FOR_MUC");
        assert_eq!(registered["discoveryUrls"][0], twin.url.as_ref());
    }
    twin.stop().await;
    assert_eq!(server.hear("unregistered").await["serverUri"], "urn:verbund:twin:FOR_MUC");
    server.stop().await;
}

#[tokio::test]
async fn a_discovery_server_knows_the_twin_while_it_runs() {
    is_registered_by(&[], "RegisterServer2").await;
}

#[tokio::test]
async fn an_old_discovery_server_gets_register_server() {
    is_registered_by(&["--old"], "RegisterServer").await;
}

#[tokio::test]
async fn a_discovery_server_needs_an_approval_like_a_client() {
    let folder = tempfile::tempdir().unwrap();
    let [port] = free_ports::reserve().unwrap();
    let pki = folder.path().to_str().unwrap().to_owned();
    let mut server =
        Script::start("discovery_server.js", &[&port.to_string(), "--pki", &pki]).await;
    let twin = TestTwin::start_with(|config| {
        registering(port)(config);
        config.security.trust_unknown_certificates = false;
    })
    .await;
    let list = twin.handle.trust_list();
    let certificate =
        eventually("the server's certificate waits for an approval", PATIENCE, || async {
            match list.list().unwrap().pop() {
                Some(certificate) if certificate.rejection.is_some() => Ok(certificate),
                other => Err(format!("{other:?}")),
            }
        })
        .await
        .unwrap();
    let attempt = certificate.rejection.as_ref().unwrap();
    assert_eq!(attempt.address, None, "the twin called it");
    assert_eq!(certificate.state, CertificateState::Rejected);
    list.trust(&certificate.thumbprint, "anna").unwrap();
    server.hear("registered").await;
    twin.stop().await;
    server.stop().await;
}

#[tokio::test]
async fn a_silent_discovery_server_delays_nothing() {
    // It takes connections and says nothing.
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let twin = TestTwin::start_with(registering(silent.local_addr().unwrap().port())).await;
    twin.client("vera").await.close().await;
    let start = Instant::now();
    twin.stop().await;
    assert!(start.elapsed() < Duration::from_secs(10), "stopping took {:?}", start.elapsed());
}

#[tokio::test]
async fn the_twin_is_announced_by_multicast_dns_until_it_stops() {
    let mut listener = Script::start("multicast_listener.js", &["127.0.0.1"]).await;
    let announcing = |config: &mut TwinConfig| {
        config.security.trust_unknown_certificates = true;
        config.discovery.announce_by_multicast_dns = true;
    };
    // Everybody on this machine hears what other tests announce at the same time.
    let factory = format!("FOR_{}", std::process::id());
    let twin = TestTwin::start_of(&factory, announcing).await;
    let port: u16 = twin.url.trim_end_matches('/').rsplit(':').next().unwrap().parse().unwrap();
    let is_ours = |said: &Value| said["port"] == port;
    let up = listener.hear_where("up", is_ours).await;
    let name = up["name"].as_str().unwrap().to_owned();
    assert_eq!(name, format!("Verbund Twin of {factory}"), "{up}");
    assert_eq!((&up["text"]["path"], &up["text"]["caps"]), (&"/".into(), &"DA".into()), "{up}");
    assert_eq!(up["addresses"][0], "127.0.0.1", "{up}");

    // One who comes later gets an answer when it asks, and a second twin of the same name takes
    // another one.
    let asked = port.to_string();
    let mut late =
        Script::start("multicast_listener.js", &["127.0.0.1", "--ask-for", &asked]).await;
    assert_eq!(late.hear_where("up", is_ours).await["name"], name.as_str());
    late.hear_where("answered", is_ours).await;
    let second = TestTwin::start_of(&factory, announcing).await;
    let second_port: u16 =
        second.url.trim_end_matches('/').rsplit(':').next().unwrap().parse().unwrap();
    let other = late.hear_where("up", |said| said["port"] == second_port).await;
    assert_eq!(other["name"], format!("{name} (2)"), "{other}");

    twin.stop().await;
    listener.hear_where("down", is_ours).await;
    second.stop().await;
    listener.stop().await;
    late.stop().await;
}
