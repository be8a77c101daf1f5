//! Slow, silent and hostile clients, which must not affect the others.

use std::time::{Duration, Instant};

use futures::future::join_all;
use opcua_stack::opcua::{client::IdentityToken, crypto::SecurityPolicy, types::StatusCode};
use rand::{Rng, RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};
use twin::TwinLimits;

use crate::harness::{Client, DEADLINE, TestTwin, document, message};

fn address(twin: &TestTwin) -> String {
    twin.url.trim_start_matches("opc.tcp://").trim_end_matches('/').to_owned()
}

/// Returns a Hello message for this endpoint.
pub fn hello(url: &str, buffer_size: u32) -> Vec<u8> {
    let mut body = Vec::new();
    for number in [0, buffer_size, buffer_size, 0, 0] {
        body.extend(number.to_le_bytes());
    }
    body.extend(u32::try_from(url.len()).unwrap().to_le_bytes());
    body.extend(url.as_bytes());
    framed(b"HELF", &body)
}

/// An OpenSecureChannel request without security.
fn open_channel() -> Vec<u8> {
    let policy = b"http://opcfoundation.org/UA/SecurityPolicy#None";
    let mut body = 0_u32.to_le_bytes().to_vec();
    body.extend(u32::try_from(policy.len()).unwrap().to_le_bytes());
    body.extend(policy);
    for absent in [-1_i32, -1] {
        body.extend(absent.to_le_bytes());
    }
    // Sequence number, request id, then the request:
    // OpenSecureChannelRequest_Encoding_DefaultBinary.
    body.extend(1_u32.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend([1, 0, 0xBE, 0x01]);
    // Request header: null token, time, handle, diagnostics, null audit id, timeout, no additional
    // header.
    body.extend([0, 0]);
    body.extend(0_i64.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend([0, 0, 0]);
    // Version, issue, no security, no nonce, an hour.
    body.extend(0_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(3_600_000_u32.to_le_bytes());
    framed(b"OPNF", &body)
}

pub fn framed(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let length = u32::try_from(body.len() + 8).unwrap();
    [kind.as_slice(), &length.to_le_bytes(), body].concat()
}

/// Sends bytes on a new connection and waits for its end.
pub async fn send(twin: &TestTwin, bytes: &[u8]) {
    let mut stream = TcpStream::connect(address(twin)).await.unwrap();
    stream.write_all(bytes).await.unwrap();
    drain(&mut stream, DEADLINE).await;
}

/// Reads one frame of the server.
async fn frame(stream: &mut TcpStream) -> Vec<u8> {
    let mut header = [0; 8];
    stream.read_exact(&mut header).await.unwrap();
    let length = u32::from_le_bytes(header[4..].try_into().unwrap());
    let mut body = vec![0; length as usize - 8];
    stream.read_exact(&mut body).await.unwrap();
    [header.as_slice(), &body].concat()
}

/// Opens a channel without security, as for discovery; returns the stream and the channel's id.
async fn channel(twin: &TestTwin) -> (TcpStream, u32) {
    let mut stream = TcpStream::connect(address(twin)).await.unwrap();
    stream.write_all(&hello(&twin.url, 65_535)).await.unwrap();
    assert_eq!(&frame(&mut stream).await[..4], b"ACKF");
    stream.write_all(&open_channel()).await.unwrap();
    let opened = frame(&mut stream).await;
    assert_eq!(&opened[..4], b"OPNF");
    (stream, u32::from_le_bytes(opened[8..12].try_into().unwrap()))
}

/// Returns the header of a chunk: channel, token, sequence number, request id.
fn chunk_header(channel: u32, sequence: u32, request: u32) -> Vec<u8> {
    [channel, 1, sequence, request].iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// Reads until the peer closes or is silent. Returns the number of bytes.
async fn drain(stream: &mut TcpStream, patience: Duration) -> usize {
    let (mut total, mut buffer) = (0, [0; 4096]);
    while let Ok(Ok(count @ 1..)) = tokio::time::timeout(patience, stream.read(&mut buffer)).await {
        total += count;
    }
    total
}

/// Asserts that another client still gets its answers at once.
async fn assert_served(client: &Client) {
    let start = Instant::now();
    assert!(client.read("net#Revision").await.status().is_good());
    assert!(start.elapsed() < Duration::from_secs(2), "an answer took {:?}", start.elapsed());
}

fn roomy(limits: &mut TwinLimits) {
    limits.connections_max = 2000;
    limits.connections_per_address_max = 2000;
}

#[tokio::test]
async fn half_open_connections_are_closed_and_limited() {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.limits.connections_per_address_max = 20;
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let mut silent = Vec::new();
    for _ in 0..60 {
        silent.push(TcpStream::connect(address(&twin)).await.unwrap());
    }
    assert_served(&client).await;
    // Beyond the limit they are closed at once, the others when they have said nothing for five
    // seconds.
    let start = Instant::now();
    for mut stream in silent {
        assert!(
            tokio::time::timeout(DEADLINE, drain(&mut stream, DEADLINE)).await.is_ok(),
            "it is closed"
        );
    }
    assert!(start.elapsed() < Duration::from_secs(15));
    twin.client("otto").await.close().await;
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn giant_messages_before_a_sign_in_are_refused() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let (mut stream, channel) = channel(&twin).await;
    // Intermediate chunks without end: 1000 of 60 000 bytes would be 57 MiB.
    let mut sent = 0;
    for sequence in 2..1002_u32 {
        let mut body = chunk_header(channel, sequence, 2);
        body.resize(60_000, 0);
        if stream.write_all(&framed(b"MSGC", &body)).await.is_err() {
            break;
        }
        sent += 1;
    }
    assert!(sent < 1000, "the connection was closed after {sent} chunks");
    assert_served(&client).await;
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn sessions_that_are_never_activated_do_not_block_clients() {
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.limits.sessions_max = 5;
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    // Wrong passwords create sessions without activating them.
    for _ in 0..8 {
        let policy = opcua_stack::opcua::crypto::SecurityPolicy::Basic256Sha256;
        assert!(twin.connect("vera", "wrong", policy).await.is_err());
    }
    let mut clients = Vec::new();
    for _ in 0..5 {
        clients.push(twin.client("otto").await);
    }
    let policy = opcua_stack::opcua::crypto::SecurityPolicy::Basic256Sha256;
    let refused = twin.connect("anna", "anna-secret", policy).await.err();
    assert_eq!(refused, Some(StatusCode::BadTooManySessions));
    for client in clients {
        assert_served(&client).await;
        client.close().await;
    }
    twin.client("anna").await.close().await;
    twin.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_thousand_sessions_do_not_affect_an_existing_one() {
    const CROWD: usize = 1000;
    const AT_ONCE: usize = 50;
    const ROOM: usize = 20;
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        config.security.allow_anonymous_unencrypted = true;
        config.limits.sessions_max = ROOM;
        roomy(&mut config.limits);
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let pki = twin.folder.path().join("crowd");
    let connect =
        || Client::connect(&twin.url, pki.clone(), IdentityToken::Anonymous, SecurityPolicy::None);
    let (mut inside, mut refused) = (vec![connect().await.unwrap()], 0);
    for _ in 0..CROWD / AT_ONCE {
        for outcome in join_all((0..AT_ONCE).map(|_| connect())).await {
            match outcome {
                Ok(one) => inside.push(one),
                Err(status) => {
                    // No session is free, or another client got it between creating and activating.
                    let is_expected =
                        [StatusCode::BadTooManySessions, StatusCode::BadSessionIdInvalid];
                    assert!(is_expected.contains(&status), "{status}");
                    refused += 1;
                }
            }
        }
        assert_served(&client).await;
    }
    assert_eq!(inside.len(), ROOM - 1, "they fill the room and no more");
    assert_eq!(refused, CROWD + 1 - inside.len());
    for one in inside {
        assert_served(&one).await;
        one.close().await;
    }
    twin.client("otto").await.close().await;
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn random_bytes_do_not_affect_other_clients() {
    const SEED: u64 = 0x5EED_A51F_u64;
    let twin = TestTwin::start_with(|config| {
        config.security.trust_unknown_certificates = true;
        roomy(&mut config.limits);
    })
    .await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    println!("seed {SEED:#x}");
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let valid = [hello(&twin.url, 65_535), open_channel()].concat();
    for round in 0..400 {
        let bytes = match round % 4 {
            // Anything.
            0 => {
                let mut bytes = vec![0; random.random_range(1..4096)];
                random.fill_bytes(&mut bytes);
                bytes
            }
            // A valid beginning with some bytes changed.
            1 => {
                let mut bytes = valid.clone();
                for _ in 0..random.random_range(1..8) {
                    let at = random.random_range(0..bytes.len());
                    bytes[at] = random.random();
                }
                bytes
            }
            // A valid beginning cut off.
            2 => valid[..random.random_range(1..valid.len())].to_vec(),
            // A valid beginning, then chunks of nonsense, some with absurd lengths.
            _ => {
                let mut bytes = valid.clone();
                for _ in 0..random.random_range(1..5) {
                    let mut body = vec![0; random.random_range(0..512)];
                    random.fill_bytes(&mut body);
                    let kind = [b"MSGF", b"MSGC", b"MSGA", b"CLOF", b"OPNF", b"ERRF", b"HELF"]
                        [random.random_range(0..7)];
                    let mut chunk = framed(kind, &body);
                    if random.random_ratio(1, 4) {
                        chunk[4..8].copy_from_slice(&random.random::<u32>().to_le_bytes());
                    }
                    bytes.extend(chunk);
                }
                bytes
            }
        };
        let mut stream = TcpStream::connect(address(&twin)).await.unwrap();
        // The server may close before everything is written.
        let _ = stream.write_all(&bytes).await;
        drain(&mut stream, Duration::from_millis(2)).await;
        if round % 20 == 0 {
            assert_served(&client).await;
        }
    }
    assert_served(&client).await;
    twin.client("otto").await.close().await;
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn a_client_that_reads_no_answers_gets_no_further_ones() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    let (mut stream, channel) = channel(&twin).await;
    // GetEndpoints, whose answer is some kilobytes, again and again without reading one.
    let mut written = 0;
    let flood = async {
        for sequence in 2..200_000_u32 {
            let mut body = chunk_header(channel, sequence, sequence);
            body.extend([1, 0, 0xAC, 0x01, 0, 0]);
            body.extend(0_i64.to_le_bytes());
            body.extend(sequence.to_le_bytes());
            body.extend(0_u32.to_le_bytes());
            body.extend((-1_i32).to_le_bytes());
            body.extend(0_u32.to_le_bytes());
            body.extend([0, 0, 0]);
            body.extend(u32::try_from(twin.url.len()).unwrap().to_le_bytes());
            body.extend(twin.url.as_bytes());
            body.extend((-1_i32).to_le_bytes());
            body.extend((-1_i32).to_le_bytes());
            stream.write_all(&framed(b"MSGF", &body)).await.unwrap();
            written += 1;
        }
    };
    assert!(
        tokio::time::timeout(Duration::from_secs(5), flood).await.is_err(),
        "the server stops reading"
    );
    println!("the server read on for {written} requests");
    assert_served(&client).await;
    client.close().await;
    twin.stop().await;
}
