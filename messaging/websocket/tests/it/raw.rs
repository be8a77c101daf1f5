//! A peer that writes its handshake and frames by hand, also wrong ones.

use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex};
use websocket::{ByteStream, Subprotocol, accept};

/// The `Sec-WebSocket-Accept` of the key in [`request`] (the example of RFC 6455 §1.3).
pub const ACCEPT: &str = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";

pub const CONTINUATION: u8 = 0x0;
pub const TEXT: u8 = 0x1;
pub const BINARY: u8 = 0x2;
pub const CLOSE: u8 = 0x8;
pub const PING: u8 = 0x9;
pub const PONG: u8 = 0xA;
pub const FINAL: u8 = 0x80;

/// Returns a client's request with additional header lines.
pub fn request(lines: &str) -> String {
    format!(
        "GET /some/path HTTP/1.1\r\nHost: broker.example\r\nUpgrade: websocket\r\nConnection: keep-alive, Upgrade\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n{lines}\r\n"
    )
}

/// Opens a WebSocket. Returns the raw client and the server's stream.
pub async fn client(message_bytes_max: usize) -> (DuplexStream, ByteStream<DuplexStream>) {
    let (mut client, server) = duplex(1 << 20);
    let accepting = tokio::spawn(accept(server, Subprotocol::Amqp, message_bytes_max));
    client
        .write_all(request("Sec-WebSocket-Protocol: amqp\r\n").as_bytes())
        .await
        .expect("written");
    assert!(head(&mut client).await.starts_with("HTTP/1.1 101 "));
    (client, accepting.await.expect("no panic").expect("a WebSocket"))
}

/// Reads up to the empty line.
pub async fn head(stream: &mut DuplexStream) -> String {
    let mut bytes = Vec::new();
    while !bytes.ends_with(b"\r\n\r\n") {
        bytes.push(stream.read_u8().await.expect("more of the head"));
    }
    String::from_utf8(bytes).expect("text")
}

/// A frame as clients send it, masked with zeros.
pub fn frame(first: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = announced(first, payload.len() as u64);
    frame.extend_from_slice(payload);
    frame
}

/// The beginning of a client's frame of that length.
pub fn announced(first: u8, length: u64) -> Vec<u8> {
    let mut head = vec![first];
    match u8::try_from(length) {
        Ok(short @ 0..=125) => head.push(0x80 | short),
        _ => {
            head.push(0x80 | 127);
            head.extend_from_slice(&length.to_be_bytes());
        }
    }
    head.extend_from_slice(&[0; 4]);
    head
}

/// The next frame of a server: first byte and payload; none at the end.
pub async fn next(stream: &mut DuplexStream) -> Option<(u8, Vec<u8>)> {
    let first = stream.read_u8().await.ok()?;
    let length = match stream.read_u8().await.ok()? {
        126 => usize::from(stream.read_u16().await.ok()?),
        127 => usize::try_from(stream.read_u64().await.ok()?).ok()?,
        short => usize::from(short),
    };
    let mut payload = vec![0; length];
    stream.read_exact(&mut payload).await.ok()?;
    Some((first, payload))
}

/// The payload of a close with a code and no words.
pub fn close(code: u16) -> Vec<u8> {
    code.to_be_bytes().to_vec()
}
