//! Callers of the web interfaces that mean harm.

use std::{
    net::Ipv4Addr,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use futures::future::join_all;
use reqwest::{Method, StatusCode};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
    time::timeout,
};

use super::route::HOSTILE;
use crate::harness::Api;

/// Beginning of a request whose head has no end.
pub(super) const HALF: &[u8] = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Slow: ";
/// Time in which a server has to give up on a caller that does not go on.
const PATIENCE: Duration = Duration::from_secs(60);
/// Beginning and end of what nests.
const NESTINGS: [(&str, &str); 2] = [("[", "]"), ("{\"a\":", "}")];
/// Guesses of a password that may be checked at once.
const GUESSES_MAX: usize = 10;

/// Makes a client that waits for no answer without end.
pub(super) fn client() -> anyhow::Result<reqwest::Client> {
    Ok(reqwest::Client::builder().timeout(PATIENCE).build()?)
}

/// Tries to sign in at once under many names of half a megabyte.
pub(super) async fn long_names(port: u16) -> anyhow::Result<String> {
    let client = client()?;
    let mut statuses = Vec::new();
    for _ in 0..25 {
        let calls = (0..8).map(|number| {
            let name = format!("{number}{}", "x".repeat(500_000));
            sign_in(&client, port, name)
        });
        for status in join_all(calls).await {
            statuses.extend(status?);
        }
    }
    // Wrong credentials would say that the name was read and counted.
    let is_refused = |status: &StatusCode| {
        [StatusCode::PAYLOAD_TOO_LARGE, StatusCode::UNPROCESSABLE_ENTITY].contains(status)
    };
    anyhow::ensure!(!statuses.is_empty(), "no attempt was answered");
    anyhow::ensure!(statuses.iter().all(is_refused), "taken: {statuses:?}");
    Ok(format!("{} refused", statuses.len()))
}

/// Guesses a password sixty times at once.
pub(super) async fn guesses(port: u16) -> anyhow::Result<String> {
    let client = client()?;
    let calls = (0..60).map(|_| sign_in(&client, port, "stranger".to_owned()));
    let (mut checked, mut slowed) = (0, 0);
    for status in join_all(calls).await {
        match status? {
            Some(StatusCode::UNAUTHORIZED) => checked += 1,
            Some(StatusCode::TOO_MANY_REQUESTS | StatusCode::SERVICE_UNAVAILABLE) => slowed += 1,
            other => anyhow::bail!("answered {other:?}"),
        }
    }
    anyhow::ensure!(checked <= GUESSES_MAX, "{checked} guesses were checked");
    Ok(format!("{checked} checked, {slowed} slowed down"))
}

