//! What can go wrong with the broker itself; what goes wrong with a peer is told to the peer.

use std::{net::SocketAddr, path::PathBuf};

use crate::address::QueueName;

/// Why the broker cannot start, or cannot do what its handle was asked for.
#[derive(Debug, thiserror::Error)]
pub enum BrokerError {
    /// The address is taken or not ours.
    #[error("cannot listen on {address}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The certificate or its key cannot be used.
    #[error("cannot use the TLS certificate: {reason}")]
    Tls {
        /// What is wrong.
        reason: String,
    },
    /// The database cannot be opened or brought up to date.
    #[error("cannot open the broker's database {path}")]
    OpenStore {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: sqlx::Error,
    },
    /// The database refused.
    #[error("cannot {action} in the broker's database")]
    Store {
        /// What was tried.
        action: &'static str,
        /// Why.
        #[source]
        source: sqlx::Error,
    },
    /// There is no such queue.
    #[error("there is no queue {queue}")]
    UnknownQueue {
        /// Its name.
        queue: QueueName,
    },
    /// There are too many queues.
    #[error("the broker has {limit} queues, which is its limit")]
    TooManyQueues {
        /// The limit.
        limit: usize,
    },
    /// The broker has stopped.
    #[error("the broker has stopped")]
    Stopped,
}
