//! Where the broker listens, where it stores, and what it bounds.

use std::{fmt, net::SocketAddr, path::PathBuf, time::Duration};

use bytes::Bytes;

use crate::address::AddressPattern;

/// What a broker needs to know.
#[derive(Debug, Clone)]
pub struct BrokerConfig {
    /// Where to listen; port 0 picks a free one, see
    /// [`BrokerHandle::local_addresses`](crate::BrokerHandle::local_addresses).
    pub listeners: Vec<Listener>,
    /// The SQLite file; made when missing. On a local disk.
    pub database_path: PathBuf,
    /// Queues of these names are made when somebody permitted attaches to one; all others must be
    /// declared.
    pub auto_created: Vec<AddressPattern>,
    /// Bounds of queues that are made automatically.
    pub queue_options: QueueOptions,
    /// Bounds of the broker.
    pub limits: BrokerLimits,
}

impl BrokerConfig {
    /// A broker with one listener.
    #[must_use]
    pub fn new(listener: Listener, database_path: impl Into<PathBuf>) -> Self {
        Self {
            listeners: vec![listener],
            database_path: database_path.into(),
            auto_created: Vec::new(),
            queue_options: QueueOptions::default(),
            limits: BrokerLimits::default(),
        }
    }
}

/// One address to listen on.
#[derive(Debug, Clone)]
pub struct Listener {
    /// The address.
    pub address: SocketAddr,
    /// The certificate for TLS from the first byte (`amqps`); none for plain TCP, meant for
    /// loopback.
    pub tls: Option<TlsIdentity>,
    /// What carries AMQP.
    pub carrier: Carrier,
}

/// What carries the bytes of AMQP.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Carrier {
    /// TCP, or TLS on it.
    #[default]
    Stream,
    /// A WebSocket on either (AMQP WebSocket Binding 1.0), whatever its path.
    WebSocket,
}

/// A server certificate with its key.
#[derive(Clone)]
pub struct TlsIdentity {
    /// The chain, leaf first, as PEM.
    pub certificates_pem: Bytes,
    /// The private key, as PEM.
    pub key_pem: Bytes,
}

impl fmt::Debug for TlsIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TlsIdentity").finish_non_exhaustive()
    }
}

/// Bounds of one queue. Changes take effect with the next declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QueueOptions {
    /// Most messages kept, those being delivered included. Beyond it publishers get
    /// `amqp:resource-limit-exceeded`.
    pub messages_max: u64,
    /// Most bytes kept, likewise.
    pub bytes_max: u64,
    /// A message delivered so often without success moves to the dead letters.
    pub deliveries_max: u32,
    /// Whether only the consumer that attached first receives, and the next one when it leaves;
    /// keeps the order.
    pub is_single_active_consumer: bool,
}

impl Default for QueueOptions {
    fn default() -> Self {
        Self {
            messages_max: 1_000_000,
            bytes_max: 2 * 1024 * 1024 * 1024,
            deliveries_max: 5,
            is_single_active_consumer: false,
        }
    }
}

/// Bounds of the broker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BrokerLimits {
    /// Connections at once.
    pub connections_max: usize,
    /// Connections of one user at once.
    pub connections_per_user_max: usize,
    /// Sessions of one connection.
    pub sessions_max: u16,
    /// Links of one connection.
    pub links_max: usize,
    /// Queues.
    pub queues_max: usize,
    /// Largest message taken, headers included, in bytes.
    pub message_bytes_max: u64,
    /// Messages one consumer may hold unsettled.
    pub unsettled_per_link_max: usize,
    /// Messages one publisher may have on the way.
    pub publisher_credit: u32,
    /// Bodies kept in memory over all queues, in bytes.
    pub cache_bytes_max: u64,
    /// Time for a new connection to finish TLS and SASL.
    pub handshake_timeout: Duration,
    /// Time that sent bytes may stay unacknowledged before a consumer counts as dead.
    pub stall_timeout: Duration,
    /// Dead letters kept; the oldest go first.
    pub dead_letters_max: u64,
}

impl Default for BrokerLimits {
    fn default() -> Self {
        Self {
            connections_max: 4096,
            connections_per_user_max: 16,
            sessions_max: 64,
            links_max: 2048,
            queues_max: 100_000,
            message_bytes_max: 2 * 1024 * 1024,
            unsettled_per_link_max: 1000,
            publisher_credit: 1000,
            cache_bytes_max: 64 * 1024 * 1024,
            handshake_timeout: Duration::from_secs(10),
            stall_timeout: Duration::from_secs(20),
            dead_letters_max: 100_000,
        }
    }
}
