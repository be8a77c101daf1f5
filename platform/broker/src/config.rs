//! Configuration of the broker: listeners, database file, bounds.

use std::{fmt, net::SocketAddr, path::PathBuf, time::Duration};

use bytes::Bytes;
use serde::{Deserialize, Serialize};

use crate::{address::AddressPattern, disk::DiskGauge};

/// Listeners, store, queues and limits, fixed at the start.
#[derive(Debug, Clone)]
pub struct BrokerConfig {
    /// Listeners; port 0 picks a free one, which `BrokerHandle::local_addresses` returns.
    pub listeners: Vec<Listener>,
    /// SQLite file on a local disk; created when missing.
    pub database_path: PathBuf,
    /// Gauge of the disk that it lies on: what is left there is not for those who hold most.
    pub disk: DiskGauge,
    /// Queues of these names are created when a permitted user attaches; all others must be
    /// declared.
    pub auto_created: Vec<AddressPattern>,
    /// Bounds of automatically created queues.
    pub queue_options: QueueOptions,
    pub limits: BrokerLimits,
}

impl BrokerConfig {
    /// Returns the configuration of a broker with one listener and default bounds.
    #[must_use]
    pub fn new(listener: Listener, database_path: impl Into<PathBuf>) -> Self {
        Self {
            listeners: vec![listener],
            database_path: database_path.into(),
            disk: DiskGauge::default(),
            auto_created: Vec::new(),
            queue_options: QueueOptions::default(),
            limits: BrokerLimits::default(),
        }
    }
}

/// An address to listen on.
#[derive(Debug, Clone)]
pub struct Listener {
    pub address: SocketAddr,
    /// Certificate for TLS from the first byte (`amqps`); none for plain TCP, meant for loopback.
    pub tls: Option<TlsIdentity>,
    pub carrier: Carrier,
}

/// Transport below AMQP.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Carrier {
    /// TCP, or TLS on it.
    #[default]
    Stream,
    /// A WebSocket on either (AMQP WebSocket Binding 1.0), with any path.
    WebSocket,
}

/// A server certificate with its key.
#[derive(Clone)]
pub struct TlsIdentity {
    /// Certificate chain, leaf first, as PEM.
    pub certificates_pem: Bytes,
    /// Private key as PEM.
    pub key_pem: Bytes,
}

impl fmt::Debug for TlsIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TlsIdentity").finish_non_exhaustive()
    }
}

/// Bounds of one queue. Changes take effect with the next declaration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct QueueOptions {
    /// Bound on messages, unsettled ones included; beyond it publishers get
    /// `amqp:resource-limit-exceeded`.
    pub messages_max: u64,
    /// Bound on stored bytes, with the same effect.
    pub bytes_max: u64,
    /// Failed deliveries after which a message is dead-lettered.
    pub deliveries_max: u32,
    /// True when only the consumer that attached first receives, and the next one when it detaches.
    /// Preserves the order of messages.
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
    pub connections_max: usize,
    /// Connections that have not signed in.
    pub unauthenticated_max: usize,
    /// Connections of one address that have not signed in: of one IPv4 address, or of one IPv6
    /// network of 64 bits.
    pub unauthenticated_per_address_max: usize,
    /// Concurrent connections of one user.
    pub connections_per_user_max: usize,
    /// Sessions of one connection.
    pub sessions_max: u16,
    /// Links of one connection.
    pub links_max: usize,
    pub queues_max: usize,
    /// Largest accepted message, headers included.
    pub message_bytes_max: u64,
    /// Sessions of one user, over all its connections; the owner of the broker is not bounded.
    pub sessions_per_user_max: usize,
    /// Links of one user, over all its connections, likewise.
    pub links_per_user_max: usize,
    /// Sessions of all users of one organisation.
    pub sessions_per_organisation_max: usize,
    /// Links of all users of one organisation.
    pub links_per_organisation_max: usize,
    /// Bytes of the unsettled messages of one user's consumers. A consumer gets one message all the
    /// same.
    pub unsettled_bytes_per_user_max: u64,
    /// Unsettled messages of one consumer.
    pub unsettled_per_link_max: usize,
    /// Bytes of unsettled messages of one consumer; the last message may exceed it.
    pub unsettled_bytes_per_link_max: u64,
    /// Bytes of messages of one user that wait for their commit. A user who sends faster waits,
    /// while others are served. At least `message_bytes_max`.
    pub uncommitted_bytes_per_user_max: u32,
    /// Link credit of a publisher: messages in flight.
    pub publisher_credit: u32,
    /// Bound on the body cache of all queues.
    pub cache_bytes_max: u64,
    /// Time for a new connection to finish TLS and SASL.
    pub handshake_timeout: Duration,
    /// Time that sent bytes may stay unacknowledged before a peer counts as dead.
    pub stall_timeout: Duration,
    /// Bound on the dead letters of one queue, which is to say of one factory or tool; its oldest are
    /// removed first.
    pub dead_letters_per_queue_max: u32,
    /// Bound on their bytes, likewise.
    pub dead_letter_bytes_per_queue_max: u64,
    /// Bound on all dead letters; the oldest are removed first.
    pub dead_letters_max: u64,
    /// Bound on the bytes of all dead letters, likewise.
    pub dead_letter_bytes_max: u64,
}

impl Default for BrokerLimits {
    fn default() -> Self {
        Self {
            connections_max: 4096,
            unauthenticated_max: 512,
            unauthenticated_per_address_max: 16,
            connections_per_user_max: 16,
            sessions_max: 64,
            links_max: 2048,
            // A connector has three links, a tool two; twice that while one replaces another.
            sessions_per_user_max: 32,
            links_per_user_max: 32,
            sessions_per_organisation_max: 1024,
            links_per_organisation_max: 1024,
            unsettled_bytes_per_user_max: 64 * 1024 * 1024,
            queues_max: 100_000,
            // The limit of the link on both sides: a message must fit on its whole way.
            message_bytes_max: 2 * 1024 * 1024,
            unsettled_per_link_max: 1000,
            unsettled_bytes_per_link_max: 32 * 1024 * 1024,
            uncommitted_bytes_per_user_max: 32 * 1024 * 1024,
            publisher_credit: 1000,
            cache_bytes_max: 64 * 1024 * 1024,
            handshake_timeout: Duration::from_secs(10),
            stall_timeout: Duration::from_secs(20),
            dead_letters_per_queue_max: 1000,
            dead_letter_bytes_per_queue_max: 64 * 1024 * 1024,
            dead_letters_max: 100_000,
            dead_letter_bytes_max: 4 * 1024 * 1024 * 1024,
        }
    }
}
