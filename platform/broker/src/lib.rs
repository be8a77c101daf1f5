//! Embedded message broker: AMQP 1.0, durable queues in one SQLite file, a single node.
//!
//! The platform starts it when no other broker is configured. It is meant for a workshop and for
//! demonstrations; production uses a clustered broker, for which `messaging` has a profile.
//!
//! - A publisher is answered *accepted* only after its message is committed with full
//!   synchronisation.
//! - Consumers of a queue compete. Accepted messages are deleted, released ones are delivered again,
//!   rejected ones and those delivered too often move to the queue `dead-letters` with the reason.
//! - Users sign in by SASL PLAIN with high-entropy secrets, and may consume and produce only at
//!   addresses that match their patterns. The signed-in user is stamped on every message as `x-opt-principal`.
//! - AMQP is spoken over TCP, TLS, or inside a WebSocket on either, on a listener each.
//! - Memory holds the ids of all waiting messages, and bodies up to the bound of a cache.

pub mod address;
mod amqp_error;
mod cache;
mod clock;
pub mod config;
mod connection;
mod core;
pub mod credentials;
mod dead_letter;
mod disk;
mod elements;
mod error;
mod guesses;
mod handle;
mod link;
mod listener;
mod message;
mod queue;
mod shares;
mod status;
mod store;
mod waiting;

pub use address::{AddressPattern, InvalidPattern, InvalidQueueName, QueueName};
pub use config::{BrokerConfig, BrokerLimits, Carrier, Listener, QueueOptions, TlsIdentity};
pub use credentials::{BrokerUser, CredentialSource, CredentialTable, Permissions, SecretHash};
pub use dead_letter::BrokerDeadLetter;
pub use disk::{DiskGauge, DiskSpace, DiskState};
pub use error::BrokerError;
pub use handle::{Broker, BrokerHandle};
pub use status::{ConnectionStatus, QueueStatus};