/// Tries to sign in. Returns no status where the server closes before it took the request.
pub(super) async fn sign_in(
    client: &reqwest::Client,
    port: u16,
    name: String,
) -> anyhow::Result<Option<StatusCode>> {
    let body = serde_json::json!({ "userName": name, "password": "a guess like others" });
    let request = client.post(format!("http://127.0.0.1:{port}/api/v1/session")).json(&body);
    match request.send().await {
        Ok(answer) => Ok(Some(answer.status())),
        Err(error) if error.is_request() || error.is_body() => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// Begins two hundred requests and does not go on.
pub(super) async fn endless_heads(port: u16) -> anyhow::Result<String> {
    let begun = Instant::now();
    let connections = (0..200).map(|_| async move {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).await?;
        stream.write_all(HALF).await?;
        closed(&mut stream).await
    });
    for closed in join_all(connections).await {
        closed?;
    }
    Ok(format!("200 closed within {:.0} s", begun.elapsed().as_secs_f64()))
}

/// Sends a body byte by byte.
pub(super) async fn endless_bodies(port: u16) -> anyhow::Result<String> {
    let post = "POST /api/v1/session HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
                Content-Length: 4000\r\n\r\n{";
    let connections = (0..50).map(|_| async move {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).await?;
        stream.write_all(post.as_bytes()).await?;
        let (mut reading, mut writing) = stream.split();
        let trickle = async {
            while writing.write_all(b" ").await.is_ok() {
                tokio::time::sleep(Duration::from_millis(500)).await;
            }
        };
        let mut answer = Vec::new();
        let read = async { timeout(PATIENCE, reading.read_to_end(&mut answer)).await.map(drop) };
        tokio::select! {
            () = trickle => {}
            read = read => read.context("the connection is held open")?,
        }
        anyhow::Ok(())
    });
    for outcome in join_all(connections).await {
        outcome?;
    }
    Ok("50 cut off".to_owned())
}

/// Sends documents that nest, as a person who is signed in.
pub(super) async fn nested_documents(api: Api, path: &str) -> anyhow::Result<String> {
    let mut statuses = Vec::new();
    for (open, close) in NESTINGS {
        let body = format!("{}1{}", open.repeat(100_000), close.repeat(100_000));
        statuses.push(api.send_text(Method::PUT, path, body).await?);
    }
    let is_refused = statuses.iter().all(StatusCode::is_client_error);
    anyhow::ensure!(is_refused, "answered {statuses:?}");
    Ok(format!("{statuses:?}"))
}

/// Tries to enrol with a token that was made up.
pub(super) async fn enrol(client: &reqwest::Client, port: u16) -> anyhow::Result<()> {
    let body = serde_json::json!({ "token": "http://127.0.0.1.made-up", "signingKey": null });
    let request = client.post(format!("http://127.0.0.1:{port}/api/v1/enrolments")).json(&body);
    let status = request.send().await?.status();
    anyhow::ensure!(status.is_client_error(), "answered {status}");
    Ok(())
}

/// Makes a client that comes from an address.
pub(super) fn client_from(source: Ipv4Addr) -> anyhow::Result<reqwest::Client> {
    Ok(reqwest::Client::builder().local_address(Some(source.into())).timeout(PATIENCE).build()?)
}

/// Sends a body that is larger than any that is taken, from an address of mean people. Fails where it is taken.
pub(super) async fn oversize(port: u16) -> anyhow::Result<()> {
    refused_body(port, vec![b' '; 16 << 20]).await
}

/// Sends documents that nest, as nobody who is signed in. Fails where one is taken.
pub(super) async fn nested_sign_ins(port: u16) -> anyhow::Result<()> {
    for (open, close) in NESTINGS {
        // As deep as the body of an operation without a session may be long, and deeper.
        for levels in [600, 100_000] {
            let body = format!("{}1{}", open.repeat(levels), close.repeat(levels));
            refused_body(port, body.into_bytes()).await?;
        }
    }
    Ok(())
}

/// Sends a body to an operation that is open to anybody. A server that takes no more of it may close before it answers.
async fn refused_body(port: u16, body: Vec<u8>) -> anyhow::Result<()> {
    let address = format!("http://127.0.0.1:{port}/api/v1/session");
    let json = ("content-type", "application/json");
    let request = client_from(HOSTILE)?.post(address).header(json.0, json.1).body(body);
    match request.send().await {
        Ok(answer) => {
            let status = answer.status();
            anyhow::ensure!(status.is_client_error(), "answered {status}");
            Ok(())
        }
        Err(error) if error.is_request() || error.is_body() => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Asks for metrics through a proxy, as another machine does.
pub(super) async fn metrics_from_elsewhere(port: u16) -> anyhow::Result<String> {
    let address = format!("http://127.0.0.1:{port}/metrics");
    let own = client()?.get(&address).send().await?;
    anyhow::ensure!(own.status().is_success(), "this machine gets {}", own.status());
    for header in ["x-forwarded-for", "forwarded", "x-real-ip", "via"] {
        let asked = client()?.get(&address).header(header, "for=192.0.2.7").send().await?;
        let status = asked.status();
        let text = asked.text().await?;
        let is_refused = status == StatusCode::FORBIDDEN && !text.contains("verbund_");
        anyhow::ensure!(is_refused, "with {header}: {status}");
    }
    Ok("403 through a proxy".to_owned())
}

/// Waits until the other end closes.
async fn closed(stream: &mut TcpStream) -> anyhow::Result<()> {
    let mut answer = Vec::new();
    // A reset is an end, too.
    drop(
        timeout(PATIENCE, stream.read_to_end(&mut answer))
            .await
            .context("the connection is held open")?,
    );
    Ok(())
}
