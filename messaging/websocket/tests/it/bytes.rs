//! Bytes are received as they were sent.

use std::time::Duration;

use proptest::prelude::*;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex, split},
    time::timeout,
};
use websocket::{ByteStream, Endpoint, Subprotocol, accept, connect};

use crate::raw::{self, BINARY, CLOSE, CONTINUATION, FINAL, PING, PONG, frame};

const LIMIT: usize = 256 * 1024;

async fn pair(buffered: usize) -> (ByteStream<DuplexStream>, ByteStream<DuplexStream>) {
    let (client, server) = duplex(buffered);
    let endpoint = Endpoint { authority: "broker.example", path: "/" };
    let (client, server) = tokio::join!(
        connect(client, endpoint, Subprotocol::Mqtt, LIMIT),
        accept(server, Subprotocol::Mqtt, LIMIT)
    );
    (client.expect("connects"), server.expect("accepts"))
}

/// Writes pieces on one side and gives what the other one reads, in reads of `read` bytes.
async fn through(
    from: ByteStream<DuplexStream>,
    to: ByteStream<DuplexStream>,
    pieces: Vec<Vec<u8>>,
    read: usize,
) {
    let expected = pieces.concat();
    let (_, mut writer) = split(from);
    let writing = tokio::spawn(async move {
        for piece in pieces {
            writer.write_all(&piece).await.expect("written");
            writer.flush().await.expect("flushed");
        }
        writer.shutdown().await.expect("shut down");
        writer
    });
    let (mut reader, _kept) = split(to);
    let (mut received, mut buffer) = (Vec::new(), vec![0; read]);
    loop {
        let count = reader.read(&mut buffer).await.expect("read");
        if count == 0 {
            break;
        }
        received.extend_from_slice(&buffer[..count]);
    }
    assert!(received == expected, "{} of {} bytes", received.len(), expected.len());
    writing.await.expect("no panic");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn whatever_is_written_is_read(
        pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..3000), 0..8),
        buffered in 200_usize..5000,
        read in 1_usize..5000,
        is_from_client: bool,
    ) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
        runtime.block_on(async {
            let (client, server) = pair(buffered).await;
            let (from, to) = if is_from_client { (client, server) } else { (server, client) };
            through(from, to, pieces, read).await;
        });
    }
}

#[tokio::test]
async fn much_at_once_is_cut_into_messages_that_the_peer_takes() {
    let (client, server) = pair(1000).await;
    let much = (0..3 * LIMIT).map(|n| (n % 251) as u8).collect();
    through(client, server, vec![much], 4096).await;
}

#[tokio::test]
async fn fragments_are_joined_and_pings_between_them_answered() {
    let (mut client, mut server) = raw::client(LIMIT).await;
    for frame in [
        frame(BINARY, b"a"),
        frame(FINAL | PING, b"still there?"),
        frame(CONTINUATION, b"b"),
        frame(FINAL | CONTINUATION, b"c"),
        frame(FINAL | BINARY, b""),
        frame(FINAL | PONG, b"unasked"),
        frame(FINAL | BINARY, b"d"),
    ] {
        // Byte by byte: no read of the server need begin or end with a frame.
        for byte in frame {
            client.write_all(&[byte]).await.expect("written");
            tokio::task::yield_now().await;
        }
    }
    let mut received = [0; 4];
    server.read_exact(&mut received).await.expect("read");
    assert_eq!(&received, b"abcd");
    assert_eq!(raw::next(&mut client).await, Some((FINAL | PONG, b"still there?".to_vec())));
}

#[tokio::test]
async fn a_close_in_order_is_the_end_and_is_answered() {
    for payload in [raw::close(1000), raw::close(1001), Vec::new()] {
        let (mut client, mut server) = raw::client(LIMIT).await;
        client.write_all(&frame(FINAL | BINARY, b"last")).await.expect("written");
        client.write_all(&frame(FINAL | CLOSE, &payload)).await.expect("written");
        let mut received = Vec::new();
        server.read_to_end(&mut received).await.expect("a clean end");
        assert_eq!(received, b"last");
        assert_eq!(raw::next(&mut client).await, Some((FINAL | CLOSE, payload)));
        server.write_all(b"too late").await.expect_err("closed");
        server.shutdown().await.expect("nothing is left to do");
    }
}

#[tokio::test]
async fn shutting_down_closes_the_websocket_and_the_stream() {
    let (mut client, mut server) = raw::client(LIMIT).await;
    server.write_all(b"bye").await.expect("written");
    server.shutdown().await.expect("shut down");
    assert_eq!(raw::next(&mut client).await, Some((FINAL | BINARY, b"bye".to_vec())));
    assert!(matches!(raw::next(&mut client).await, Some((first, _)) if first == FINAL | CLOSE));
    assert_eq!(raw::next(&mut client).await, None);
}

#[tokio::test]
async fn a_peer_that_does_not_read_makes_the_writer_wait() {
    let (client, mut server) = raw::client(LIMIT).await;
    let mut taken = 0;
    let stuck = async {
        loop {
            taken += server.write(&[0; 64 * 1024]).await.expect("written");
        }
    };
    timeout(Duration::from_millis(200), stuck).await.expect_err("it waits");
    // What the pipe beneath takes, and what is buffered here.
    assert!((1 << 20..2 << 20).contains(&taken), "{taken} bytes");
    drop(client);
}
