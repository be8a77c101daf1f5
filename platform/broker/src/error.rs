//! Errors of the broker itself. Errors of a peer are answered to the peer as AMQP conditions.

use std::{net::SocketAddr, path::PathBuf};

use crate::address::QueueName;

/// Failure of a start or of an operation of the handle.
#[derive(Debug, thiserror::Error)]
pub enum BrokerError {
    /// The address is in use, or not one of this machine.
    #[error("cannot listen on {address}")]
    Listen {
        address: SocketAddr,
        #[source]
        source: std::io::Error,
    },
    /// The certificate or its key cannot be used.
    #[error("cannot use the TLS certificate: {reason}")]
    Tls { reason: String },
    /// The database cannot be opened or migrated.
    #[error("cannot open the broker's database {path}")]
    OpenStore {
        path: PathBuf,
        #[source]
        source: sqlx::Error,
    },
    #[error("cannot {action} in the broker's database")]
    Store {
        /// Imperative phrase, for example "declare a queue".
        action: &'static str,
        #[source]
        source: sqlx::Error,
    },
    /// No queue has this name.
    #[error("there is no queue {queue}")]
    UnknownQueue { queue: QueueName },
    /// The bound on queues is reached.
    #[error("the broker has {limit} queues, which is its limit")]
    TooManyQueues { limit: usize },
    /// The broker has stopped.
    #[error("the broker has stopped")]
    Stopped,
}
