//! Opening handshake of a WebSocket, for clients and servers.

use std::{fmt, io};

use tokio::io::{AsyncRead, AsyncWrite};
use tokio_tungstenite::{
    WebSocketStream, accept_hdr_async_with_config, client_async_with_config,
    tungstenite::{
        ClientRequestBuilder, Error as WsError,
        error::{ProtocolError, SubProtocolError},
        handshake::server::{ErrorResponse, Request, Response},
        http::{HeaderValue, StatusCode, Uri, header::SEC_WEBSOCKET_PROTOCOL},
    },
};

use crate::stream::{ByteStream, configuration};

/// Most characters of a peer's offer that are repeated in an error.
const OFFER_CHARACTERS_MAX: usize = 80;

/// Protocol inside the WebSocket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subprotocol {
    /// AMQP 1.0, in the WebSocket Binding 1.0 of OASIS.
    Amqp,
    /// MQTT 3.1.1 and 5.
    Mqtt,
}

impl Subprotocol {
    /// Returns its name in the IANA registry of WebSocket subprotocols.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Amqp => "amqp",
            Self::Mqtt => "mqtt",
        }
    }
}

impl fmt::Display for Subprotocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Address of a WebSocket on a server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Endpoint<'a> {
    /// `host` or `host:port`, IPv6 addresses in brackets.
    pub authority: &'a str,
    /// Path and query, beginning with a slash.
    pub path: &'a str,
}

/// Fault of a handshake as the client.
#[derive(Debug, thiserror::Error)]
pub enum ConnectError {
    /// Authority and path make no URI.
    #[error("{authority}{path} is no address of a WebSocket")]
    Address { authority: String, path: String },
    /// The server answered as an HTTP server without a WebSocket for this client.
    #[error("the server answered {status} instead of opening a WebSocket")]
    Refused {
        /// The HTTP status.
        status: u16,
    },
    /// The server does not agree to the subprotocol.
    #[error("the server opens a WebSocket, but not for the subprotocol {subprotocol}")]
    Subprotocol { subprotocol: Subprotocol },
    /// The answer is not that of a WebSocket server.
    #[error("the peer does not answer like a WebSocket server: {reason}")]
    Protocol { reason: String },
    #[error("the connection broke while the WebSocket was being opened")]
    Io(#[source] io::Error),
}

/// Fault of a handshake as the server.
#[derive(Debug, thiserror::Error)]
pub enum AcceptError {
    /// The client does not offer the server's subprotocol.
    #[error(
        "the client offers the WebSocket subprotocols {offered:?}, but {subprotocol} is spoken here"
    )]
    Subprotocol {
        /// Offers of the client, cut after 80 characters.
        offered: String,
        subprotocol: Subprotocol,
    },
    /// The request is not for a WebSocket.
    #[error("the client does not open a WebSocket: {reason}")]
    Protocol { reason: String },
    #[error("the connection broke while the WebSocket was being opened")]
    Io(#[source] io::Error),
}

/// Opens a WebSocket as a client. The caller limits the time. Messages of more than
/// `message_bytes_max` bytes make later reads fail.
///
/// # Errors
/// [`ConnectError`] when the server refuses or the connection breaks.
pub async fn connect<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    endpoint: Endpoint<'_>,
    subprotocol: Subprotocol,
    message_bytes_max: usize,
) -> Result<ByteStream<S>, ConnectError> {
    let Endpoint { authority, path } = endpoint;
    let address =
        || ConnectError::Address { authority: authority.to_owned(), path: path.to_owned() };
    // The scheme is not sent. The caller has encrypted the stream already, or not.
    let uri: Uri = format!("ws://{authority}{path}").parse().map_err(|_| address())?;
    let request = ClientRequestBuilder::new(uri).with_sub_protocol(subprotocol.as_str());
    let opened =
        client_async_with_config(request, stream, Some(configuration(message_bytes_max))).await;
    let (socket, _) = opened.map_err(|error| match error {
        WsError::Http(answer) => ConnectError::Refused { status: answer.status().as_u16() },
        WsError::Protocol(ProtocolError::SecWebSocketSubProtocolError(
            SubProtocolError::NoSubProtocol | SubProtocolError::InvalidSubProtocol,
        )) => ConnectError::Subprotocol { subprotocol },
        WsError::Url(_) | WsError::HttpFormat(_) => address(),
        WsError::Io(error) => ConnectError::Io(error),
        WsError::Protocol(ProtocolError::HandshakeIncomplete) => {
            ConnectError::Io(io::ErrorKind::UnexpectedEof.into())
        }
        other => ConnectError::Protocol { reason: other.to_string() },
    })?;
    // The library has refused a server that agrees to no subprotocol or to another one (RFC 6455
    // §4.1).
    Ok(ByteStream::new(socket))
}

/// Opens a WebSocket as a server, for any path. The caller limits the time. Messages of more than
/// `message_bytes_max` bytes make later reads fail.
///
/// # Errors
/// [`AcceptError`]; a client that offers other subprotocols got an answer that says so.
pub async fn accept<S: AsyncRead + AsyncWrite + Unpin>(
    stream: S,
    subprotocol: Subprotocol,
    message_bytes_max: usize,
) -> Result<ByteStream<S>, AcceptError> {
    let mut refused = None;
    let choose = Choice { subprotocol, refused: &mut refused };
    let opened =
        accept_hdr_async_with_config(stream, choose, Some(configuration(message_bytes_max))).await;
    let socket: WebSocketStream<S> = opened.map_err(|error| match (error, refused) {
        (_, Some(offered)) => AcceptError::Subprotocol { offered, subprotocol },
        (WsError::Io(error), None) => AcceptError::Io(error),
        (WsError::Protocol(ProtocolError::HandshakeIncomplete), None) => {
            AcceptError::Io(io::ErrorKind::UnexpectedEof.into())
        }
        (other, None) => AcceptError::Protocol { reason: other.to_string() },
    })?;
    Ok(ByteStream::new(socket))
}

/// Chooses the subprotocol of a server from a client's offers.
struct Choice<'a> {
    subprotocol: Subprotocol,
    refused: &'a mut Option<String>,
}

impl tokio_tungstenite::tungstenite::handshake::server::Callback for Choice<'_> {
    #[allow(clippy::result_large_err, reason = "the library says so")]
    fn on_request(
        self,
        request: &Request,
        mut response: Response,
    ) -> Result<Response, ErrorResponse> {
        let offers = request.headers().get_all(SEC_WEBSOCKET_PROTOCOL).into_iter();
        let offers: Vec<&str> = offers.filter_map(|value| value.to_str().ok()).collect();
        let expected = self.subprotocol.as_str();
        if offers.iter().flat_map(|value| value.split(',')).any(|offer| offer.trim() == expected) {
            response
                .headers_mut()
                .insert(SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(expected));
            return Ok(response);
        }
        *self.refused = Some(offers.join(", ").chars().take(OFFER_CHARACTERS_MAX).collect());
        let mut refusal = ErrorResponse::new(Some(format!(
            "only the WebSocket subprotocol {expected} is spoken here\n"
        )));
        *refusal.status_mut() = StatusCode::BAD_REQUEST;
        Err(refusal)
    }
}
