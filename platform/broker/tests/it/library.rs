//! Bounds of the AMQP library on its own, without the broker's.

use std::time::Duration;

use fe2o3_amqp::acceptor::{ConnectionAcceptor, LinkAcceptor, SessionAcceptor};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{TcpListener, TcpStream},
    time::timeout,
};

use crate::raw::{
    AMQP, AMQP_HEADER, NULL, RawPeer, attach, begin, binary, described, frame, map, string, symbol,
    transfer,
};

/// Frames that wait for what nobody takes.
const FRAMES: usize = 4;
/// Bytes of each frame, nearly the largest.
const FRAME_BYTES: usize = 60_000;
/// Bytes that a peer may get rid of before it has to wait: what waits, and what the system buffers.
const TAKEN_MAX: usize = 32 << 20;

/// Part of what a peer sends that is taken, and no more.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Taken {
    Connection,
    Link,
}

/// Serves one connection without ever taking more of it; returns its address.
async fn listener(taken: Taken) -> std::net::SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("bound");
    tokio::spawn(async move {
        let (stream, _) = listener.accept().await.expect("a peer");
        let acceptor = ConnectionAcceptor::builder()
            .container_id("library")
            .max_frame_size(65_536)
            .buffer_size(FRAMES)
            .build();
        let mut connection = acceptor.accept(stream).await.expect("opened");
        if taken == Taken::Connection {
            return std::future::pending().await;
        }
        let sessions = SessionAcceptor::builder().buffer_size(FRAMES).build();
        let mut session = sessions.accept(&mut connection).await.expect("a session");
        let links = LinkAcceptor::builder().buffer_size(FRAMES).build();
        let _link = links.accept(&mut session).await.expect("a link");
        std::future::pending::<()>().await;
    });
    address
}

/// Opens a connection and begins a session.
async fn opened(address: std::net::SocketAddr) -> RawPeer {
    let mut peer = RawPeer(TcpStream::connect(address).await.expect("a connection"));
    peer.send(AMQP_HEADER).await;
    peer.send(&frame(AMQP, 0, &described(0x10, &[string("peer")]))).await;
    peer.send(&frame(AMQP, 0, &begin(NULL.to_vec()))).await;
    peer.0.read_exact(&mut [0; 8]).await.expect("a header");
    peer
}

/// Sends frames until the other end takes no more; returns the bytes, or those of twice as many as it may take.
async fn sent(peer: &mut RawPeer, frame: &[u8]) -> usize {
    let mut sent = 0;
    while sent < 2 * TAKEN_MAX {
        match timeout(Duration::from_secs(1), peer.0.write_all(frame)).await {
            Ok(written) => written.expect("the connection stays"),
            Err(_) => break,
        }
        sent += frame.len();
    }
    sent
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn frames_of_a_session_that_is_not_accepted_wait_with_the_peer() {
    let mut peer = opened(listener(Taken::Connection).await).await;
    let properties = map(&[symbol("x"), binary(&vec![0; FRAME_BYTES])]);
    let taken = sent(&mut peer, &frame(AMQP, 0, &attach("a", 0, properties))).await;
    assert!(taken < TAKEN_MAX, "{taken} bytes were taken");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn frames_of_a_link_that_is_not_read_wait_with_the_peer() {
    let mut peer = opened(listener(Taken::Link).await).await;
    peer.send(&frame(AMQP, 0, &attach("a", 0, NULL.to_vec()))).await;
    let part = [transfer(0, 0, true), vec![0; FRAME_BYTES]].concat();
    let taken = sent(&mut peer, &frame(AMQP, 0, &part)).await;
    assert!(taken < TAKEN_MAX, "{taken} bytes were taken");
}
