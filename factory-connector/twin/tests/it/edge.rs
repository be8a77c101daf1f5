//! Messages that anybody on the network can send: sizes, policies, nesting and lengths, each refused before it costs anything.

use std::time::{Duration, Instant};

use opcua_stack::opcua::{
    crypto::{CertificateStore, SecurityPolicy},
    types::StatusCode,
};
use tokio::{io::AsyncWriteExt, net::TcpStream};

use crate::{
    harness::{DEADLINE, TestTwin, document, message},
    hostile::assert_served,
    wire::{
        address, channel, claiming, frame, framed, get_endpoints, hello, nested_header,
        open_channel, opening, refusal,
    },
};

#[tokio::test]
async fn a_message_that_claims_more_than_the_receive_buffer_is_refused_by_its_header() {
    let twin = TestTwin::start().await;
    for (kind, size) in [
        (b"HELF", u32::MAX),
        (b"HELF", 8193),
        (b"ACKF", u32::MAX),
        (b"MSGF", u32::MAX),
        (b"OPNF", 65_537),
    ] {
        let mut stream = TcpStream::connect(address(&twin)).await.unwrap();
        stream.write_all(&claiming(kind, size)).await.unwrap();
        assert_eq!(refusal(&mut stream).await, StatusCode::BadTcpMessageTooLarge.bits(), "{size}");
    }
    // The same on a channel, which anybody can open without security.
    for size in [65_536 + 1, 1 << 30, u32::MAX] {
        let (mut stream, _) = channel(&twin).await;
        stream.write_all(&claiming(b"MSGC", size)).await.unwrap();
        assert_eq!(refusal(&mut stream).await, StatusCode::BadTcpMessageTooLarge.bits(), "{size}");
    }
    twin.stop().await;
}

#[tokio::test]
async fn what_is_claimed_is_not_buffered() {
    let twin = TestTwin::start().await;
    let (mut stream, _) = channel(&twin).await;
    stream.write_all(&claiming(b"MSGF", u32::MAX)).await.unwrap();
    // Before, the server read on without end.
    let mut taken = 0;
    let block = vec![0; 1 << 20];
    for _ in 0..64 {
        if stream.write_all(&block).await.is_err() {
            break;
        }
        taken += block.len();
    }
    assert!(taken < 32 << 20, "the server took {taken} bytes");
    twin.stop().await;
}

#[tokio::test]
async fn whatever_is_wrong_with_a_request_for_a_channel_the_answer_and_its_time_are_the_same() {
    let twin = TestTwin::start().await;
    twin.client("vera").await.close().await;
    let sender = std::fs::read(twin.folder.path().join("client-vera/own/cert.der")).unwrap();
    let own = CertificateStore::read_cert(&twin.folder.path().join("pki/own/cert.der")).unwrap();
    let receiver = own.thumbprint().value().to_vec();
    let uri = |name: &str| format!("http://opcfoundation.org/UA/SecurityPolicy#{name}");
    let offered = SecurityPolicy::Basic256Sha256.to_uri().to_owned();
    for (what, bytes) in [
        ("PKCS#1 v1.5", opening(&uri("Basic128Rsa15"), &sender, &receiver, 256)),
        ("deprecated", opening(&uri("Basic256"), &sender, &receiver, 256)),
        ("unknown", opening(&uri("Nonsense"), &sender, &receiver, 256)),
        ("noise", opening(&offered, &sender, &receiver, 256)),
        ("noise that is no whole block", opening(&offered, &sender, &receiver, 255)),
        ("nothing encrypted", opening(&offered, &sender, &receiver, 0)),
        ("more blocks than any request has", opening(&offered, &sender, &receiver, 60_000)),
        ("another receiver", opening(&offered, &sender, &[0; 20], 256)),
        ("no certificate", opening(&offered, b"nonsense", &receiver, 256)),
    ] {
        let mut stream = TcpStream::connect(address(&twin)).await.unwrap();
        stream.write_all(&hello(&twin.url, 65_535)).await.unwrap();
        assert_eq!(&frame(&mut stream).await[..4], b"ACKF");
        let start = Instant::now();
        stream.write_all(&bytes).await.unwrap();
        assert_eq!(
            refusal(&mut stream).await,
            StatusCode::BadSecurityChecksFailed.bits(),
            "{what}"
        );
        let took = start.elapsed();
        assert!(took >= Duration::from_millis(200), "{what} was answered after {took:?}");
        assert!(took < DEADLINE, "{what} was answered after {took:?}");
    }
    twin.client("otto").await.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn nested_values_end_a_request_and_not_the_process() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    for (what, header) in [
        ("diagnostics in diagnostics", nested_header(25, &[0x40], 60_000)),
        ("data values in variants in data values", nested_header(23, &[0x01, 23], 30_000)),
        ("variants in variants", nested_header(24, &[24], 60_000)),
    ] {
        let (mut stream, channel) = channel(&twin).await;
        let body = get_endpoints(&twin.url, channel, 2, &header);
        stream.write_all(&framed(b"MSGF", &body)).await.unwrap();
        let answer = tokio::time::timeout(DEADLINE, frame(&mut stream)).await.expect(what);
        assert!([b"MSGF", b"ERRF"].map(<[u8; 4]>::as_slice).contains(&&answer[..4]), "{what}");
        assert_served(&client).await;
    }
    client.close().await;
    twin.stop().await;
}

