//! Connections without end from a few addresses, beside an honest client.

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr},
    time::Duration,
};

use tokio::{
    io::AsyncWriteExt,
    net::{TcpSocket, TcpStream},
};

use crate::{
    harness::{DEADLINE, TestTwin, document, message},
    hostile::assert_served,
    wire::{address, claimed_chunk, hello, open_channel},
};

/// Connections of each kind.
const CROWD: usize = 1000;

/// Connects from one of the machine's own addresses, of which it has sixteen million.
async fn connect(twin: &TestTwin, host: u8) -> Option<TcpStream> {
    let server: SocketAddr = address(twin).parse().unwrap();
    let socket = TcpSocket::new_v4().unwrap();
    socket.bind(SocketAddr::new(IpAddr::V4(Ipv4Addr::new(127, 0, 0, host)), 0)).unwrap();
    tokio::time::timeout(Duration::from_secs(5), socket.connect(server)).await.ok()?.ok()
}

/// Memory of this process, in KiB.
fn memory() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_thousand_half_open_and_a_thousand_slow_connections_leave_an_honest_client_served() {
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("net", 1)));
    let client = twin.client("vera").await;
    assert_served(&client).await;
    let before = memory();
    let mut crowd = Vec::new();
    for number in 0..CROWD {
        // One says nothing at all, from six addresses in turn; the other goes as far as anybody can without an
        // account, and then leaves the largest chunk that is allowed unfinished.
        crowd.extend(connect(&twin, 10 + (number % 6) as u8).await);
        if let Some(mut slow) = connect(&twin, 20 + (number % 6) as u8).await {
            let mut bytes = [hello(&twin.url, 65_535), open_channel()].concat();
            bytes.extend(claimed_chunk(65_536, 60_000));
            // The server may have closed it for the next one already.
            let _ = slow.write_all(&bytes).await;
            crowd.push(slow);
        }
        if number % 100 == 99 {
            assert_served(&client).await;
            // A client that was not there before gets in, too.
            let newcomer = tokio::time::timeout(DEADLINE, twin.client("otto")).await;
            newcomer.expect("a new client is served").close().await;
        }
    }
    assert!(crowd.len() > CROWD, "{} connections were made", crowd.len());
    let during = memory();
    drop(crowd);
    testkit::wait::until("the memory comes back", DEADLINE, || memory() < before + 48 * 1024).await;
    println!("memory before {before}, with the crowd {during}, after {} KiB", memory());
    assert!(during < before + 256 * 1024, "{during} KiB, {before} before");
    assert_served(&client).await;
    client.close().await;
    twin.stop().await;
}
