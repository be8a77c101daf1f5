//! A stream of bytes inside a WebSocket (RFC 6455), for protocols that frame their bytes
//! themselves: AMQP 1.0 (OASIS AMQP WebSocket Binding 1.0) and MQTT 5 (§6). So a broker can be
//! reached where nothing but HTTPS gets out.
//!
//! [`connect`] and [`accept`] do the handshake on a stream that is already there, encrypted or not;
//! then [`ByteStream`] reads and writes like that stream. Where a message of the WebSocket ends
//! means nothing: a peer may put many frames of its protocol into one message or cut one frame over
//! several.
//!
//! What a peer sends is bounded, only binary messages are taken, and pings are answered by reading.
//! Compression is never agreed upon: secrets and what others write would share its dictionary.

mod handshake;
mod stream;

pub use handshake::{AcceptError, ConnectError, Endpoint, Subprotocol, accept, connect};
pub use stream::ByteStream;
