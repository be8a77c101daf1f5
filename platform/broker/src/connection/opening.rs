//! From an accepted connection to the stream that AMQP is spoken on.

use std::{fmt::Debug, net::SocketAddr};

use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::TcpStream,
};
use tokio_rustls::TlsAcceptor;
use websocket::Subprotocol;

use super::FRAME_BYTES_MAX;
use crate::config::Carrier;

/// So many frames of the largest size may a peer put into one message of a WebSocket. It may do so
/// before it has signed in, so this is far less than what a message of AMQP may have.
const FRAMES_TOGETHER_MAX: usize = 4;

/// A stream from a peer, plain or encrypted, in a WebSocket or not.
pub(super) trait Stream: AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static {}

impl<S: AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static> Stream for S {}

/// A peer that has said nothing yet.
pub(crate) struct Accepted {
    pub tcp: TcpStream,
    pub peer: SocketAddr,
    pub tls: Option<TlsAcceptor>,
    pub carrier: Carrier,
}

impl Accepted {
    /// Does what lies beneath AMQP, or says why the peer cannot. The caller bounds the time.
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
                let bytes_max = FRAME_BYTES_MAX as usize * FRAMES_TOGETHER_MAX;
                let opened = websocket::accept(stream, Subprotocol::Amqp, bytes_max).await;
                Ok(Box::new(opened.map_err(|e| e.to_string())?))
            }
        }
    }
}