/// Offset of the sequence number in a request for a channel without security: after the headers, the policy's URI, and two
/// absent certificates.
const SEQUENCE_AT: usize = 12 + 4 + 47 + 8;

#[tokio::test]
async fn a_channel_keeps_its_client_and_its_security() {
    let twin = TestTwin::start().await;
    let (mut stream, id) = channel(&twin).await;
    // A second request to issue a token would put another owner into the channel of the first.
    let mut again = crate::wire::open_channel();
    again[8..12].copy_from_slice(&id.to_le_bytes());
    again[SEQUENCE_AT..SEQUENCE_AT + 4].copy_from_slice(&2_u32.to_le_bytes());
    stream.write_all(&again).await.unwrap();
    let answer = tokio::time::timeout(DEADLINE, frame(&mut stream)).await.unwrap();
    let fault = 397_u16.to_le_bytes();
    let is_fault = &answer[..4] == b"ERRF" || answer.windows(2).any(|two| two == fault);
    assert!(is_fault, "{answer:02x?}");
    assert_eq!(crate::wire::drain(&mut stream, DEADLINE).await, 0, "the connection ends");
    twin.stop().await;
}

#[tokio::test]
async fn who_only_opens_a_channel_is_closed_after_a_while() {
    let twin = TestTwin::start().await;
    let (mut stream, _) = channel(&twin).await;
    let start = Instant::now();
    crate::wire::drain(&mut stream, Duration::from_secs(60)).await;
    let took = start.elapsed();
    assert!(took > Duration::from_secs(20) && took < Duration::from_secs(45), "{took:?}");
    twin.stop().await;
}

#[tokio::test]
async fn a_channel_ends_when_its_token_is_too_old() {
    let twin = TestTwin::start().await;
    let mut stream = TcpStream::connect(address(&twin)).await.unwrap();
    let mut open = open_channel();
    // The lifetime stands at the end, in milliseconds.
    let lifetime = open.len() - 4;
    open[lifetime..].copy_from_slice(&2_000_u32.to_le_bytes());
    stream.write_all(&[hello(&twin.url, 65_535), open].concat()).await.unwrap();
    let start = Instant::now();
    crate::wire::drain(&mut stream, Duration::from_secs(60)).await;
    let took = start.elapsed();
    assert!(took > Duration::from_secs(1) && took < Duration::from_secs(10), "{took:?}");
    twin.stop().await;
}
