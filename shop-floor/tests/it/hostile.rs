//! Servers that answer with more than they may, before anybody trusts them.

use std::time::{Duration, Instant};

use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::TcpListener,
    sync::oneshot,
};

use crate::support::TestShopFloor;

/// Most bytes that the network itself may take before the client's end is noticed.
const IN_FLIGHT_MAX: usize = 32 << 20;
/// Bytes that a server tries to send.
const SENT_MAX: usize = 256 << 20;

/// An address behind which a server greets with these bytes, and then sends zeros until the client hangs up. How many
/// bytes it could send.
async fn server(greeting: Vec<u8>) -> (String, oneshot::Receiver<usize>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("bound");
    let (sender, receiver) = oneshot::channel();
    tokio::spawn(async move {
        let (mut stream, _) = listener.accept().await.expect("a client");
        let mut hello = [0; 1024];
        let _ = stream.read(&mut hello).await.expect("a greeting");
        stream.write_all(&greeting).await.expect("the client listens");
        let (block, mut sent) = (vec![0; 1 << 20], 0);
        while sent < SENT_MAX && stream.write_all(&block).await.is_ok() {
            sent += block.len();
        }
        let _ = sender.send(sent);
    });
    (format!("opc.tcp://{address}"), receiver)
}

fn header(kind: &[u8; 4], size: u32) -> Vec<u8> {
    [kind.as_slice(), &size.to_le_bytes()].concat()
}

/// An acknowledgement of the greeting with the usual sizes.
fn acknowledgement() -> Vec<u8> {
    let mut bytes = header(b"ACKF", 28);
    for number in [0, 65_535, 65_535, 0, 0_u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

#[tokio::test]
async fn what_a_server_claims_is_not_buffered() {
    let floor = TestShopFloor::start();
    for (what, greeting) in [
        ("an acknowledgement of 4 GiB", header(b"ACKF", u32::MAX)),
        ("a channel of 4 GiB", [acknowledgement(), header(b"OPNF", u32::MAX)].concat()),
        ("a chunk of 1 MiB", [acknowledgement(), header(b"MSGC", 1 << 20)].concat()),
    ] {
        let (url, sent) = server(greeting).await;
        let start = Instant::now();
        assert!(floor.handle.discover(&url).await.is_err(), "{what}");
        assert!(start.elapsed() < Duration::from_secs(4), "{what}: {:?}", start.elapsed());
        let sent = sent.await.expect("the server ends");
        assert!(sent < IN_FLIGHT_MAX, "{what}: the client took {sent} bytes");
    }
}
