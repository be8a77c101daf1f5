//! A WebSocket that reads and writes like the stream beneath it.

use std::{
    io,
    pin::Pin,
    task::{Context, Poll, ready},
};

use bytes::{Buf, Bytes};
use futures::{Sink, Stream};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio_tungstenite::{
    WebSocketStream,
    tungstenite::{
        Error as WsError, Message,
        error::ProtocolError,
        protocol::{
            CloseFrame, WebSocketConfig,
            frame::{Utf8Bytes, coding::CloseCode},
        },
    },
};

/// Most bytes sent in one message.
const SENT_BYTES_MAX: usize = 64 * 1024;
/// Most bytes read at once.
const READ_BYTES: usize = 16 * 1024;
/// Buffered bytes from which on the writer waits.
const WRITE_BYTES: usize = 64 * 1024;
/// Most buffered bytes, answers to pings included.
const WRITE_BYTES_MAX: usize = 4 * WRITE_BYTES;

/// Returns the library's configuration, with bounds on all buffers.
pub(crate) fn configuration(message_bytes_max: usize) -> WebSocketConfig {
    WebSocketConfig::default()
        .read_buffer_size(READ_BYTES)
        .write_buffer_size(WRITE_BYTES)
        .max_write_buffer_size(WRITE_BYTES_MAX)
        .max_message_size(Some(message_bytes_max))
        .max_frame_size(Some(message_bytes_max))
}

/// The bytes of the binary messages of a WebSocket, in both directions.
///
/// Reading ends when the peer closes the WebSocket in order. It fails when the peer gives a reason,
/// breaks off, or sends a message that is not allowed; the last one is answered with a close frame.
/// Shutting down closes the WebSocket and the stream beneath it.
#[derive(Debug)]
pub struct ByteStream<S> {
    socket: WebSocketStream<S>,
    /// Received bytes that were not read yet.
    received: Bytes,
    has_ended: bool,
}

impl<S> ByteStream<S> {
    pub(crate) fn new(socket: WebSocketStream<S>) -> Self {
        Self { socket, received: Bytes::new(), has_ended: false }
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> ByteStream<S> {
    /// Waits for bytes; there are none once the WebSocket has ended.
    fn poll_received(&mut self, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        while self.received.is_empty() && !self.has_ended {
            match ready!(Pin::new(&mut self.socket).poll_next(cx)) {
                Some(Ok(Message::Binary(bytes))) => self.received = bytes,
                // Pings are answered by the library when it reads on.
                Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Frame(_))) => {}
                Some(Ok(Message::Text(_))) => {
                    let reason = "the peer sent text where only binary messages are allowed";
                    return Poll::Ready(Err(self.refuse(
                        cx,
                        CloseCode::Unsupported,
                        invalid(reason),
                    )));
                }
                Some(Ok(Message::Close(frame))) => {
                    self.has_ended = true;
                    // Answers the close. The peer need not read it, so no one waits for the flush.
                    let _ = Pin::new(&mut self.socket).poll_flush(cx);
                    return Poll::Ready(closed(frame));
                }
                Some(Err(error)) => return Poll::Ready(Err(self.failed(cx, error))),
                None => self.has_ended = true,
            }
        }
        Poll::Ready(Ok(()))
    }

    fn failed(&mut self, cx: &mut Context<'_>, error: WsError) -> io::Error {
        self.has_ended = true;
        match error {
            WsError::Io(error) => error,
            WsError::Protocol(ProtocolError::ResetWithoutClosingHandshake) => {
                io::ErrorKind::UnexpectedEof.into()
            }
            WsError::Capacity(_) => self.refuse(cx, CloseCode::Size, invalid(error)),
            WsError::Utf8(_) => self.refuse(cx, CloseCode::Unsupported, invalid(error)),
            other => self.refuse(cx, CloseCode::Protocol, invalid(other)),
        }
    }

    /// Sends a close frame with a code, if the peer still reads, and returns the error.
    fn refuse(&mut self, cx: &mut Context<'_>, code: CloseCode, error: io::Error) -> io::Error {
        self.has_ended = true;
        let close = Message::Close(Some(CloseFrame { code, reason: Utf8Bytes::default() }));
        let mut socket = Pin::new(&mut self.socket);
        if socket.as_mut().start_send(close).is_ok() {
            let _ = socket.poll_flush(cx);
        }
        error
    }
}

fn invalid(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error)
}

/// Converts a close frame to the end of the stream or to an error.
fn closed(frame: Option<CloseFrame>) -> io::Result<()> {
    match frame {
        None => Ok(()),
        Some(CloseFrame {
            code: CloseCode::Normal | CloseCode::Away | CloseCode::Status, ..
        }) => Ok(()),
        Some(CloseFrame { code, reason }) => {
            let error = format!(
                "the peer closed the WebSocket with the code {} {:?}",
                u16::from(code),
                reason.as_str()
            );
            Err(io::Error::new(io::ErrorKind::ConnectionAborted, error))
        }
    }
}

fn write_error(error: WsError) -> io::Error {
    match error {
        WsError::Io(error) => error,
        other => io::Error::new(io::ErrorKind::BrokenPipe, other),
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> AsyncRead for ByteStream<S> {
    fn poll_read(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        ready!(this.poll_received(cx))?;
        let count = this.received.len().min(buffer.remaining());
        buffer.put_slice(&this.received[..count]);
        this.received.advance(count);
        Poll::Ready(Ok(()))
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> AsyncWrite for ByteStream<S> {
    fn poll_write(
        self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let mut socket = Pin::new(&mut self.get_mut().socket);
        ready!(socket.as_mut().poll_ready(cx)).map_err(write_error)?;
        let bytes = &bytes[..bytes.len().min(SENT_BYTES_MAX)];
        if !bytes.is_empty() {
            socket
                .start_send(Message::Binary(Bytes::copy_from_slice(bytes)))
                .map_err(write_error)?;
        }
        Poll::Ready(Ok(bytes.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().socket).poll_flush(cx).map_err(write_error)
    }

    fn poll_shutdown(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        match ready!(Pin::new(&mut this.socket).poll_close(cx)) {
            // The peer has closed it before.
            Ok(())
            | Err(WsError::AlreadyClosed | WsError::ConnectionClosed | WsError::Protocol(_)) => {}
            Err(error) => return Poll::Ready(Err(write_error(error))),
        }
        Pin::new(this.socket.get_mut()).poll_shutdown(cx)
    }
}
