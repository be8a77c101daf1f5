//! Frames that must be refused.

use std::io::ErrorKind;

use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::raw::{self, BINARY, CLOSE, CONTINUATION, FINAL, PING, TEXT, announced, frame};

const LIMIT: usize = 10_000;

/// Sends bytes. Returns the reader's error and the close frame that the sender gets.
async fn refused(bytes: &[u8]) -> (ErrorKind, Option<Vec<u8>>) {
    let (mut client, mut server) = raw::client(LIMIT).await;
    client.write_all(bytes).await.expect("written");
    let error = server.read(&mut [0; 64]).await.expect_err("it fails");
    assert_eq!(server.read(&mut [0; 64]).await.expect("the end"), 0, "nothing follows a failure");
    drop(server);
    let close = raw::next(&mut client).await;
    (
        error.kind(),
        close.map(|(first, payload)| (first == FINAL | CLOSE).then_some(payload).expect("a close")),
    )
}

#[tokio::test]
async fn frames_that_are_not_allowed_are_refused_with_a_close_frame() {
    let unmasked = [FINAL | BINARY, 1, b'a'];
    let fragments = [frame(BINARY, &[0; LIMIT]), frame(FINAL | CONTINUATION, b"a")].concat();
    for (what, bytes, code) in [
        ("text", frame(FINAL | TEXT, b"AMQP"), 1003),
        ("text that is not UTF-8", frame(FINAL | TEXT, &[0xC3, 0x28]), 1003),
        ("a frame over the limit", announced(FINAL | BINARY, LIMIT as u64 + 1), 1009),
        ("a frame of exabytes", announced(FINAL | BINARY, u64::MAX >> 1), 1009),
        ("fragments over the limit", fragments, 1009),
        ("a frame without mask", unmasked.to_vec(), 1002),
        ("a reserved operation", frame(FINAL | 0x3, b""), 1002),
        ("a reserved bit, as of compression", frame(FINAL | 0x40 | BINARY, b""), 1002),
        ("a continuation of nothing", frame(FINAL | CONTINUATION, b"a"), 1002),
        ("a long ping", frame(FINAL | PING, &[0; 126]), 1002),
    ] {
        assert_eq!(
            refused(&bytes).await,
            (ErrorKind::InvalidData, Some(raw::close(code))),
            "{what}"
        );
    }
}

#[tokio::test]
async fn a_message_of_exactly_the_limit_is_read() {
    let (mut client, mut server) = raw::client(LIMIT).await;
    client.write_all(&frame(FINAL | BINARY, &[7; LIMIT])).await.expect("written");
    let mut received = vec![0; LIMIT];
    server.read_exact(&mut received).await.expect("read");
}

#[tokio::test]
async fn an_end_without_close_frame_and_a_close_with_a_reason_are_failures() {
    let (mut client, mut server) = raw::client(LIMIT).await;
    client.write_all(&announced(FINAL | BINARY, 100)).await.expect("written");
    drop(client);
    assert_eq!(server.read(&mut [0; 64]).await.expect_err("cut").kind(), ErrorKind::UnexpectedEof);

    let (mut client, mut server) = raw::client(LIMIT).await;
    let reason = [&raw::close(1008)[..], b"go away\nnow"].concat();
    client.write_all(&frame(FINAL | CLOSE, &reason)).await.expect("written");
    let close = server.read(&mut [0; 64]).await.expect_err("a failure").to_string();
    assert!(close.contains("1008") && close.contains(r#""go away\nnow""#), "{close}");
}

#[tokio::test]
async fn answers_to_pings_that_are_not_read_are_bounded() {
    let (mut client, mut server) = raw::client(LIMIT).await;
    let pings = frame(FINAL | PING, &[1; 125]).repeat(8000);
    let flooding = async {
        for _ in 0..4 {
            client.write_all(&pings).await.expect("written");
        }
    };
    tokio::select! {
        () = flooding => {}
        _ = server.read_u8() => panic!("nothing was said"),
    }
    let ending = async {
        let _ = server.flush().await;
        drop(server);
    };
    let mut answers = Vec::new();
    let (_, read) = tokio::join!(ending, client.read_to_end(&mut answers));
    read.expect("read to the end");
    // The pipe between takes a mebibyte; beyond it only a little waits, however many pings came.
    assert!(answers.len() < (1 << 20) + 300_000, "{} bytes for {}", answers.len(), 4 * pings.len());
}
