//! Byte streams to a broker.

use tokio::io::{AsyncRead, AsyncWrite};

/// A byte stream to a broker: TCP, TLS or a WebSocket over either.
pub(in crate::transport) trait Stream:
    AsyncRead + AsyncWrite + std::fmt::Debug + Send + Unpin + 'static
{
}

impl<S: AsyncRead + AsyncWrite + std::fmt::Debug + Send + Unpin + 'static> Stream for S {}
