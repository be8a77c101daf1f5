//! Slow, silent and hostile clients, which must not affect the others.

use std::time::{Duration, Instant};

use futures::future::join_all;
use opcua_stack::opcua::{client::IdentityToken, crypto::SecurityPolicy, types::StatusCode};
use rand::{Rng, RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tokio::{io::AsyncWriteExt, net::TcpStream};
use twin::TwinLimits;

use crate::{
    harness::{Client, DEADLINE, TestTwin, document, message},
    wire::{
        NO_HEADER, address, channel, chunk_header, drain, framed, get_endpoints, hello,
        open_channel, refusal,
    },
};

/// Asserts that another client still gets its answers at once.
pub async fn assert_served(client: &Client) {
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
async fn messages_before_a_sign_in_have_few_chunks() {
    let twin = TestTwin::start().await;
    let (mut stream, channel) = channel(&twin).await;
    let chunk = |sequence| {
        let body = [chunk_header(channel, sequence, 2), vec![0; 10]].concat();
        framed(b"MSGC", &body)
    };
    for sequence in 2..10 {
        stream.write_all(&chunk(sequence)).await.unwrap();
    }
    let silence = tokio::time::timeout(Duration::from_millis(300), refusal(&mut stream)).await;
    assert!(silence.is_err(), "eight are waited for");
    stream.write_all(&chunk(10)).await.unwrap();
    assert_eq!(refusal(&mut stream).await, StatusCode::BadDecodingError.bits());
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
            let body = get_endpoints(&twin.url, channel, sequence, &NO_HEADER);
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
