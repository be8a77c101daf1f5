//! Byte stream inside a WebSocket (RFC 6455), for protocols with a framing of their own: AMQP 1.0
//! (OASIS AMQP WebSocket Binding 1.0) and MQTT 5 (§6). It reaches a broker through firewalls that
//! pass only HTTPS.
//!
//! [`connect`] and [`accept`] do the handshake on an open stream, encrypted or not. Then
//! [`ByteStream`] reads and writes like that stream. The boundaries of the WebSocket's messages have
//! no meaning: a peer may put many frames of its protocol into one message or one frame into
//! several.
//!
//! Messages of a peer are bounded, only binary messages are accepted, and pings are answered while
//! reading. Compression is never negotiated: secrets and text of others would share a dictionary.

mod handshake;
mod stream;

pub use handshake::{AcceptError, ConnectError, Endpoint, Subprotocol, accept, connect};
pub use stream::ByteStream;
