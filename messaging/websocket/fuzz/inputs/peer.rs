//! A peer that sends any bytes to either side of a WebSocket, for the fuzz target and for the test that
//! replays its corpus.

use std::{cell::OnceCell, time::Duration};

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex},
    runtime::Runtime,
    time::timeout,
};
use tokio_tungstenite::tungstenite::handshake::derive_accept_key;
use websocket::{ByteStream, Endpoint, Subprotocol, accept, connect};

/// Longest message of a peer.
const MESSAGE_BYTES_MAX: usize = 1024;
/// Time for a side to end after its peer has.
const END_TIMEOUT: Duration = Duration::from_secs(20);
const REQUEST: &[u8] =
    b"GET / HTTP/1.1\r\nHost: h\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
    Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\
    Sec-WebSocket-Protocol: amqp\r\n\r\n";

/// Sends bytes to one side. The first byte says to which, whether the handshake is theirs, and whether
/// they are frames or bodies of frames.
pub fn peer(bytes: &[u8]) {
    thread_local! {
        static RUNTIME: OnceCell<Runtime> = const { OnceCell::new() };
    }
    let Some((mode, rest)) = bytes.split_first() else { return };
    let is_server = mode & 1 == 0;
    let (opens, is_framed) = (mode & 2 == 0, mode & 4 != 0);
    let sent = if is_framed { frames(rest, is_server) } else { rest.to_vec() };
    RUNTIME.with(|runtime| {
        let runtime = runtime.get_or_init(start);
        let both = async {
            let (near, far) = duplex(64 * 1024);
            let sending = send(near, is_server, opens, &sent);
            if is_server {
                tokio::join!(sending, serve(far));
            } else {
                tokio::join!(sending, call(far));
            }
        };
        let ended = runtime.block_on(async { timeout(END_TIMEOUT, both).await });
        ended.expect("a side ends with its peer");
    });
}

fn start() -> Runtime {
    let mut builder = tokio::runtime::Builder::new_current_thread();
    builder.enable_all().build().expect("a runtime")
}

/// Plays the peer: opens the WebSocket in order, or not, and sends.
async fn send(mut near: DuplexStream, is_client: bool, opens: bool, sent: &[u8]) {
    // The other side may have closed before all was sent.
    if opens && is_client {
        let _ = near.write_all(REQUEST).await;
    }
    if opens && !is_client {
        let mut request = Vec::new();
        while !request.ends_with(b"\r\n\r\n") {
            let Ok(byte) = near.read_u8().await else { return };
            request.push(byte);
        }
        let request = String::from_utf8_lossy(&request);
        let key = request.lines().find_map(|line| line.strip_prefix("Sec-WebSocket-Key: "));
        let accepted = derive_accept_key(key.unwrap_or_default().as_bytes());
        let answer = format!(
            "HTTP/1.1 101 Switching Protocols\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Accept: {accepted}\r\nSec-WebSocket-Protocol: amqp\r\n\r\n"
        );
        let _ = near.write_all(answer.as_bytes()).await;
    }
    let (mut read, mut write) = tokio::io::split(near);
    let sending = async {
        let _ = write.write_all(sent).await;
        let _ = write.shutdown().await;
    };
    let mut answers = Vec::new();
    let _ = tokio::join!(sending, read.read_to_end(&mut answers));
}

async fn serve(far: DuplexStream) {
    if let Ok(stream) = accept(far, Subprotocol::Amqp, MESSAGE_BYTES_MAX).await {
        read_on(stream).await;
    }
}

async fn call(far: DuplexStream) {
    let endpoint = Endpoint { authority: "h", path: "/" };
    if let Ok(stream) = connect(far, endpoint, Subprotocol::Amqp, MESSAGE_BYTES_MAX).await {
        read_on(stream).await;
    }
}

async fn read_on(mut stream: ByteStream<DuplexStream>) {
    let mut buffer = [0; 256];
    while let Ok(1..) = stream.read(&mut buffer).await {}
    let _ = stream.shutdown().await;
}

/// Puts each length with its bytes into a frame: the byte before says opcode and whether it is the last.
fn frames(mut rest: &[u8], is_masked: bool) -> Vec<u8> {
    let mut sent = Vec::new();
    while let [kind, length, after @ ..] = rest {
        let (body, after) = after.split_at(usize::from(*length).min(after.len()));
        let mask = if is_masked { 0x80 } else { 0 };
        sent.push(*kind);
        match u8::try_from(body.len()) {
            Ok(length) if length < 126 => sent.push(mask | length),
            _ => {
                sent.push(mask | 126);
                sent.extend(u16::try_from(body.len()).unwrap_or(u16::MAX).to_be_bytes());
            }
        }
        if is_masked {
            sent.extend([0; 4]);
        }
        sent.extend(body);
        rest = after;
    }
    sent
}
