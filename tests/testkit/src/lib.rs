//! Tools that the tests of several crates share.
//!
//! - [`wait`]: polling with a deadline.
//! - [`amqp`] and [`opcua`]: what peers send, byte by byte.
//! - [`ApiClient`]: a client of a daemon's web API, as a browser is one.
//! - [`authenticator`]: codes of a second factor.
//! - [`SecurityKey`]: a passkey, with the browser in front of it.
//! - [`corpus`]: inputs of fuzz targets, replayed.
//! - [`Contract`]: an API's description, which answers are compared with.
//! - [`deno`]: the engine of scripts that comes from npm.
//! - [`EventStream`]: server-sent events, one by one.

pub mod amqp;
mod api_client;
pub mod authenticator;
mod contract;
pub mod corpus;
pub mod deno;
mod event_stream;
pub mod opcua;
mod security_key;
pub mod wait;

pub use api_client::{Answer, ApiClient};
pub use contract::Contract;
pub use event_stream::{Event, EventStream};
pub use security_key::SecurityKey;
