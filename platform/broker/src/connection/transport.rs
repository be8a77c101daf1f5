//! Transport below AMQP: TCP, optionally TLS on it, optionally a WebSocket on either.

use std::{
    fmt::Debug,
    io,
    net::SocketAddr,
    pin::Pin,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
    task::{Context, Poll, ready},
};

use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
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
pub(crate) trait Stream: AsyncRead + AsyncWrite + Debug + Send + Unpin + 'static {}

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
    pub(super) async fn open(self, allowance: Allowance) -> Result<Box<dyn Stream>, String> {
        let tcp = Measured::new(self.tcp, allowance);
        let stream: Box<dyn Stream> = match self.tls {
            Some(tls) => Box::new(tls.accept(tcp).await.map_err(|e| format!("TLS failed: {e}"))?),
            None => Box::new(tcp),
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

/// Bytes that a peer may still send before it has signed in; clones share the number.
#[derive(Debug, Clone)]
pub(super) struct Allowance(Arc<AtomicU64>);

impl Allowance {
    pub(super) fn new(bytes: u64) -> Self {
        Self(Arc::new(AtomicU64::new(bytes)))
    }

    /// Lets the peer send as much as it likes.
    pub(super) fn lift(&self) {
        self.0.store(u64::MAX, Ordering::Relaxed);
    }

    /// Takes off received bytes; false when there were more than allowed.
    fn take(&self, bytes: u64) -> bool {
        let rest = |left: u64| if left == u64::MAX { Some(left) } else { left.checked_sub(bytes) };
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, rest).is_ok()
    }
}

/// A stream that fails when more is received than allowed.
#[derive(Debug)]
pub(super) struct Measured<S> {
    inner: S,
    allowance: Allowance,
}

impl<S> Measured<S> {
    pub(super) const fn new(inner: S, allowance: Allowance) -> Self {
        Self { inner, allowance }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Measured<S> {
    fn poll_read(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        let before = buffer.filled().len();
        ready!(Pin::new(&mut this.inner).poll_read(cx, buffer))?;
        let received = buffer.filled().len() - before;
        if this.allowance.take(received as u64) {
            return Poll::Ready(Ok(()));
        }
        let reason = "the peer sent too much before it signed in";
        Poll::Ready(Err(io::Error::new(io::ErrorKind::InvalidData, reason)))
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Measured<S> {
    fn poll_write(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.get_mut().inner).poll_write(cx, bytes)
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.get_mut().inner).poll_write_vectored(cx, parts)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    fn poll_flush(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().inner).poll_flush(cx)
    }

    fn poll_shutdown(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().inner).poll_shutdown(cx)
    }
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    use super::*;

    #[tokio::test]
    async fn a_peer_may_send_a_bounded_number_of_bytes_until_it_has_signed_in() {
        let (near, mut far) = tokio::io::duplex(64);
        let allowance = Allowance::new(10);
        let mut measured = Measured::new(near, allowance.clone());
        let mut ten = [0; 10];
        far.write_all(&[1; 10]).await.expect("sent");
        measured.read_exact(&mut ten).await.expect("the allowed bytes");
        far.write_all(&[1]).await.expect("sent");
        let refused = measured.read_exact(&mut [0]).await.expect_err("one too many");
        assert_eq!(refused.kind(), io::ErrorKind::InvalidData);
        allowance.lift();
        far.write_all(&[1; 10]).await.expect("sent");
        measured.read_exact(&mut ten).await.expect("as much as it likes");
    }
}
