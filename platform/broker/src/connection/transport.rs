//! Transport below AMQP: TCP, optionally TLS on it, optionally a WebSocket on either.

use std::{fmt::Debug, net::SocketAddr};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::TcpStream,
};
use tokio_rustls::TlsAcceptor;
use websocket::Subprotocol;

use crate::config::Carrier;

/// Largest AMQP frame. Larger messages are cut into several, so that one message does not block the
/// others of a connection.
pub(super) const FRAME_BYTES_MAX: u32 = 64 * 1024;

/// Frames of the largest size that a peer may put into one WebSocket message. A peer may send it
/// before it has signed in, so this is far less than the largest AMQP message.
const FRAMES_PER_WEBSOCKET_MESSAGE_MAX: usize = 4;

/// A byte stream from a peer, whatever carries it.
pub(super) trait Stream: AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static {}

impl<S: AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static> Stream for S {}

/// An accepted TCP connection on which no byte has been read yet.
pub(crate) struct Accepted {
    pub tcp: TcpStream,
    pub peer: SocketAddr,
    pub tls: Option<TlsAcceptor>,
    pub carrier: Carrier,
}

impl Accepted {
    /// Completes the TLS and WebSocket handshakes; the error is a sentence for the log. Has no
    /// timeout of its own.
    pub(super) async fn open(self) -> Result<Box<dyn Stream>, String> {
        let stream: Box<dyn Stream> = match self.tls {
            Some(tls) => {
                Box::new(tls.accept(self.tcp).await.map_err(|e| format!("TLS failed: {e}"))?)
            }
            None => Box::new(self.tcp),
        };
        match self.carrier {
            Carrier::Stream => Ok(stream),
            Carrier::WebSocket => {
                let bytes_max = FRAME_BYTES_MAX as usize * FRAMES_PER_WEBSOCKET_MESSAGE_MAX;
                let opened = websocket::accept(stream, Subprotocol::Amqp, bytes_max).await;
                Ok(Box::new(opened.map_err(|e| e.to_string())?))
            }
        }
    }
}
