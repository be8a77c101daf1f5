//! Clients that begin and do not go on.

use std::{
    net::SocketAddr,
    sync::atomic::Ordering,
    time::{Duration, Instant},
};

use daemon::web::server::ListenerLimits;
use futures::future::join_all;
use reqwest::Method;
use testkit::{ApiClient, wait::until};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpStream,
};

use crate::harness::Harness;

/// Beginning of a request whose head has no end.
const HALF: &[u8] = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Slow: ";
/// Patience of the servers of these tests.
const PATIENCE: Duration = Duration::from_secs(2);
/// Allowance for a machine that is busy with other tests.
const SLACK: Duration = Duration::from_secs(20);

fn limits() -> ListenerLimits {
    ListenerLimits {
        head_timeout: PATIENCE,
        body_patience: PATIENCE,
        answer_patience: PATIENCE,
        ..ListenerLimits::default()
    }
}

async fn started(limits: ListenerLimits) -> (Harness, SocketAddr) {
    let harness = Harness::start_within(limits, |_, _| ()).await;
    let address = harness.api.origin().trim_start_matches("http://").parse().expect("an address");
    (harness, address)
}

async fn half_open(address: SocketAddr) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.expect("connected");
    stream.write_all(HALF).await.expect("sent");
    stream
}

/// Reads until the server closes the connection, for at most [`PATIENCE`] and the slack.
async fn rest(stream: &mut TcpStream) -> Vec<u8> {
    let mut answer = Vec::new();
    let read = tokio::time::timeout(PATIENCE + SLACK, stream.read_to_end(&mut answer));
    // A reset is an end, too.
    drop(read.await.expect("the server closes the connection"));
    answer
}

#[tokio::test]
async fn half_open_connections_are_closed_in_time_and_hold_nobody_up() {
    let (harness, address) =
        started(ListenerLimits { connections_per_client_max: 400, ..limits() }).await;
    let begun = Instant::now();
    let mut halves = join_all((0..300).map(|_| half_open(address))).await;
    assert_eq!(harness.get("/healthz").await.status(), 200, "an honest client is served meanwhile");
    join_all(halves.iter_mut().map(rest)).await;
    let lasted = begun.elapsed();
    assert!(lasted < PATIENCE + SLACK, "closed after {lasted:?}");
    // A connection of its own: the one from before is closed for its silence at this very moment.
    let client = ApiClient::new(harness.api.origin(), PATIENCE + SLACK).expect("a client");
    let answer = client.call(Method::GET, "/healthz", None).await.expect("an answer");
    assert_eq!(answer.status, 200);
}

#[tokio::test]
async fn who_asks_gets_the_place_of_those_who_do_not() {
    let few = ListenerLimits {
        connections_max: 40,
        connections_per_client_max: 20,
        head_timeout: Duration::from_secs(600),
        ..limits()
    };
    let (harness, address) = started(few).await;
    let mut halves = join_all((0..100).map(|_| half_open(address))).await;
    for _ in 0..10 {
        assert_eq!(harness.get("/healthz").await.status(), 200);
    }
    // The first ones have given way.
    join_all(halves[..70].iter_mut().map(rest)).await;
}

#[tokio::test]
async fn a_trickle_of_bytes_is_cut_in_head_and_body() {
    let (_harness, address) = started(limits()).await;
    let head = half_open(address).await;
    let mut body = TcpStream::connect(address).await.expect("connected");
    let post = "POST /api/v1/session HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
                Content-Length: 4000\r\n\r\n{";
    body.write_all(post.as_bytes()).await.expect("sent");
    let trickles = [head, body].map(|stream| async move {
        let (mut reading, mut writing) = stream.into_split();
        let trickle = tokio::spawn(async move {
            while writing.write_all(b" ").await.is_ok() {
                tokio::time::sleep(Duration::from_millis(500)).await;
            }
        });
        let mut answer = Vec::new();
        let read = tokio::time::timeout(PATIENCE + SLACK, reading.read_to_end(&mut answer));
        drop(read.await.expect("the server closes the connection"));
        trickle.abort();
        String::from_utf8_lossy(&answer).into_owned()
    });
    let [head, body] = <[String; 2]>::try_from(join_all(trickles).await).expect("two");
    assert_eq!(head, "");
    assert!(body.starts_with("HTTP/1.1 408") && body.contains("TOO_SLOW"), "{body}");
}

#[tokio::test]
async fn who_does_not_take_an_answer_is_given_up() {
    let (harness, address) = started(limits()).await;
    let mut reader = TcpStream::connect(address).await.expect("connected");
    let get = b"GET /api/v1/flood HTTP/1.1\r\nHost: localhost\r\n\r\n";
    reader.write_all(get).await.expect("sent");
    let open = || harness.memory.floods.load(Ordering::Relaxed);
    until("the answer has begun", SLACK, || open() == 1).await;
    until("it is given up", PATIENCE + SLACK, || open() == 0).await;
}

#[tokio::test]
async fn endless_heads_are_refused() {
    let (_harness, address) = started(limits()).await;
    let mut stream = half_open(address).await;
    stream.write_all(&[b'x'; 64 * 1024]).await.expect("sent");
    let answer = String::from_utf8_lossy(&rest(&mut stream).await).into_owned();
    assert!(answer.starts_with("HTTP/1.1 431"), "{answer}");
}
