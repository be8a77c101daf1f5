//! Messages of clients byte by byte, as no client of a library sends them.

use std::time::Duration;

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};

use crate::harness::{DEADLINE, TestTwin};

/// The additional header of a request that has none.
pub const NO_HEADER: [u8; 3] = [0, 0, 0];

pub fn address(twin: &TestTwin) -> String {
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
pub fn open_channel() -> Vec<u8> {
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

/// Returns the header of a chunk: channel, token, sequence number, request id.
pub fn chunk_header(channel: u32, sequence: u32, request: u32) -> Vec<u8> {
    [channel, 1, sequence, request].iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// Reads until the peer closes or is silent. Returns the number of bytes.
pub async fn drain(stream: &mut TcpStream, patience: Duration) -> usize {
    let (mut total, mut buffer) = (0, [0; 4096]);
    while let Ok(Ok(count @ 1..)) = tokio::time::timeout(patience, stream.read(&mut buffer)).await {
        total += count;
    }
    total
}

/// The body of a chunk with a GetEndpoints request, whose additional header anybody may fill.
pub fn get_endpoints(url: &str, channel: u32, sequence: u32, additional_header: &[u8]) -> Vec<u8> {
    let mut body = chunk_header(channel, sequence, sequence);
    // GetEndpointsRequest_Encoding_DefaultBinary; then null token, time, handle, diagnostics, null audit id, timeout.
    body.extend([1, 0, 0xAC, 0x01, 0, 0]);
    body.extend(0_i64.to_le_bytes());
    body.extend(sequence.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(additional_header);
    body.extend(u32::try_from(url.len()).unwrap().to_le_bytes());
    body.extend(url.as_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body
}

/// The status of an error message, with which the server ends a connection.
pub async fn refusal(stream: &mut TcpStream) -> u32 {
    let answer = tokio::time::timeout(DEADLINE, frame(stream)).await.expect("an answer in time");
    assert_eq!(&answer[..4], b"ERRF", "{answer:02x?}");
    assert_eq!(drain(stream, DEADLINE).await, 0, "the connection ends with it");
    u32::from_le_bytes(answer[8..12].try_into().unwrap())
}

/// A chunk that claims a size, and only its beginning.
pub fn claimed_chunk(size: u32, sent: usize) -> Vec<u8> {
    [b"MSGC".as_slice(), &size.to_le_bytes(), &vec![0; sent - 8]].concat()
}
