//! Messages of clients byte by byte, as no client of a library sends them.

use std::time::Duration;

pub use testkit::opcua::{
    NO_HEADER, chunk_header, claimed_chunk, claiming, framed, get_endpoints, hello, nested_header,
    open_channel, opening,
};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};

use crate::harness::{DEADLINE, TestTwin};

pub fn address(twin: &TestTwin) -> String {
    twin.url.trim_start_matches("opc.tcp://").trim_end_matches('/').to_owned()
}

/// Sends bytes on a new connection and waits for its end.
pub async fn send(twin: &TestTwin, bytes: &[u8]) {
    let mut stream = TcpStream::connect(address(twin)).await.unwrap();
    stream.write_all(bytes).await.unwrap();
    drain(&mut stream, DEADLINE).await;
}

/// Reads one frame of the server.
pub async fn frame(stream: &mut TcpStream) -> Vec<u8> {
    let mut header = [0; 8];
    stream.read_exact(&mut header).await.unwrap();
    let length = u32::from_le_bytes(header[4..].try_into().unwrap());
    let mut body = vec![0; length as usize - 8];
    stream.read_exact(&mut body).await.unwrap();
    [header.as_slice(), &body].concat()
}

/// Opens a channel without security, as for discovery; returns the stream and the channel's id.
pub async fn channel(twin: &TestTwin) -> (TcpStream, u32) {
    let mut stream = TcpStream::connect(address(twin)).await.unwrap();
    stream.write_all(&hello(&twin.url, 65_535)).await.unwrap();
    assert_eq!(&frame(&mut stream).await[..4], b"ACKF");
    stream.write_all(&open_channel()).await.unwrap();
    let opened = frame(&mut stream).await;
    assert_eq!(&opened[..4], b"OPNF");
    (stream, u32::from_le_bytes(opened[8..12].try_into().unwrap()))
}

/// Reads until the peer closes or is silent. Returns the number of bytes.
pub async fn drain(stream: &mut TcpStream, patience: Duration) -> usize {
    let (mut total, mut buffer) = (0, [0; 4096]);
    while let Ok(Ok(count @ 1..)) = tokio::time::timeout(patience, stream.read(&mut buffer)).await {
        total += count;
    }
    total
}

/// The status of an error message, with which the server ends a connection.
pub async fn refusal(stream: &mut TcpStream) -> u32 {
    let answer = tokio::time::timeout(DEADLINE, frame(stream)).await.expect("an answer in time");
    assert_eq!(&answer[..4], b"ERRF", "{answer:02x?}");
    assert_eq!(drain(stream, DEADLINE).await, 0, "the connection ends with it");
    u32::from_le_bytes(answer[8..12].try_into().unwrap())
}
