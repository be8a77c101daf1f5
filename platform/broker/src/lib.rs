//! The broker that the platform starts when no other one is configured: AMQP 1.0, durable queues in
//! one SQLite file, a single node. For a workshop and for trying things out; production uses a
//! clustered broker, which to `messaging` is merely another profile.
//!
//! - A publisher is answered *accepted* only after its message is committed with full
//!   synchronisation.
//! - Consumers of a queue compete; accepted messages go, released ones come again, rejected ones
//!   and those delivered too often move to the queue `dead-letters` with the reason.
//! - Users sign in by SASL PLAIN with high-entropy secrets, and may consume and produce only what
//!   their patterns name. The signed-in user is stamped on every message as `x-opt-principal`.
//! - AMQP is spoken over TCP, TLS, or inside a WebSocket on either, on a listener each.
//! - Only ids of waiting messages are held in memory, and of bodies as many as a bounded cache
//!   takes.

pub mod address;
mod cache;
pub mod config;
mod connection;
mod core;
pub mod credentials;
mod error;
mod handle;
mod link;
mod listener;
mod message;
mod queue;
mod store;

pub use address::{AddressPattern, InvalidPattern, InvalidQueueName, QueueName};
pub use config::{BrokerConfig, BrokerLimits, Carrier, Listener, QueueOptions, TlsIdentity};
pub use credentials::{BrokerUser, CredentialTable, Credentials, Permissions, SecretHash};
pub use error::BrokerError;
pub use handle::{Broker, BrokerHandle, ConnectionStatus, DeadLetter, QueueStatus};
