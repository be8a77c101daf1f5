//! A peer that writes AMQP frames byte by byte.

use std::{io, time::Duration};

use fe2o3_amqp_types::performatives::Performative;
pub use testkit::amqp::{
    AMQP, AMQP_HEADER, NULL, SASL, SASL_HEADER, attach, begin, binary, boolean, described, entry,
    frame, map, nested, section, string, symbol, text, transfer, uint,
};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
    time::timeout,
};

use crate::support::SECRET;

/// Time in which a peer has to answer or to close.
const ANSWER: Duration = Duration::from_secs(10);

/// One end of a connection.
pub struct RawPeer(pub TcpStream);

impl RawPeer {
    pub async fn connect(port: u16) -> Self {
        Self(TcpStream::connect(("127.0.0.1", port)).await.expect("a connection"))
    }

    /// Connects, signs in, opens, begins a session, and attaches a sender if there is an address.
    pub async fn open(port: u16, user: &str, address: Option<&str>) -> Self {
        let mut peer = Self::connect(port).await;
        peer.send(SASL_HEADER).await;
        peer.send(&frame(SASL, 0, &testkit::amqp::sasl_init(user, SECRET))).await;
        peer.send(AMQP_HEADER).await;
        peer.send(&frame(AMQP, 0, &described(0x10, &[string(user)]))).await;
        peer.send(&frame(AMQP, 0, &begin(NULL.to_vec()))).await;
        let mut header = [0; 8];
        peer.0.read_exact(&mut header).await.expect("a header of SASL");
        peer.read().await.expect("mechanisms");
        peer.read().await.expect("an outcome");
        peer.0.read_exact(&mut header).await.expect("a header of AMQP");
        assert_eq!(header, AMQP_HEADER);
        peer.until("open", |p| matches!(p, Performative::Open(_))).await;
        peer.until("begin", |p| matches!(p, Performative::Begin(_))).await;
        if let Some(address) = address {
            peer.send(&frame(AMQP, 0, &attach(address, 0, NULL.to_vec()))).await;
            peer.until("attach", |p| matches!(p, Performative::Attach(_))).await;
        }
        peer
    }

    /// Sends, if the other end still reads.
    pub async fn send(&mut self, bytes: &[u8]) {
        let _ = self.0.write_all(bytes).await;
    }

    /// Reads a frame: type and body.
    pub async fn read(&mut self) -> io::Result<(u8, Vec<u8>)> {
        let reading = async {
            let mut head = [0; 8];
            self.0.read_exact(&mut head).await?;
            let size = u32::from_be_bytes([head[0], head[1], head[2], head[3]]);
            let mut body = vec![0; size as usize - 8];
            self.0.read_exact(&mut body).await?;
            Ok((head[5], body))
        };
        timeout(ANSWER, reading).await.map_err(|_| io::ErrorKind::TimedOut)?
    }

    /// Reads up to the performative that is looked for.
    pub async fn until(
        &mut self,
        what: &str,
        mut is_it: impl FnMut(&Performative) -> bool,
    ) -> Performative {
        loop {
            let (_, body) = self.read().await.unwrap_or_else(|e| panic!("no {what}: {e}"));
            if body.is_empty() {
                continue;
            }
            let performative = serde_amqp::from_slice(&body).expect("a performative");
            if is_it(&performative) {
                return performative;
            }
        }
    }

    /// Waits until the other end closes, and returns the AMQP error that it closes with.
    pub async fn closed(&mut self) -> Option<String> {
        let mut error = None;
        loop {
            match self.read().await {
                Ok((AMQP, body)) if !body.is_empty() => {
                    if let Ok(Performative::Close(close)) = serde_amqp::from_slice(&body) {
                        error = close.error.map(|e| format!("{:?}", e.condition));
                    }
                }
                Ok(_) => {}
                Err(e) => {
                    assert_ne!(e.kind(), io::ErrorKind::TimedOut, "the connection is held open");
                    return error;
                }
            }
        }
    }
}
